"""Conditions two by two: agents, humans, visits, values of a varied setting in a run, or the same in two runs.

Seeds are paired where the same seed means the same luck: visits that play with the same trained modules (by experiment
with some that are the same), and the same cell of two runs with the same root seed, which draws the same random
numbers. Other seeds are independent: the random numbers of a cell depend on its path.
"""

import json
from collections.abc import Iterator, Sequence
from functools import partial
from itertools import combinations
from pathlib import Path
from statistics import fmean
from typing import Any, NamedTuple

from visitlab_cli.errors import NotFoundError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import trials_of
from visitlab_cli.results.estimates import Estimate, difference_of, mean_of, probability_of_improvement
from visitlab_cli.results.groups import Group, Measure, Point, groups_of, reached, unit_values
from visitlab_cli.results.units import unit_of
from visitlab_cli.settings import as_yaml
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.wording import or_else
from visitlab_cli.world.tasks import SOCIAL

AGENT, HUMAN, EXPERIMENT, PHASE = "agent", "human", "experiment", "phase"
"""What conditions may differ in; what came of each phase is told by `results.phases`."""
LAST_TENTH, WHOLE_PHASE = "last tenth", "all of the phase"
Values = dict[str, float]
"""What each independent seed reached, by its name."""


class Side(NamedTuple):
    """One of two conditions: its name, how many independent units it is the mean of.

    The name is the `value` that is compared and the settings of the `point` that belong to it.
    """

    name: str
    mean: float
    n: int
    value: str = ""
    point: Point = ()

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return {"name": self.name, "mean": self.mean, "n": self.n}


class Pair(NamedTuple):
    """Two conditions of the same kind; `difference` is the second's less the first's.

    `n` is the number of pairs where they are paired. The probability that a seed of the second is better than one
    of the first is over all combinations of seeds. `groups` are the cells of the two.
    """

    where: str
    measure: str
    first: Side
    second: Side
    difference: Estimate
    paired: bool
    n: int
    probability_of_improvement: float
    groups: tuple[Group, Group]
    condition: str = ""
    """Where they are compared but for the point of the grid, which is `same`."""
    same: Point = ()
    part: str = LAST_TENTH
    """Which trials count."""

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "where": self.where,
            "measure": f"{self.measure}, {self.part}",
            "first": self.first.as_json(),
            "second": self.second.as_json(),
            "difference": self.difference.mean,
            "interval": self.difference.as_json()["interval"],
            "paired": self.paired,
            "n": self.n,
            "probability_of_improvement": self.probability_of_improvement,
        }


class Compared(NamedTuple):
    """All pairs, and the paths of the finished groups that are in none."""

    pairs: list[Pair]
    alone: list[str]


class _Member(NamedTuple):
    """A group with its `value` of the key; groups are compared where `alike` is the same, and their points go together.

    `own` are the paths of its point that belong to its value, `where` is the rest of its name.
    """

    group: Group
    value: str
    alike: str
    where: list[str]
    point: dict[str, str]
    own: set[str]
    reached: Values
    part: str = LAST_TENTH


def compare_by(run: Path, cells: Sequence[Cell], key: str, phase: int | None = None) -> Compared:
    """All pairs of conditions of a run that differ in `key` alone: agent, human, experiment, or a path that varies.

    What varies of an agent or a human itself belongs to it: each of its settings is compared with each other agent
    or human. The agent of a visit is that of its social module, so that visits which differ in it alone are compared,
    whatever the experiments are called.

    By experiment visits are compared, each with the first one of modules of the same agents (of a pool they are one
    agent) and with the same human, whatever else they have otherwise; with phases phase by phase.

    Args:
        run: the run's folder.
        cells: its plan.
        key: what they differ in.
        phase: that of all with phases all trials of this one are compared, and nothing else.

    Raises:
        NotFoundError: the run has no such key, nothing with such a phase, or nothing that is done differs in it.
    """
    groups = groups_of(cells)
    known = [AGENT, HUMAN, EXPERIMENT, *([PHASE] if any(cell.settings.phases for cell in cells) else [])]
    known += dict.fromkeys(path for group in groups for path, _ in group.point)
    if key not in known:
        raise NotFoundError(f"--by {key}: the run has no such key{or_else(key, known)}")
    last = max(len(cell.settings.phases) for cell in cells) - 1
    if phase is not None and phase > last:
        there = f"phases are 0 to {last}" if last >= 0 else "it has no phases"
        raise NotFoundError(f"--phase {phase}: the run has none such; {there}")
    members = [each for group in groups for each in _members(run, group, key, phase)]
    pairs, paired, seconds = [], set(), set()
    for (_, first), (number, second) in combinations(enumerate(members), 2):
        place = None if key == EXPERIMENT and number in seconds else _place(first, second, key)
        if place is not None:
            both = first.group, second.group
            sides = first.reached, second.reached
            if key == EXPERIMENT:
                sides = _by_common_modules(sides[0], *both), _by_common_modules(sides[1], *both[::-1])
            pair = _pair(place, both, *sides, same_luck=True)
            pairs.append(pair._replace(part=first.part))
            paired |= {first.group.path, second.group.path}
            seconds.add(number)
    if not pairs:
        raise NotFoundError(f"{run}: nothing that is done differs in {key} alone")
    alone = dict.fromkeys(each.group.path for each in members if each.group.path not in paired)
    return Compared(pairs, list(alone))


def compare_runs(first: tuple[Path, Sequence[Cell]], second: tuple[Path, Sequence[Cell]]) -> Compared:
    """Every condition that two runs, each with its plan, both have finished cells of; `alone` are those of one only.

    Raises:
        NotFoundError: there is none.
    """
    groups, theirs = groups_of(first[1]), {group.path: group for group in groups_of(second[1])}
    pairs = []
    for group in groups:
        other = theirs.get(group.path)
        if other is None or other.cells[0].task != group.cells[0].task:
            continue
        values, other_values = unit_values(first[0], group.cells), unit_values(second[0], other.cells)
        if values and other_values:
            same_luck = group.cells[0].config.seed == other.cells[0].config.seed
            sides = (first[0].name, ()), (second[0].name, ())
            place = _Place(group.path, group.cells[0].condition, group.point, *sides)
            pairs.append(_pair(place, (group, other), values, other_values, same_luck=same_luck))
    if not pairs:
        raise NotFoundError(f"{first[0]} and {second[0]}: have no finished experiment, agent and human in common")
    both = {pair.where for pair in pairs}
    done = [(run, each) for run, of_run in ((first[0], groups), (second[0], theirs.values())) for each in of_run]
    alone = [f"{run.name}/{each.path}" for run, each in done if each.path not in both and unit_values(run, each.cells)]
    return Compared(pairs, alone)


def _members(run: Path, group: Group, key: str, phase: int | None) -> Iterator[_Member]:
    """A group seen by `key`: none, one, or by experiment one for each phase."""
    if key == EXPERIMENT:
        yield from _visits(run, group, phase)
    elif (member := _member(run, group, key, phase)) is not None:
        yield member


def _visits(run: Path, group: Group, only: int | None) -> Iterator[_Member]:
    """A visit, or each phase of it, where it is done."""
    settings, own = group.cells[0].settings, {path for path in dict(group.point) if _belongs(path, group, EXPERIMENT)}
    if not settings.assembled:
        return
    agents = [settings.starts[role].agent for role in (*settings.steering, SOCIAL)]
    parts = [_phase(group, number) for number in range(len(settings.phases)) if only in (None, number)]
    if not parts and only is None:
        parts = [([group.human], LAST_TENTH, reached)]
    for where, part, measure in parts:
        if found := unit_values(run, group.cells, measure):
            alike = json.dumps([agents, *where])
            yield _Member(group, group.experiment, alike, where, dict(group.point), own, found, part)


def _phase(group: Group, number: int) -> tuple[list[str], str, Measure]:
    """Where a phase of a group is compared, which trials count, and what they come to."""
    settings = group.cells[0].settings
    begins = sum(settings.phase_trials[:number])
    measure = partial(_mean_of_trials, (begins, begins + settings.phase_trials[number]))
    met = settings.phases[number].met
    return [*([met] if met else []), f"phase {number}"], WHOLE_PHASE, measure


def _by_common_modules(values: Values, group: Group, other: Group) -> Values:
    """What each unit reached, named by those of its modules with which the other visits play, too, if there are any."""
    theirs = {path for cell in other.cells for path in cell.modules.values()}
    common = {unit_of(cell): sorted(theirs.intersection(cell.modules.values())) for cell in group.cells}
    return {" ".join(common[unit]) or unit: value for unit, value in values.items()}


def _mean_of_trials(between: Sequence[int], run: Path, cell: Cell) -> float | None:
    """Reward a trial from a trial to before another one; None where the cell is not finished."""
    if read_cell(run / cell.path) is None:
        return None
    return float(trials_of(run, cell)["reward"][slice(*between)].mean())


def _member(run: Path, group: Group, key: str, phase: int | None) -> _Member | None:
    """A group seen by `key`; None where it has no value of it, no such phase, or nothing that is done."""
    point, settings, experiment = dict(group.point), group.cells[0].settings, group.experiment
    value = {AGENT: group.agent, HUMAN: group.human}.get(key) or point.get(key, "")
    if not value or (phase is not None and phase >= len(settings.phases)):
        return None
    place, part, measure = ([group.human], LAST_TENTH, reached) if phase is None else _phase(group, phase)
    found = unit_values(run, group.cells, measure)
    if not found:
        return None
    told_of_agent = key != AGENT and not _chooses_social(key, group)
    where = [group.agent] if group.agent and told_of_agent else []
    where += [word for word in place if word and key != HUMAN]
    if key == AGENT and settings.assembled:
        experiment = json.dumps(as_yaml(settings.with_any_agent().model_copy(update={"humans": ()})))
    own = {path for path in point if path == key or _belongs(path, group, key)}
    return _Member(group, value, " ".join([experiment, *where]), where, point, own, found, part)


class _Place(NamedTuple):
    """Where two groups are compared: as `Pair` has it; what each is called there, value and settings."""

    where: str
    condition: str
    same: Point
    first: tuple[str, Point]
    second: tuple[str, Point]


def _place(first: _Member, second: _Member, key: str) -> _Place | None:
    """Where two groups are compared, and what each is called there; None where more than the key differs.

    A path that both depend on has the same value in both, unless it is what they are compared by; one that only one
    of them depends on belongs to its value of the key.
    """
    if first.alike != second.alike or first.value == second.value:
        return None
    common = [path for path in first.point if path in second.point]
    compared = {path for path in common if path == key or (key == AGENT and _chooses_social(path, first.group))}
    differ = any(first.point[path] != second.point[path] for path in common if path not in compared)
    alone = [{path for path in each.point if path not in common} - each.own for each in (first, second)]
    if differ or any(alone):
        return None
    experiments = [] if key == EXPERIMENT else [first.group.experiment, second.group.experiment]
    condition = " ".join(filter(None, ["/".join(dict.fromkeys(experiments)), *first.where]))
    same = tuple((path, first.point[path]) for path in common if path not in compared)
    one, other = (
        (each.value, tuple((p, v) for p, v in each.point.items() if p != key and (p not in common or p in compared)))
        for each in (first, second)
    )
    return _Place(_told(condition, same), condition, same, one, other)


def _told(name: str, point: Point) -> str:
    return " ".join([name, *(f"{path}={value}" for path, value in point)])


def _belongs(path: str, group: Group, key: str) -> bool:
    """Whether what varies at a path is a part of the group's agent, human or experiment."""
    if key == EXPERIMENT:
        return path.startswith(f"experiments.{group.experiment}.")
    if key == HUMAN:
        return path.startswith(f"humans.{group.human}.")
    if key != AGENT:
        return False
    parameters = group.cells[0].config.agents[group.agent]
    agents = group.agent, *(getattr(parameters, reference) for reference in parameters.references)
    ours = any(f"{path}.".startswith(f"agents.{agent}.") for agent in agents)
    return ours or _chooses_social(path, group)


def _chooses_social(path: str, group: Group) -> bool:
    """Whether a visit's social module, and with it its agent, is what varies at a path."""
    modules = f"experiments.{group.experiment}.modules"
    return group.cells[0].settings.assembled and path in (modules, f"{modules}.social")


def _pair(place: _Place, groups: tuple[Group, Group], ours: Values, theirs: Values, *, same_luck: bool) -> Pair:
    common = [unit for unit in ours if unit in theirs] if same_luck else []
    values, other_values = list(ours.values()), list(theirs.values())
    if common:
        values, other_values = [ours[unit] for unit in common], [theirs[unit] for unit in common]
        difference = mean_of([b - a for a, b in zip(values, other_values, strict=True)])
    else:
        difference = difference_of(values, other_values)
    n = len(common) or min(len(values), len(other_values))
    better = probability_of_improvement(values, other_values)
    first, second = (
        Side(_told(*told), fmean(reached), len(reached), *told)
        for told, reached in ((place.first, values), (place.second, other_values))
    )
    where = place.where, groups[0].measure
    return Pair(*where, first, second, difference, bool(common), n, better, groups, place.condition, place.same)
