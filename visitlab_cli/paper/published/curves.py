"""The published curves, package data (their source and how they were made: `README.md` beside this)."""

import csv
from functools import cache
from importlib.resources import files
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.task import TRAINING_TRIAL_STEPS, VISIT_TRIAL_STEPS

Curve = npt.NDArray[np.float64]


class PublishedCurve(NamedTuple):
    """A curve as published: arrays of shape (batches,), a batch being `trials_in_batch` trials from `first_trial` on.

    `x` is the middle of a batch, in steps or, for `fig8_adaptation`, in trials. `mean` is the reward (in the visit:
    goals) a trial. `band` is the half width of the published band, the standard deviation of single trials between
    ten seeds; it is not the uncertainty of the mean.
    """

    figure: str
    condition: str
    x_unit: str
    x: Curve
    mean: Curve
    band: Curve
    trial_steps: int
    first_trial: int
    trials_in_batch: int

    @property
    def trials(self) -> int:
        """How many trials a run needs to cover the curve."""
        return self.first_trial + len(self.x) * self.trials_in_batch

    @property
    def edges(self) -> npt.NDArray[np.int64]:
        """The trials at which the batches begin and the last one ends, shape (batches + 1,)."""
        return np.arange(self.first_trial, self.trials + 1, self.trials_in_batch)


FIGURES = ("fig6_navigation", "fig6_go_to_human", "fig6_social", "fig6_mb_mf", "fig8_humans", "fig8_adaptation")


@cache
def published_curves() -> tuple[PublishedCurve, ...]:
    """Every published curve, in the order of the figures; the arrays are read-only."""
    return tuple(curve for figure in FIGURES for curve in _figure(figure))


def _figure(figure: str) -> list[PublishedCurve]:
    text = (files("visitlab_cli.paper") / "published" / f"{figure}.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(text.splitlines()))
    unit = "step" if "step" in rows[0] else "trial"
    conditions = dict.fromkeys(row["condition"] for row in rows)
    return [_curve(figure, name, unit, [row for row in rows if row["condition"] == name]) for name in conditions]


def _curve(figure: str, condition: str, unit: str, rows: list[dict[str, str]]) -> PublishedCurve:
    x, mean, band = (np.array([float(row[column]) for row in rows]) for column in (unit, "mean", "std"))
    for array in (x, mean, band):
        array.setflags(write=False)
    trial_steps = TRAINING_TRIAL_STEPS if unit == "step" else VISIT_TRIAL_STEPS
    width = (x[-1] - x[0]) / (len(x) - 1)
    trial = trial_steps if unit == "step" else 1  # in the unit of x
    first, in_batch = round((x[0] - width / 2) / trial), round(width / trial)
    return PublishedCurve(figure, condition, unit, x, mean, band, trial_steps, first, in_batch)
