"""The judge: does a mean of ours agree with a published one, up to a margin?

The logic is that of equivalence tests. With the 95% interval of the difference, ours less the published:
'agrees' where it lies within the margin, 'differs' where it lies wholly beyond, else 'undecided'. So a few noisy
seeds never agree and never differ, and a difference within the margin that many seeds make certain still agrees.

The published mean is itself one of ten seeds, whose deviation between seeds is not known. Ours stands for it:
the difference has the standard error s sqrt(1/n + 1/10), and t the n - 1 degrees of freedom of s.
"""

import math
from collections.abc import Sequence
from enum import StrEnum
from statistics import NormalDist, fmean
from typing import Any, NamedTuple

from visitlab_cli.results.intervals import CONFIDENCE, deviation, t_quantile

PUBLISHED_SEEDS = 10
MARGIN = 0.5
"""Reward (or goals) a trial."""
MOST_SEEDS = 10_000


class Verdict(StrEnum):
    """What is said of a difference; the later outweighs the earlier."""

    AGREES = "agrees"
    UNDECIDED = "undecided"
    DIFFERS = "differs"


class Judgement(NamedTuple):
    """A difference, its 95% interval, and what follows; without two seeds there is no interval (nan)."""

    ours: float
    published: float
    low: float
    high: float
    seeds: int
    verdict: Verdict
    seeds_that_decide: int | None
    """Where undecided: how many of ours would decide, were mean and deviation to stay; None: no number would,
    the published ten leave it open."""

    @property
    def difference(self) -> float:
        """Ours less the published."""
        return self.ours - self.published

    def as_json(self) -> dict[str, Any]:
        """Plain values; nan is null."""
        known = not math.isnan(self.low)
        return {
            "ours": self.ours,
            "published": self.published,
            "difference": self.difference,
            "interval": [self.low, self.high] if known else None,
            "seeds": self.seeds,
            "verdict": str(self.verdict),
            "seeds_that_decide": self.seeds_that_decide,
        }


def judge(
    ours: Sequence[float],
    published: float,
    margin: float = MARGIN,
    published_seeds: int = PUBLISHED_SEEDS,
    averaged_away: float = 0.0,
) -> Judgement:
    """Judge the mean of `ours`, a value for each seed, against a `published` mean of `published_seeds` seeds.

    `averaged_away` is the variance that a value of ours has lost by being a mean of several simulations, which a
    published seed is not.
    """
    seeds, mean, spread = len(ours), fmean(ours), deviation(ours)
    difference = mean - published
    if seeds < 2:
        return Judgement(mean, published, math.nan, math.nan, seeds, Verdict.UNDECIDED, None)
    of_published = (spread**2 + averaged_away) / published_seeds
    half = _half_width(spread, seeds, of_published)
    if abs(difference) + half <= margin:
        verdict = Verdict.AGREES
    elif abs(difference) - half > margin:
        verdict = Verdict.DIFFERS
    else:
        verdict = Verdict.UNDECIDED
    decisive = None
    if verdict == Verdict.UNDECIDED:
        decisive = _seeds_that_decide(abs(abs(difference) - margin), spread, seeds, of_published)
    return Judgement(mean, published, difference - half, difference + half, seeds, verdict, decisive)


def worst(verdicts: Sequence[Verdict]) -> Verdict:
    """The verdict on the whole of which these are parts."""
    return max(verdicts, key=list(Verdict).index)


def _half_width(spread: float, seeds: int, of_published: float) -> float:
    return t_quantile(seeds - 1) * math.sqrt(spread**2 / seeds + of_published)


def _seeds_that_decide(gap: float, spread: float, seeds: int, of_published: float) -> int | None:
    """The smallest number of seeds whose interval is narrower than the `gap` between difference and margin.

    `of_published` is the variance of the published mean.
    """
    endless = NormalDist().inv_cdf((1 + CONFIDENCE) / 2) * math.sqrt(of_published)
    if endless >= gap or _half_width(spread, MOST_SEEDS, of_published) >= gap:
        return None
    too_few, enough = seeds, MOST_SEEDS
    while enough - too_few > 1:
        middle = (too_few + enough) // 2
        if _half_width(spread, middle, of_published) < gap:
            enough = middle
        else:
            too_few = middle
    return enough
