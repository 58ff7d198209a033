"""Where figures find their data: the finished cells of a run, by the names that the paper's configs give."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import numpy.typing as npt

from visitlab_cli.config.model import Config
from visitlab_cli.paper.published.counterparts import Condition, Counterpart, counterparts
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.plan.saved import trials_of, values_of
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.run_folder import read_config

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Group:
    """The finished cells that differ in nothing but their seeds, and how many the config declares."""

    name: str
    run: Path
    cells: Sequence[Cell]
    declared: int

    def rewards(self) -> Floats:
        """The reward of each trial (in a visit its goals), shape (cells, trials)."""
        return np.stack([trials_of(self.run, cell, as_planned=True)["reward"] for cell in self.cells])

    def tables(self) -> Floats:
        """The learned Q of each cell, shape (cells, states, actions)."""
        return np.stack([values_of(self.run, cell) for cell in self.cells])


@dataclass(frozen=True)
class Source:
    """A run: its config, and its groups that have at least one finished cell, by name."""

    run: Path
    config: Config
    groups: dict[str, Group]

    @cached_property
    def counterparts(self) -> dict[Condition, Counterpart]:
        """What it has for each published curve."""
        return counterparts([group.cells[0] for group in self.groups.values()])

    def reference(self, name: str, beside: Cell) -> float | None:
        """Mean reward a trial of an `experiment/agent/human`, where a grid has several that of the point of a cell."""
        for group in self.groups.values():
            cell = group.cells[0]
            if name == cell.condition and all(
                cell.point.get(path, value) == value for path, value in beside.point.items()
            ):
                return float(group.rewards().mean())
        return None

    def lacks(self, names: Sequence[str]) -> list[str]:
        """What is to be said of those `experiment/agent/human` that are no single group: absent, or a grid's."""
        of_grid = {group.cells[0].condition for group in self.groups.values()}
        missing = [name for name in names if name not in of_grid]
        varied = [name for name in names if name in of_grid and name not in self.groups]
        told = (missing, "not in this run"), (varied, "varies in this run")
        return [f"without {', '.join(dict.fromkeys(found))}: {why}" for found, why in told if found]

    def shortfall(self, names: Sequence[str]) -> str:
        """Which of the groups are there in part only: 'social/mb/human_1 has 7 of 10 cells'; else nothing."""
        found = [self.groups[name] for name in names if name in self.groups]
        short = [group for group in found if len(group.cells) < group.declared]
        return ", ".join(f"{group.name} has {len(group.cells)} of {group.declared} cells" for group in short)


def open_source(run: Path) -> Source:
    """What a run folder holds.

    Raises:
        NotFoundError: this is no run folder.
        RunError: its config is damaged.
    """
    config = read_config(run)
    declared: dict[str, list[Cell]] = {}
    for cell in plan(config):
        declared.setdefault(cell.group, []).append(cell)
    groups = {}
    for name, cells in declared.items():
        done = [cell for cell in cells if read_cell(run / cell.path) is not None]
        if done:
            groups[name] = Group(name, run, done, len(cells))
    return Source(run, config, groups)
