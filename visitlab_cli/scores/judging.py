"""From finished cells to scores: (value - random) / (best - random), seed by seed, and the interval over seeds."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import trials_of
from visitlab_cli.results.costs import microseconds, updates
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import reached
from visitlab_cli.scores.anchors import EXACT, Best, best_of
from visitlab_cli.scores.asking import Asked
from visitlab_cli.scores.rows import COSTS, Row, Rows
from visitlab_cli.storage.cell_folder import read_cell

RANDOM = "random actions, played on the same cells"


class Line(NamedTuple):
    """What an agent reached in a row: the score from 0 to 1, and the value in the row's unit; `n` seeds.

    `random` and `best` are the values that count as 0 and 1, means over the row's groups of cells; `best_is` says what
    the best is. Of what has no answer, `reason` says why.
    """

    row: str
    question: str
    unit: str
    n: int
    score: Estimate | None = None
    value: Estimate | None = None
    random: float | None = None
    best: float | None = None
    best_is: str | None = None
    reason: str | None = None

    @property
    def scored(self) -> bool:
        """Whether it has a score where it has an answer."""
        return self.unit not in COSTS.values()

    def as_json(self) -> dict[str, Any]:
        """The line as plain values."""
        return self._asdict() | {
            name: None if each is None else each.as_json()
            for name, each in (("score", self.score), ("value", self.value))
        }


class Card(NamedTuple):
    """An agent's lines, and the run that holds what they were judged by; None where it could play nothing."""

    agent: str
    kind: str
    parameters: Mapping[str, Any]
    run: Path | None
    lines: Sequence[Line]

    def as_json(self) -> dict[str, Any]:
        """The card as plain values."""
        run = None if self.run is None else str(self.run)
        lines = [line.as_json() for line in self.lines]
        return {"agent": self.agent, "kind": self.kind, "parameters": dict(self.parameters), "run": run, "rows": lines}


class Played(NamedTuple):
    """An agent's run, and what failed in it, by the paths of cells."""

    asked: Asked
    run: Path | None
    failures: Mapping[str, str]


def judge(rows: Rows, names: Sequence[str], played: Played, floor: Played) -> Card:
    """The card of an agent for some rows; `floor` is the run of random actions.

    Raises:
        RunError: what a cell holds is damaged.
        UsageError: the rows ask for an optimum that nobody knows.
    """
    contender = played.asked.contender
    plain = {key: value for key, value in contender.declared[contender.name].items() if key != "kind"}
    lines = [_line(rows, name, played, floor) for name in names]
    return Card(contender.name, contender.parameters.kind, plain, played.run, lines)


def _line(rows: Rows, name: str, played: Played, floor: Played) -> Line:
    row = rows.rows[name]
    (unit,) = {_unit(row, floor.asked.cells_of(rows, name))}
    empty = Line(name, row.question, unit, 0)
    if why := played.asked.why_not(rows, name):
        return empty._replace(reason=why)
    groups = played.asked.cells_of(rows, name)
    values = [_by_seed(played, cells, row) for cells in groups]
    seeds = sorted(set.intersection(*map(set, values)))
    if not seeds:
        return empty._replace(reason=_missing(played, groups))
    found = mean_of([fmean(each[seed] for each in values) for seed in seeds])
    line = empty._replace(n=len(seeds), value=found)
    if not row.scored:
        return line
    lows = [list(_by_seed(floor, cells, row).values()) for cells in floor.asked.cells_of(rows, name)]
    if not all(lows):
        return line._replace(reason="what random actions reach is missing")
    zeros = [fmean(each) for each in lows]
    ones = [best_of(rows, row, cells[0]) for cells in groups]
    scores = [fmean(map(share, (each[seed] for each in values), zeros, ones)) for seed in seeds]
    return line._replace(
        score=mean_of(scores),
        random=fmean(zeros),
        best=fmean(one.value for one in ones),
        best_is=", ".join(dict.fromkeys(one.source for one in ones)),
    )


def share(value: float, zero: float, one: Best) -> float:
    """0 as random, 1 as the best; below and above where a value is."""
    return (value - zero) / (one.value - zero)


def _unit(row: Row, groups: Sequence[Sequence[Cell]]) -> str:
    return COSTS[row.measure] if row.measure in COSTS else groups[0][0].settings.plays.measure


def _by_seed(played: Played, cells: Sequence[Cell], row: Row) -> dict[int, float]:
    """What is measured of each finished cell, by its seed."""
    assert played.run is not None
    done = [cell for cell in cells if read_cell(played.run / cell.path) is not None]
    found = {cell.seed: _MEASURES[row.measure](played.run, cell) for cell in done}
    return {seed: value for seed, value in found.items() if value is not None}


def _missing(played: Played, groups: Sequence[Sequence[Cell]]) -> str:
    paths = [cell.path for cells in groups for cell in cells]
    return next((f"failed: {played.failures[path]}" for path in paths if path in played.failures), "not known")


def _all_trials(run: Path, cell: Cell) -> float:
    return float(trials_of(run, cell)["reward"].mean())


_MEASURES: Mapping[str, Callable[[Path, Cell], float | None]] = {
    "level": reached,
    "all": _all_trials,
    "cpu": microseconds,
    "updates": updates,
}


class Scorecard(NamedTuple):
    """The cards of some agents for the same rows; `rows` is the set's label, with which a score is quoted."""

    set: int
    rows: str
    seeds: int
    cards: Sequence[Card]

    def as_json(self) -> dict[str, Any]:
        """All of it as plain values."""
        return {
            "set": self.set,
            "rows": self.rows,
            "seeds": self.seeds,
            "random": RANDOM,
            "agents": [card.as_json() for card in self.cards],
        }

    @property
    def scored(self) -> list[str]:
        """The rows that have scores, in their order."""
        return [line.row for line in self.cards[0].lines if line.scored]

    @property
    def is_exact(self) -> dict[str, bool]:
        """Whether 1 is the exact optimum, by the row, where anybody has a score."""
        return {line.row: line.best_is == EXACT for card in self.cards for line in card.lines if line.score}
