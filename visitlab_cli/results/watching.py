"""How far a run is, whoever does it and wherever: what is done, is being done or was left, looked at repeatedly."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.config.model import Config
from visitlab_cli.execution.versions import decided_by
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.plan.estimate import seconds_of
from visitlab_cli.plan.evaluation import Evaluation, recorded_evaluations
from visitlab_cli.results.evaluated import cells_of
from visitlab_cli.results.groups import groups_of
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.under_way import UnderWay, checkpoints_stated, under_way


class Part(NamedTuple):
    """How far some cells are: `cost` and `cost_done` are seconds of a core, as estimated."""

    cells: int
    done: int
    steps: int
    steps_done: int
    cost: float
    cost_done: float

    @property
    def share(self) -> float:
        """The part of the steps that is done, of 1."""
        return self.steps_done / max(self.steps, 1)

    def as_json(self) -> dict[str, Any]:
        """Cells and steps as plain values."""
        return {"cells": self.cells, "done": self.done, "steps": self.steps, "steps_done": self.steps_done}


class Look(NamedTuple):
    """A run at one moment: all of it, its groups of cells by their paths, and the cells that are being done.

    `left` are those that nobody does now, with the steps from which they would be gone on with here.
    """

    run: Path
    whole: Part
    groups: dict[str, Part]
    cells: list[tuple[UnderWay, Cell]]
    left: list[tuple[int, Cell]]

    def as_json(self) -> dict[str, Any]:
        """As plain values."""
        cells = [
            {
                "cell": each.cell,
                "host": each.owner.host,
                "process": each.owner.process,
                "steps": cell.steps,
                "steps_done": min(each.steps, cell.steps),
                "seconds_silent": round(each.silent, 1),
            }
            for each, cell in self.cells
        ]
        groups = [{"name": name, **part.as_json()} for name, part in self.groups.items()]
        left = [{"cell": cell.path, "steps": cell.steps, "steps_done": steps} for steps, cell in self.left]
        return {"run": str(self.run), **self.whole.as_json(), "groups": groups, "under_way": cells, "left": left}


class Watch:
    """Looks at a run, each cell that was found done only once."""

    def __init__(self, run: Path, config: Config) -> None:
        """At a run with this config."""
        self._run, self._config = run, config
        self._cells = plan(config)
        self._evaluations: dict[Evaluation, list[Cell]] = {}
        self._done: set[str] = set()
        self._costs: dict[str, float] = {}

    def look(self) -> Look:
        """Look at what is there now; of evaluations at the visits that have begun.

        Raises:
            UnreadableError: something can't be read now.
        """
        for options in recorded_evaluations(self._run):
            if options not in self._evaluations:
                self._evaluations[options] = cells_of(self._config, options)
        now = {each.cell: each for each in under_way(self._run)}
        played = [cell for cells in self._evaluations.values() for cell in cells]
        for cell in (*self._cells, *played):
            if cell.path not in self._done and read_cell(self._run / cell.path) is not None:
                self._done.add(cell.path)
        steps = self._kept({cell.path: cell for cell in (*self._cells, *played)})
        for path, each in now.items():
            now[path] = each._replace(steps=max(each.steps, steps.get(path, 0)))  # it has begun to go on
            steps[path] = now[path].steps
        begun = {cell.group for cell in played if cell.path in self._done or cell.path in steps}
        cells = [*self._cells, *(cell for cell in played if cell.group in begun)]
        groups = {group.path: self._part(group.cells, steps) for group in groups_of(cells)}
        to_do = [cell for cell in cells if cell.path in steps and cell.path not in self._done]
        running = [(now[cell.path], cell) for cell in to_do if cell.path in now]
        left = [(steps[cell.path], cell) for cell in to_do if cell.path not in now]
        return Look(self._run, self._part(cells, steps), groups, running, left)

    def _kept(self, cells: dict[str, Cell]) -> dict[str, int]:
        """The steps of the newest checkpoint of each cell that this program would go on from."""
        found: dict[str, int] = {}
        for told in checkpoints_stated(self._run):
            cell, steps = cells.get(str(told.get("cell"))), told.get("steps")
            if cell is None or type(steps) is not int or not 0 < steps <= cell.steps:
                continue
            if decided_by(cell).items() <= told.items():
                found[cell.path] = max(steps, found.get(cell.path, 0))
        return found

    def _part(self, cells: Iterable[Cell], steps_of: dict[str, int]) -> Part:
        number = done = steps = steps_done = 0
        cost = cost_done = 0.0
        for cell in cells:
            is_done = cell.path in self._done
            of_cell = cell.steps if is_done else min(steps_of.get(cell.path, 0), cell.steps)
            seconds = self._cost(cell)
            number, done, steps, steps_done = number + 1, done + is_done, steps + cell.steps, steps_done + of_cell
            cost, cost_done = cost + seconds, cost_done + seconds * of_cell / cell.steps
        return Part(number, done, steps, steps_done, cost, cost_done)

    def _cost(self, cell: Cell) -> float:
        if cell.path not in self._costs:
            self._costs[cell.path] = seconds_of(cell)
        return self._costs[cell.path]
