"""What varies in a run's grid, as data: lines of the level against a varied setting, and groups to draw curves of."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from visitlab_cli.paper.figures.source import Source
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import Group, groups_of, unit_values
from visitlab_cli.results.units import Units
from visitlab_cli.results.varying import NOTHING, Varying, names_within, varying


@dataclass(frozen=True)
class Axis:
    """A varied path, what it is called, and its values in the order of the grid; `numbers` where all are such."""

    path: str
    head: str
    values: list[str]
    numbers: list[float] | None

    @property
    def place(self) -> list[float]:
        """Where each value lies on the axis."""
        return self.numbers or [float(place) for place in range(len(self.values))]


@dataclass(frozen=True)
class Line:
    """Groups of an experiment that differ in an axis alone, each with its place among the axis' values.

    `levels` are what they reached, `units` what these are means over.
    """

    name: str
    groups: dict[int, Group]
    levels: dict[int, Estimate]
    units: dict[int, Units]


@dataclass(frozen=True)
class Level:
    """The level of an experiment against an axis; `fixed` are the groups that do not depend on it, by name."""

    experiment: str
    measure: str
    axis: Axis
    lines: list[Line]
    fixed: dict[str, Estimate]


def levels_of(source: Source) -> list[Level]:
    """A level for each experiment and each varied path that its results depend on, those with most values first."""
    groups = groups_of([cell for group in source.groups.values() for cell in group.cells])
    levels = []
    for experiment in dict.fromkeys(group.experiment for group in groups):
        members = [group for group in groups if group.experiment == experiment]
        varied = varying(group.point for group in members)
        paths = dict.fromkeys(path for group in members for path, _ in group.point)
        axes = [axis for path in paths if len((axis := _axis(path, members, varied)).values) > 1]
        for axis in sorted(axes, key=lambda axis: (axis.numbers is None, -len(axis.values))):
            levels.append(_level(source.run, experiment, axis, members, varied))
    return levels


def _axis(path: str, groups: Sequence[Group], varied: Varying) -> Axis:
    heads = {where: head for where, head in varied.heads.items() if where == path or where.startswith(f"{path}.")}
    values = list(dict.fromkeys(_value(path, group, varied) for group in groups if path in dict(group.point)))
    head = next(iter(heads.values())) if len(heads) == 1 else path.rpartition(".")[2]
    try:
        numbers = [float(value) for value in values]
    except ValueError:
        return Axis(path, head, values, None)
    in_order = sorted(range(len(values)), key=numbers.__getitem__)
    return Axis(path, head, [values[place] for place in in_order], sorted(numbers))


def _value(path: str, group: Group, varied: Varying) -> str:
    """A group's value of a path; of an entry that varies as a whole what differs: 'p_A=0.1, p_H=0'."""
    told = zip(varied.heads.items(), varied.values(group.point), strict=True)
    found = {h: value for (where, h), value in told if where == path or where.startswith(f"{path}.")}
    if len(found) <= 1:
        return next(iter(found.values()), NOTHING)
    return ", ".join(f"{head}={value}" for head, value in found.items() if value != NOTHING)


def _level(run: Path, experiment: str, axis: Axis, members: Sequence[Group], varied: Varying) -> Level:
    depending = [group for group in members if axis.path in dict(group.point)]
    alike: dict[object, list[Group]] = {}
    for group in depending:
        others = tuple((path, value) for path, value in group.point if path != axis.path)
        alike.setdefault((group.agent, group.human, others), []).append(group)
    own = Varying({path: head for path, head in varied.heads.items() if not f"{path}.".startswith(f"{axis.path}.")})
    rest = [group for group in members if group not in depending]
    names = names_within([*(groups[0] for groups in alike.values()), *rest], own)
    lines = [_line(run, name, axis, groups, varied) for name, groups in zip(names, alike.values(), strict=False)]
    fixed = {name: _reached(run, group) for name, group in zip(names[len(alike) :], rest, strict=True)}
    return Level(experiment, depending[0].measure, axis, lines, fixed)


def _line(run: Path, name: str, axis: Axis, groups: Sequence[Group], varied: Varying) -> Line:
    placed = {axis.values.index(_value(axis.path, group, varied)): group for group in groups}
    found = {place: placed[place] for place in sorted(placed)}
    values = {place: unit_values(run, group.cells) for place, group in found.items()}
    units = {place: Units(len(values[place]), len(group.cells)) for place, group in found.items()}
    return Line(name, found, {place: mean_of([*each.values()]) for place, each in values.items()}, units)


def _reached(run: Path, group: Group) -> Estimate:
    return mean_of([*unit_values(run, group.cells).values()])
