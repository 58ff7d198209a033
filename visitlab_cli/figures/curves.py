"""Curves as they are drawn: a run's trials in batches, with the uncertainty of their mean."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from visitlab_cli.analysis.intervals import t_quantile
from visitlab_cli.figures.source import Floats


class Curve(NamedTuple):
    """`x` and `mean`, and `half` the width of the band around it, each of shape (batches,); `n` independent units.

    The band is the 95% interval of the mean; `half` is nan where n is 1.
    """

    x: Floats
    mean: Floats
    half: Floats
    n: int


def learning_curve(rewards: Floats, units: Sequence[str], batches: int, x_per_trial: float, first: int = 0) -> Curve:
    """The mean reward of a trial in each of `batches` equal parts of the trials from `first` on.

    Args:
        rewards: shape (cells, trials).
        units: for each cell what it shares with others, such as a model; the mean over a unit's cells counts once.
        batches: how many, or as many as there are trials if these are fewer.
        x_per_trial: of a trial, in units of x; the x of a batch is its middle.
        first: the first trial that is shown.
    """
    trials = rewards.shape[1]
    edges = np.linspace(first, trials, min(batches, trials - first) + 1).round().astype(int)
    of_cell = np.add.reduceat(rewards, edges[:-1], axis=1) / np.diff(edges)
    of_unit = np.stack([of_cell[[unit == each for each in units]].mean(axis=0) for unit in dict.fromkeys(units)])
    return Curve((edges[:-1] + edges[1:]) / 2 * x_per_trial, of_unit.mean(axis=0), half_width(of_unit), len(of_unit))


def half_width(samples: Floats) -> Floats:
    """Half the 95% interval (Student's t) of the mean over the first axis; nan where that is 1 long."""
    n = len(samples)
    if n < 2:
        return np.full(samples.shape[1:], np.nan)
    return np.asarray(t_quantile(n - 1) * samples.std(axis=0, ddof=1) / math.sqrt(n))
