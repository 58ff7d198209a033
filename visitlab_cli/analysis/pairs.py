"""Conditions two by two: agents, humans, values of a varied setting in a run, or the same condition in two runs.

Seeds are paired where the same seed means the same luck: visits that play with the same trained modules, and the
same cell of two runs with the same root seed, which draws the same random numbers. Other seeds are independent:
the random numbers of a cell depend on its path.
"""

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

from visitlab_cli.analysis.summary_estimate import Estimate, difference_of, mean_of, probability_of_improvement
from visitlab_cli.analysis.summary_groups import Group, groups_of, unit_values
from visitlab_cli.config.problems import or_else
from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.execution.cells import Cell

AGENT, HUMAN = "agent", "human"
Values = dict[str, float]
"""What each independent seed reached, by its name."""


class Side(NamedTuple):
    """One of two conditions: its name, how many seeds it is the mean of."""

    name: str
    mean: float
    n: int

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return self._asdict()


class Pair(NamedTuple):
    """Two conditions of the same kind; `difference` is the second's less the first's.

    `n` is the number of pairs where they are paired. The probability that a seed of the second is better than one
    of the first is over all combinations of seeds.
    """

    where: str
    measure: str
    first: Side
    second: Side
    difference: Estimate
    paired: bool
    n: int
    probability_of_improvement: float

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "where": self.where,
            "measure": f"{self.measure}, last tenth",
            "first": self.first.as_json(),
            "second": self.second.as_json(),
            "difference": self.difference.mean,
            "interval": self.difference.as_json()["interval"],
            "paired": self.paired,
            "n": self.n,
            "probability_of_improvement": self.probability_of_improvement,
        }


def compare_by(run: Path, cells: Sequence[Cell], key: str) -> list[Pair]:
    """All pairs of conditions of a run that differ in `key` alone: agent, human, or a path that varies.

    Raises:
        UsageError: the run has no such key.
        NotFoundError: nothing that is done differs in it.
    """
    groups = groups_of(cells)
    known = [AGENT, HUMAN, *dict.fromkeys(path for group in groups for path, _ in group.point)]
    if key not in known:
        raise UsageError(f"--by {key}: the run has no such key{or_else(key, known)}")
    alike: dict[str, list[tuple[str, Group, Values]]] = {}
    for group in groups:
        condition, where = _split(group, key)
        values = unit_values(run, group.cells)
        if condition and values:
            alike.setdefault(where, []).append((condition, group, values))
    pairs = [
        _pair(where, group.measure, (first, ours), (second, theirs), same_luck=True)
        for where, members in alike.items()
        for (first, group, ours), (second, _, theirs) in combinations(members, 2)
    ]
    if not pairs:
        raise NotFoundError(f"{run}: nothing that is done differs in {key} alone")
    return pairs


def compare_runs(first: tuple[Path, Sequence[Cell]], second: tuple[Path, Sequence[Cell]]) -> list[Pair]:
    """Every condition that two runs, each with its plan, both have finished cells of.

    Raises:
        NotFoundError: there is none.
    """
    theirs = {group.path: group for group in groups_of(second[1])}
    pairs = []
    for group in groups_of(first[1]):
        other = theirs.get(group.path)
        if other is None or other.cells[0].task != group.cells[0].task:
            continue
        values, other_values = unit_values(first[0], group.cells), unit_values(second[0], other.cells)
        if values and other_values:
            same_luck = group.cells[0].config.seed == other.cells[0].config.seed
            sides = (first[0].name, values), (second[0].name, other_values)
            pairs.append(_pair(group.path, group.measure, *sides, same_luck=same_luck))
    if not pairs:
        raise NotFoundError(f"{first[0]} and {second[0]}: have no finished experiment, agent and human in common")
    return pairs


def _split(group: Group, key: str) -> tuple[str, str]:
    """A group's condition as far as `key` goes, empty where it has none, and all else that says where it is."""
    point = dict(group.point)
    named = {"experiment": group.experiment, AGENT: group.agent, HUMAN: group.human}
    condition = named[key] if key in named else point.pop(key, "")
    rest = [value for name, value in named.items() if name != key and value]
    return condition, " ".join([*rest, *(f"{path}={value}" for path, value in point.items())])


def _pair(where: str, measure: str, first: tuple[str, Values], second: tuple[str, Values], *, same_luck: bool) -> Pair:
    ours, theirs = first[1], second[1]
    common = [unit for unit in ours if unit in theirs] if same_luck else []
    values, other_values = list(ours.values()), list(theirs.values())
    if common:
        values, other_values = [ours[unit] for unit in common], [theirs[unit] for unit in common]
        difference = mean_of([b - a for a, b in zip(values, other_values, strict=True)])
    else:
        difference = difference_of(values, other_values)
    n = len(common) or min(len(values), len(other_values))
    better = probability_of_improvement(values, other_values)
    sides = Side(first[0], fmean(values), len(values)), Side(second[0], fmean(other_values), len(other_values))
    return Pair(where, measure, *sides, difference, bool(common), n, better)
