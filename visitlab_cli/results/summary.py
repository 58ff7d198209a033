"""What a run reached: a line for each experiment, agent, human and point of the grid, over its seeds."""

import math
from collections.abc import Sequence
from pathlib import Path
from statistics import fmean, median
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import trials_of
from visitlab_cli.results.curves import in_batches
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import Group, groups_of, unit_values
from visitlab_cli.results.units import Units
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.facts import seconds_of
from visitlab_cli.storage.made_by import made_by

LEVEL = 0.9
"""The part of the final value that counts as learned."""
BATCHES = 100
"""A learning curve is looked at in so many equal parts (in trials, where there are fewer)."""


class Summary(NamedTuple):
    """A line of the table; what no finished cell tells is None.

    `value` is the mean over independent units (`n` of them) of the last tenth of trials (frozen: of all), `median`
    theirs. `steps_to_level` is the median over cells of `steps_to`, for `level` of the value; None where half of the
    cells or more never get there, or the value is not positive. `seconds` is the mean time of a cell, `sources` the
    hashes of the code that made the cells.
    """

    group: Group
    done: int
    n: int
    value: Estimate | None
    median: float | None
    level: float | None
    steps_to_level: float | None
    seconds: float | None
    sources: tuple[str, ...]

    @property
    def units(self) -> Units:
        """What the mean is taken over."""
        return Units(self.n, self.done)

    def as_json(self) -> dict[str, Any]:
        """The line as plain values."""
        return {
            "name": self.group.path,
            "experiment": self.group.experiment,
            "agent": self.group.agent,
            "human": self.group.human or None,
            "point": dict(self.group.point),
            "evaluation": self.group.evaluation.as_json() if self.group.evaluation.folder else None,
            "measure": f"{self.group.measure}, {self.group.part}",
            "cells_done": self.done,
            "cells": len(self.group.cells),
            "n": self.n,
            "n_of": self.units.of,
            **(self.value.as_json() if self.value else {"mean": None, "interval": None}),
            "median": self.median,
            "level": self.level,
            "steps_to_level": self.steps_to_level,
            "seconds_a_cell": self.seconds,
            "sources": list(self.sources),
        }

    def as_row(self) -> dict[str, Any]:
        """The line as one level of plain values: the point's paths are columns, the interval is `low` and `high`."""
        told = self.as_json()
        del told["evaluation"]  # a table is of one
        low, high = told.pop("interval") or (None, None)
        made_by = " and ".join(told.pop("sources"))
        return {**told.pop("point"), **told, "low": low, "high": high, "sources": made_by}


def summaries(run: Path, cells: Sequence[Cell], level: float = LEVEL) -> list[Summary]:
    """A line for each group of a run's cells.

    Args:
        run: the run's folder.
        cells: its plan.
        level: the part of a group's value that counts as learned, in (0, 1].
    """
    return [_summary(run, group, level) for group in groups_of(cells)]


def _summary(run: Path, group: Group, level: float) -> Summary:
    done = [cell for cell in group.cells if read_cell(run / cell.path) is not None]
    if not done:
        return Summary(group, 0, 0, None, None, None, None, None, ())
    values = list(unit_values(run, done).values())
    value = mean_of(values)
    seconds = [time for cell in done if (time := seconds_of(run / cell.path)) is not None]
    wanted = level * value.mean if value.mean > 0 else None
    return Summary(
        group,
        len(done),
        len(values),
        value,
        median(values),
        wanted,
        None if wanted is None else _median_steps(run, done, wanted),
        fmean(seconds) if seconds else None,
        tuple(made_by(run, (cell.path for cell in done))),
    )


def _median_steps(run: Path, cells: Sequence[Cell], level: float) -> float | None:
    steps = [steps_to(level, trials_of(run, cell)["reward"], cell.settings.trial_steps, cell.steps) for cell in cells]
    middle = median(steps)
    return middle if math.isfinite(middle) else None


def steps_to(level: float, rewards: npt.NDArray[np.float64], trial_steps: int, steps: int) -> float:
    """Steps at the end of the first batch of trials whose mean reward is at least `level`; inf if there is none.

    Args:
        level: reward a trial.
        rewards: of each trial, shape (trials,).
        trial_steps: steps in a trial.
        steps: of the whole cell, whose last trial may be cut short.
    """
    ends = np.linspace(0, len(rewards), min(BATCHES, len(rewards)) + 1).astype(np.int64)
    reached = np.flatnonzero(in_batches(rewards, ends) >= level)
    return float(min(ends[reached[0] + 1] * trial_steps, steps)) if len(reached) else math.inf
