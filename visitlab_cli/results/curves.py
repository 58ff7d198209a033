"""Learning curves: trials in batches, the mean over independent units in each, and its interval."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import RunError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import trials_of
from visitlab_cli.results.estimates import half_width
from visitlab_cli.results.units import Units, by_unit
from visitlab_cli.storage.cell_folder import TRIALS

Floats = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]

SETTLED = 4
"""The last quarter of the trials is where spreads are measured."""


@dataclass(frozen=True)
class Curve:
    """Reward a trial in batches of trials.

    `edges` are the trials at which the batches begin and the last one ends, shape (batches + 1,); `units` has for each
    independent unit its cells in these batches, shape (cells, batches); `trial` is the length of a trial in units of x:
    steps in a training, 1 in a visit.
    """

    edges: Integers
    units: dict[str, Floats]
    trial: int = 1

    @cached_property
    def samples(self) -> Floats:
        """A curve for each independent unit, the mean of its cells: shape (units, batches)."""
        return np.array([each.mean(axis=0) for each in self.units.values()])

    @property
    def x(self) -> Floats:
        """The middle of each batch, shape (batches,)."""
        return np.asarray((self.edges[:-1] + self.edges[1:]) / 2 * self.trial)

    @property
    def mean(self) -> Floats:
        """The mean over units, shape (batches,)."""
        return np.asarray(self.samples.mean(axis=0))

    @property
    def half(self) -> Floats:
        """Half the 95% interval of the mean, shape (batches,); nan for one unit."""
        return half_width(self.samples)

    @property
    def highest(self) -> float:
        """Where its interval reaches highest, or its mean where there is no interval."""
        return float((self.mean + np.nan_to_num(self.half)).max())

    @property
    def counted(self) -> Units:
        """How many units and cells."""
        return Units(len(self.units), sum(map(len, self.units.values())))

    def averaged_away(self, part: slice) -> float:
        """The variance that the mean of a `part` has lost where a unit is a mean of several visits."""
        several = [visits[:, part].mean(axis=1) for visits in self.units.values() if len(visits) > 1]
        return float(np.mean([values.var(ddof=1) * (1 - 1 / len(values)) for values in several])) if several else 0.0


class Spread(NamedTuple):
    """Standard deviations of a settled trial's mean: between models, and between visits of one model."""

    models: float
    visits: float


def curve_of(run: Path, cells: Sequence[Cell], edges: Integers) -> Curve:
    """The curve of finished cells that differ in nothing but their seeds.

    Raises:
        RunError: a table of trials is damaged, or has fewer trials than the batches.
    """
    units = {
        unit: np.array([in_batches(_rewards(run, cell, edges[-1]), edges) for cell in members])
        for unit, members in by_unit(cells).items()
    }
    settings = cells[0].settings
    return Curve(edges, units, 1 if settings.counted_in == "trials" else settings.trial_steps)


def _rewards(run: Path, cell: Cell, trials: int) -> Floats:
    rewards: Floats = trials_of(run, cell)["reward"]
    if len(rewards) < trials:
        raise RunError(f"{run / cell.path / TRIALS}: has {len(rewards)} trials, not {trials}")
    return rewards


def in_batches(rewards: Floats, edges: Integers) -> Floats:
    """Reward of each trial, shape (trials,), as the mean of each batch, shape (batches,)."""
    return np.asarray(np.add.reduceat(rewards[: edges[-1]], edges[:-1]) / np.diff(edges))


def equal_edges(trials: int, most: int, first: int = 0) -> Integers:
    """The edges of `most` equal batches of the trials from `first` on, or of as many as there are trials."""
    return np.linspace(first, trials, min(most, trials - first) + 1).round().astype(np.int64)


def spread_of(run: Path, cells: Sequence[Cell]) -> Spread | None:
    """The spreads of finished visits in the last quarter of their trials, where models are crossed; else None."""
    trials = cells[0].trials
    return spread(curve_of(run, cells, np.array([trials - max(trials // SETTLED, 1), trials])))


def spread(settled: Curve) -> Spread | None:
    """The spreads of a curve of one batch; None where no model has several visits, or there is only one.

    One-way analysis of variance: the models' means vary by the visits' chance too, which is taken off.
    """
    of_model = [visits[:, 0] for visits in settled.units.values()]
    repeated = [visits for visits in of_model if len(visits) > 1]
    if not repeated or len(of_model) < 2:
        return None
    within = float(np.mean([visits.var(ddof=1) for visits in repeated]))
    means = float(np.var([visits.mean() for visits in of_model], ddof=1))
    between = max(means - within * len(of_model) / settled.counted.cells, 0.0)
    return Spread(math.sqrt(between), math.sqrt(within))
