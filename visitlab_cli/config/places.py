"""Whether labs fit in themselves, and the experiments that take place in them."""

from collections.abc import Iterator, Mapping
from typing import Any

from visitlab_cli.config.goal_rooms import ALL, numbered, wrong_rooms
from visitlab_cli.config.labs import LabSettings, layout_called, unknown_lab
from visitlab_cli.config.names import PAPER_LAB, module
from visitlab_cli.config.phases import PHASES
from visitlab_cli.world.layout import names_of
from visitlab_cli.world.tasks import NAVIGATION
from visitlab_cli.yaml.problems import Issue, Path

Labs = Mapping[str, LabSettings | None]
"""By name; None for one that is declared but wrong in itself."""


def lab_issues(labs: Labs) -> Iterator[Issue]:
    """What is wrong between the settings of a lab."""
    for name, lab in labs.items():
        if name == PAPER_LAB:
            yield Issue(("labs", name), "is the paper's lab, which is always there; choose another name", at="key")
        for key, message in lab.problems() if lab is not None else ():
            yield Issue(("labs", name, key), message)


def place_issues(path: Path, experiment: Any, experiments: Mapping[str, Any], labs: Labs) -> Iterator[Issue]:
    """What is wrong with where an experiment takes place, the rooms that it names there, the module that knows it."""
    name, sound = experiment.lab_name, _sound(labs)
    if name not in (PAPER_LAB, *labs):
        yield Issue((*path, "lab"), unknown_lab(name, labs))
    for number, phase in enumerate(experiment.phases):
        said = getattr(phase, "lab", None)
        if said and said not in (PAPER_LAB, *labs):
            yield Issue((*path, PHASES, number, "lab"), unknown_lab(said, labs))
    if name not in (PAPER_LAB, *sound):
        return
    wrong = list(wrong_rooms(experiment.goal_rooms, name, sound)) if experiment.assembled else []
    for place, message in wrong:
        yield Issue((*path, "goal_rooms", *(() if place is None else (place,))), message)
    for number, phase in enumerate(experiment.phases):
        yield from _phase((*path, PHASES, number), phase, experiment, labs, named=not wrong)
    if not experiment.assembled:
        return
    trained = experiments.get(module(experiment.modules.navigation).experiment)
    if trained is None or trained.task != NAVIGATION or trained.lab_name not in (PAPER_LAB, *sound):
        return
    if _cells(trained.lab_name, sound) != _cells(name, sound):
        where = f"{trained.lab_name}, whose cells, rooms or corridor are others than those of {name}"
        message = f"was trained in {where}; a navigation module knows the lab in which it was trained"
        yield Issue((*path, "modules", NAVIGATION), message)


def _phase(path: Path, phase: Any, experiment: Any, labs: Labs, *, named: bool) -> Iterator[Issue]:
    """What is wrong with the lab and the doors of a phase; `named`: the experiment's goal rooms are right there."""
    said, doors = getattr(phase, "lab", None), getattr(phase, "doors", None) or {}
    name, sound = said or experiment.lab_name, _sound(labs)
    if name not in (PAPER_LAB, *sound):
        return
    if _cells(name, sound) != _cells(experiment.lab_name, sound):
        message = f"has other cells, rooms or corridor than {experiment.lab_name}, the experiment's"
        yield Issue((*path, "lab"), message)
        return
    layout, no_goals, closed = layout_called(name, sound)
    unknown = [door for door in doors if name == PAPER_LAB or door not in layout.doors]
    for door in unknown:
        there = names_of(() if name == PAPER_LAB else layout.doors)
        yield Issue((*path, "doors", door), f"no door is called {door}; in {name} there are {there}", at="key")
    if unknown or not named:
        return
    left = set(layout.goals(no_goals, {*closed, *doors}))
    chosen = numbered(experiment.goal_rooms, experiment.lab_name, sound) if experiment.assembled else ALL
    left = left if chosen == ALL else left & set(chosen)
    if len(left) < 2:
        what = "while its doors are shut " if doors else ""
        message = f"{what}fewer than two goal rooms can be reached"
        yield Issue((*path, "doors" if doors else "lab"), message, at="key")


def _sound(labs: Labs) -> dict[str, LabSettings]:
    return {name: lab for name, lab in labs.items() if lab is not None and not lab.problems()}


def _cells(name: str, labs: Mapping[str, LabSettings]) -> tuple[str, str]:
    layout, no_goals, _ = layout_called(name, labs)
    return layout.text.upper(), no_goals
