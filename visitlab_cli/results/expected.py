"""The table of a run: for each module and visit the mean over its seeds, beside what the config expects of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from visitlab_cli.config.model import Config
from visitlab_cli.config.problems import or_else
from visitlab_cli.errors import ConfigError
from visitlab_cli.execution.cells import Cell
from visitlab_cli.results.groups import reached
from visitlab_cli.storage.arrays import read_trials
from visitlab_cli.storage.cell_folder import TRIALS, read_cell
from visitlab_cli.world.tasks import VISIT


@dataclass(frozen=True)
class Result:
    """One line of the table; `value` is None while no cell of the group is done."""

    group: str
    measure: str
    done: int
    cells: int
    value: float | None
    expected: float | None = None
    tolerance: float | None = None

    @property
    def difference(self) -> float | None:
        """Value less expected value, where both are there."""
        return None if self.value is None or self.expected is None else self.value - self.expected

    @property
    def missed(self) -> bool:
        """Whether the difference is beyond the tolerance."""
        return self.difference is not None and self.tolerance is not None and abs(self.difference) > self.tolerance

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


MEASURES = {
    True: ("mean_reward_last_tenth", "goals a trial, last tenth"),
    False: ("mean_reward_last_hundredth", "reward a trial, last 1%"),
}


def _values(run: Path, cells: Sequence[Cell], trials: Sequence[int] | None) -> tuple[str, list[float]]:
    """What is measured, and its value in each cell that is done; `trials` are the first and last, from 1."""
    if cells[0].frozen and trials is None:
        return "goals a trial, all trials", [value for cell in cells if (value := reached(run, cell)) is not None]
    key, measure = MEASURES[cells[0].task == VISIT]
    facts = {cell.path: found for cell in cells if (found := read_cell(run / cell.path)) is not None}
    if trials is None:
        return measure, [each[key] for each in facts.values()]
    first, last = trials
    rewards = [read_trials(run / path / TRIALS)["reward"][first - 1 : last] for path in facts]
    measure = f"{measure.partition(',')[0]}, {first} to {last}"
    return measure, [float(part.mean()) for part in rewards if len(part)]


def check_expected(config: Config, cells: Sequence[Cell]) -> None:
    """Nothing where each of the config's expected values can be checked, given all `cells` of its plan.

    Raises:
        ConfigError: one names no group of cells, or trials that they don't have.
    """
    trials = {cell.group: cell.trials for cell in cells}
    for group, expected in config.expected.items():
        if group not in trials:
            hint = "; with `vary` the point belongs to the name" if config.vary else ""
            raise ConfigError(f"expected.{group}: no such module or visit{hint}{or_else(group, list(trials))}")
        if expected.trials is not None and expected.trials[1] > trials[group]:
            raise ConfigError(f"expected.{group}.trials: up to {expected.trials[1]}, but there are {trials[group]}")


def results(run: Path, config: Config, cells: Sequence[Cell]) -> list[Result]:
    """A line for each group of cells that differ in nothing but their seeds."""
    groups: dict[str, list[Cell]] = {}
    for cell in cells:
        groups.setdefault(cell.group, []).append(cell)
    lines = []
    for group, members in groups.items():
        expected = config.expected.get(group)
        measure, values = _values(run, members, expected.trials if expected else None)
        value = sum(values) / len(values) if values else None
        lines.append(
            Result(
                group,
                measure,
                len(values),
                len(members),
                value,
                expected.value if expected else None,
                expected.tolerance if expected else None,
            )
        )
    return lines
