"""A mean with its 95% interval: Student's t, which is right for few seeds and the normal for many."""

import math
from collections.abc import Sequence
from statistics import fmean
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.results.intervals import deviation, t_quantile

Floats = npt.NDArray[np.float64]

FINE = 0.01
"""Half an interval below which two digits would hide the difference."""


class Estimate(NamedTuple):
    """A mean and half the width of its interval, nan where fewer than two values leave it open."""

    mean: float
    half: float

    def in_words(self, sign: str = "", unknown: str = " ± ?") -> str:
        """The mean and half its interval, with four digits where two hide it; `unknown` where that is open.

        `sign` is '+' where a positive mean has one.
        """
        if math.isnan(self.half):
            return f"{self.mean:{sign}z.2f}{unknown}"
        digits = 4 if 0 < self.half < FINE else 2
        return f"{self.mean:{sign}z.{digits}f} ± {self.half:.{digits}f}"

    def as_json(self) -> dict[str, Any]:
        """The mean, and the interval's ends or null."""
        known = not math.isnan(self.half)
        return {"mean": self.mean, "interval": [self.mean - self.half, self.mean + self.half] if known else None}


def mean_of(values: Sequence[float]) -> Estimate:
    """The mean of independent values, at least one."""
    return Estimate(fmean(values), float(half_width(np.array(values))))


def half_width(samples: Floats) -> Floats:
    """Half the 95% interval (Student's t) of the mean over the first axis; nan where that is 1 long."""
    n = len(samples)
    if n < 2:
        return np.full(samples.shape[1:], np.nan)
    return np.asarray(t_quantile(n - 1) * samples.std(axis=0, ddof=1) / math.sqrt(n))


def difference_of(first: Sequence[float], second: Sequence[float]) -> Estimate:
    """The mean of `second` less that of `first`, all values independent (Welch 1947)."""
    difference = fmean(second) - fmean(first)
    if min(len(first), len(second)) < 2:
        return Estimate(difference, math.nan)
    parts = [deviation(values) ** 2 / len(values) for values in (first, second)]
    if sum(parts) == 0.0:
        return Estimate(difference, 0.0)
    degrees = sum(parts) ** 2 / sum(
        part**2 / (len(values) - 1) for part, values in zip(parts, (first, second), strict=True)
    )
    return Estimate(difference, t_quantile(degrees) * math.sqrt(sum(parts)))


def probability_of_improvement(first: Sequence[float], second: Sequence[float]) -> float:
    """P(a seed of `second` is better than one of `first`), a tie counting half: Mann and Whitney's U, scaled."""
    wins = sum((b > a) + 0.5 * (b == a) for a in first for b in second)
    return wins / (len(first) * len(second))
