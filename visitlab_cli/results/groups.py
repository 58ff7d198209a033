"""The cells of a run in groups that differ in nothing but their seeds, and what each independent unit reached."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.config.grid import value_in_words
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.evaluation import Evaluation
from visitlab_cli.plan.saved import trials_of
from visitlab_cli.results.units import by_unit
from visitlab_cli.storage.cell_folder import read_cell

Point = tuple[tuple[str, str], ...]
"""The values of a point of the grid by their paths, as far as they matter to a cell, in words."""


class Group(NamedTuple):
    """Cells of the same experiment, agent, human and point of the grid; `path` is what their paths share."""

    path: str
    experiment: str
    agent: str
    human: str
    point: Point
    cells: list[Cell]

    @property
    def evaluation(self) -> Evaluation:
        """What differs from the config."""
        return self.cells[0].evaluation

    @property
    def measure(self) -> str:
        """What a trial's reward is."""
        return self.cells[0].settings.plays.measure

    @property
    def part(self) -> str:
        """Which trials count."""
        return "all trials" if self.evaluation.frozen else "last tenth"


def groups_of(cells: Sequence[Cell]) -> list[Group]:
    """The groups in the order of their first cells."""
    found: dict[str, Group] = {}
    for cell in cells:
        group = Group(cell.group, cell.experiment, cell.agent, cell.human, point_of(cell), [])
        found.setdefault(cell.group, group).cells.append(cell)
    return list(found.values())


def point_of(cell: Cell) -> Point:
    """Where a cell lies in the grid, as far as that matters to it."""
    return tuple((path, value_in_words(value)) for path, value in cell.point.items())


def reached(run: Path, cell: Cell) -> float | None:
    """Reward a trial in the last tenth of a cell; frozen, all its trials are alike and count. None where unfinished.

    Raises:
        RunError: a table of trials is damaged.
    """
    facts = read_cell(run / cell.path)
    if facts is None:
        return None
    if cell.frozen:
        return float(trials_of(run, cell)["reward"].mean())
    return float(facts["mean_reward_last_tenth"])


Measure = Callable[[Path, Cell], float | None]
"""A number from a run's cell; None where it is not finished."""


def unit_values(run: Path, cells: Sequence[Cell], measure: Measure = reached) -> dict[str, float]:
    """The mean of a measure over the cells of each independent unit, by its name; finished cells only."""
    found = {unit: [measure(run, cell) for cell in members] for unit, members in by_unit(cells).items()}
    done = {unit: [value for value in values if value is not None] for unit, values in found.items()}
    return {unit: sum(values) / len(values) for unit, values in done.items() if values}
