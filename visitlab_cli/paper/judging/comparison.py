"""The comparison of a run with what was published: every curve in four parts, a verdict, and the cause if one is there.

A cause is named only where a variant run removes it: its same curve agrees. Otherwise a difference is unexplained.
"""

from collections.abc import Sequence
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.exact.values import Possible
from visitlab_cli.paper.judging.judge import MARGIN, PUBLISHED_SEEDS, Judgement, Verdict, judge, worst
from visitlab_cli.paper.judging.variants import Variant, changes
from visitlab_cli.paper.published.counterparts import COUNTERPARTS, Absent, OurCurve, curve_of_group, our_curves
from visitlab_cli.paper.published.curves import PublishedCurve
from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.curves import Curve
from visitlab_cli.results.possible import possible_in

FIRST, MIDDLE, LAST, WHOLE = ("first_tenth", "middle_tenth", "last_tenth", "whole")
UNEXPLAINED = "unexplained"
RESTS_ON_ONE_MODEL = ("fig8_adaptation",)
"""Figures whose published ten seeds all visit with one and the same trained model."""


class Tried(NamedTuple):
    """The same curve in a variant run: what is set differently there, and the verdict on it."""

    name: str
    changes: list[str]
    parts: dict[str, Judgement]

    @property
    def verdict(self) -> Verdict:
        """The worst of its parts."""
        return worst([part.verdict for part in self.parts.values()])

    def explains(self, part: str) -> bool:
        """Whether a part agrees here, and no other differs: then errors that cancel would explain it."""
        return self.parts[part].verdict == Verdict.AGREES and self.verdict != Verdict.DIFFERS


class Comparison(NamedTuple):
    """A published curve and ours."""

    published: PublishedCurve
    ours: OurCurve
    parts: dict[str, Judgement]
    one_model: dict[str, Judgement]  # the parts, were the published seeds one; empty where each is a training
    possible: Possible | None
    tried: list[Tried]  # only where the curve does not agree

    @property
    def verdict(self) -> Verdict:
        """The worst of its parts."""
        return worst([part.verdict for part in self.parts.values()])

    @property
    def cause(self) -> str | None:
        """What makes the curve differ: a variant in which all of it agrees; None where it need not be explained."""
        agreeing = [each for each in self.tried if each.verdict == Verdict.AGREES]
        return _cause(agreeing, self.verdict)

    def cause_of(self, part: str) -> str | None:
        """What makes a part differ: a variant in which this part agrees; None where it need not be explained."""
        agreeing = [each for each in self.tried if each.explains(part)]
        return _cause(agreeing, self.parts[part].verdict)

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        last = self.parts[LAST]
        share = self.possible and {
            "ours": self.possible.share(last.ours),
            "published": self.possible.share(last.published),
            "optimum": self.possible.optimum,
            "random": self.possible.random,
        }
        return {
            "figure": self.published.figure,
            "condition": self.published.condition,
            "group": self.ours.group,
            "verdict": str(self.verdict),
            "seeds": self.ours.curve.counted.n,
            "seeds_of": self.ours.curve.counted.of,
            "parts": {name: part.as_json() | {"cause": self.cause_of(name)} for name, part in self.parts.items()},
            "share_of_the_possible_last_tenth": share,
            "if_published_is_one_model": {name: part.as_json() for name, part in self.one_model.items()} or None,
            "cause": self.cause,
            "variants": [
                {
                    "run": each.name,
                    "verdict": str(each.verdict),
                    "changes": each.changes,
                    "parts": {name: part.as_json() for name, part in each.parts.items()},
                }
                for each in self.tried
            ],
        }


class Compared(NamedTuple):
    """All published curves: those that the run has, and why it lacks the others."""

    curves: list[Comparison]
    absent: list[tuple[PublishedCurve, Absent]]


def compare(run: Path, cells: Sequence[Cell], variants: Sequence[Variant] = (), margin: float = MARGIN) -> Compared:
    """Compare the finished cells of a run with every published curve.

    Args:
        run: the run's folder.
        cells: all cells of its plan.
        variants: runs in which causes are looked for.
        margin: how far, in reward a trial, is still the same.
    """
    compared = Compared([], [])
    for published, ours in our_curves(run, cells):
        if isinstance(ours, Absent):
            compared.absent.append((published, ours))
            continue
        parts = judge_parts(ours.curve, published.mean, margin)
        differing = worst([part.verdict for part in parts.values()]) != Verdict.AGREES
        tried = [each for variant in variants if (each := _try(variant, ours, published, margin))] if differing else []
        one_model = judge_parts(ours.curve, published.mean, margin, 1) if published.figure in RESTS_ON_ONE_MODEL else {}
        compared.curves.append(Comparison(published, ours, parts, one_model, possible_in(ours.cell), tried))
    return compared


def _cause(agreeing: Sequence[Tried], verdict: Verdict) -> str | None:
    """The variant with the fewest changes among those that agree, and these changes."""
    if verdict == Verdict.AGREES:
        return None
    if agreeing:
        simplest = min(agreeing, key=lambda each: len(each.changes))
        return f"{simplest.name}: {'; '.join(simplest.changes)}"
    return UNEXPLAINED if verdict == Verdict.DIFFERS else None


def part_slices(batches: int) -> dict[str, slice]:
    """The parts of a curve of so many batches: its first, middle and last tenth, and the whole."""
    tenth = max(1, round(batches / 10))
    middle = (batches - tenth) // 2
    return {
        FIRST: slice(0, tenth),
        MIDDLE: slice(middle, middle + tenth),
        LAST: slice(batches - tenth, batches),
        WHOLE: slice(0, batches),
    }


def judge_parts(
    ours: Curve, published: npt.NDArray[np.float64], margin: float = MARGIN, published_seeds: int = PUBLISHED_SEEDS
) -> dict[str, Judgement]:
    """Judge a curve of ours against a published one, shape (batches,), part by part."""
    judged = {}
    for name, part in part_slices(len(published)).items():
        values = ours.samples[:, part].mean(axis=1).tolist()
        lost = ours.averaged_away(part)
        judged[name] = judge(values, fmean(published[part]), margin, published_seeds, lost)
    return judged


def _try(variant: Variant, ours: OurCurve, published: PublishedCurve, margin: float) -> Tried | None:
    group = COUNTERPARTS[published.figure, published.condition]
    theirs = curve_of_group(variant.run, variant.cells, group, published)
    if isinstance(theirs, Absent):
        return None
    changed = changes(ours.cell, theirs.cell)
    return Tried(variant.run.name, changed, judge_parts(theirs.curve, published.mean, margin)) if changed else None
