"""The table of a run: for each module and visit the mean over its seeds, beside what the config expects of it."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from statistics import fmean
from typing import Any

from visitlab_cli.config.model import Config
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import trials_of
from visitlab_cli.results.groups import Measure, Point, groups_of, reached, unit_values
from visitlab_cli.storage.cell_folder import read_cell


@dataclass(frozen=True)
class Result:
    """One line of the table: `value` is the mean over independent units, None while no cell of the group is done."""

    group: str
    measure: str
    done: int
    cells: int
    value: float | None
    expected: float | None = None
    tolerance: float | None = None
    condition: str = ""
    """The group without its point of the grid, which is `point`."""
    point: Point = ()

    @property
    def difference(self) -> float | None:
        """Value less expected value, where both are there."""
        return None if self.value is None or self.expected is None else self.value - self.expected

    @property
    def missed(self) -> bool:
        """Whether the difference is beyond the tolerance."""
        return self.difference is not None and self.tolerance is not None and abs(self.difference) > self.tolerance

    def if_finished(self) -> "Result":
        """The line, without what is expected where cells are missing."""
        return self if self.done == self.cells else replace(self, expected=None, tolerance=None)

    def as_json(self) -> dict[str, Any]:
        """The line as plain values."""
        return {
            "name": self.group,
            "measure": self.measure,
            "cells_done": self.done,
            "cells": self.cells,
            "value": self.value,
            "expected": self.expected,
            "tolerance": self.tolerance,
            "difference": self.difference,
            "within_tolerance": None if self.difference is None else not self.missed,
        }


SETTLED = {True: ("mean_reward_last_tenth", "last tenth"), False: ("mean_reward_last_hundredth", "last 1%")}
"""What of a cell is expected, by whether its task counts goals: as `cell.json` calls it, and in words."""


def _measured(cells: Sequence[Cell], trials: Sequence[int] | None) -> tuple[str, Measure]:
    """What is measured of these cells, and how in each; `trials` are the first and last, from 1."""
    task = cells[0].settings.plays
    if cells[0].frozen and trials is None:
        return f"{task.measure}, all trials", reached
    key, part = SETTLED[task.counts_goals]
    if trials is None:
        return f"{task.measure}, {part}", partial(_fact, key=key)
    first, last = trials

    def between(run: Path, cell: Cell) -> float | None:
        if read_cell(run / cell.path) is None:
            return None
        part = trials_of(run, cell)["reward"][first - 1 : last]
        return float(part.mean()) if len(part) else None

    return f"{task.measure}, {first} to {last}", between


def _fact(run: Path, cell: Cell, *, key: str) -> float | None:
    facts = read_cell(run / cell.path)
    return None if facts is None else facts[key]


def results(run: Path, config: Config, cells: Sequence[Cell]) -> list[Result]:
    """A line for each group of cells that differ in nothing but their seeds."""
    lines = []
    for group in groups_of(cells):
        expected = config.expected.get(group.path)
        measure, measured = _measured(group.cells, expected.trials if expected else None)
        values = unit_values(run, group.cells, measured)
        lines.append(
            Result(
                group.path,
                measure,
                sum(read_cell(run / cell.path) is not None for cell in group.cells),
                len(group.cells),
                fmean(values.values()) if values else None,
                expected.value if expected else None,
                expected.tolerance if expected else None,
                group.cells[0].condition,
                group.point,
            )
        )
    return lines
