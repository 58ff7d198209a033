"""The best recorded trial of each visit, as plain values that the page plays."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from visitlab_cli.log.reader import check_values, read_trial
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import trials_of
from visitlab_cli.results.groups import Group
from visitlab_cli.results.varying import BETWEEN, Varying, varying
from visitlab_cli.scene.moments import moments
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Area, Arrow, Body, Line, Role, Shape, Sight, Speech, Vectors
from visitlab_cli.scene.sight import FACES, SEES
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import Steps, captions, shut_in
from visitlab_cli.storage.cell_folder import STEPS, read_cell
from visitlab_cli.world.enums import N_DIRECTIONS

MOST_TRIALS = 12
"""A page plays the best trials of so many visits at most, in the order of the config."""
MOST_STEPS = 1_000
"""A page plays so many steps of a trial at most."""
LETTER, NAME_MARGIN = 0.43, 0.7
"""In cells: how wide a letter of a room's name is, and what is free on both sides of it."""
COLUMNS = ("interaction_level", "distance", "goal_room", "reward")
"""What is told of a step beside what is drawn."""


def best_trials(run: Path, groups: Sequence[Group]) -> list[dict[str, Any]]:
    """The best recorded trial of each visit of a run; empty where none was recorded.

    Raises:
        RunError: a log or a table of trials is damaged.
    """
    found: list[dict[str, Any]] = []
    varied = varying(group.point for group in groups)
    for group in groups:
        if len(found) < MOST_TRIALS and group.cells[0].settings.assembled:
            found += _best_of(run, group, varied)
    return found


def _best_of(run: Path, group: Group, varied: Varying) -> list[dict[str, Any]]:
    """The earliest trial with the highest reward among the recorded ones of a group's finished cells."""
    best: tuple[float, int, Cell] | None = None
    for cell in group.cells:
        one_in = cell.config.record.one_trial_in
        if not one_in or read_cell(run / cell.path) is None:
            continue
        rewards = trials_of(run, cell)["reward"][::one_in]
        place = int(np.argmax(rewards))
        if best is None or rewards[place] > best[0]:
            best = float(rewards[place]), place * one_in, cell
    if best is None:
        return []
    reward, number, cell = best
    name = BETWEEN.join((f"{group.experiment}/{group.human}", *varied.words(group.point)))
    return [_plain(run, name, cell, number, reward)]


def _plain(run: Path, name: str, cell: Cell, number: int, reward: float) -> dict[str, Any]:
    log = run / cell.path / STEPS
    whole = read_trial(log, number)
    phases = cell.settings.phases
    lab = cell.settings.lab_in(phases[int(whole["phase"][0])] if phases else None)
    check_values(log, whole, cell.task, lab)
    steps: Steps = {column: values[: MOST_STEPS + 1] for column, values in whole.items()}
    trial = Trial(log, cell.path, cell.task, number, steps, lab, tuple(cell.config.interaction.distances))
    return {
        "group": name,
        "cell": cell.path,
        "trial": number,
        "goals": reward,
        "steps": len(whole["step"]) - 1,
        "columns": {column: steps[column].astype(int).tolist() for column in COLUMNS},
        "place": plain_place(trial),
        "scene": plain_scene(trial),
        "captions": captions(steps, lab),
        "moments": [list(moment) for moment in moments(steps, lab)],
    }


def plain_place(trial: Trial) -> dict[str, Any]:
    """What stays as it is in a trial: rooms and solid cells as x, y, width, height; lines; which doors are shut.

    Rooms with their name, whether they are outlined, and what of the name is written.
    """
    shapes = Scene(trial).place()
    areas = [shape for shape in shapes if isinstance(shape, Area)]
    boxes = {role: [each for each in areas if each.role == role] for role in (Role.FLOOR, Role.ROOM, Role.SOLID)}
    (floor,) = boxes[Role.FLOOR]
    lines = [shape for shape in shapes if isinstance(shape, Line)]
    return {
        "size": floor.size.tolist(),
        "rooms": [
            [*_numbers(each), each.text, bool(each.style.width), each.name(_width_of, NAME_MARGIN)]
            for each in boxes[Role.ROOM]
        ],
        "solid": [_numbers(each) for each in boxes[Role.SOLID]],
        "closed": shut_in(trial.steps, trial.lab),
        **{
            name: [line.points.tolist() for line in lines if line.role == role]
            for name, role in (("tiles", Role.TILE), ("open", Role.OPEN), ("walls", Role.WALL), ("shut", Role.SHUT))
        },
    }


def plain_scene(trial: Trial) -> dict[str, Any]:
    """The shapes of a visit by their role, one a step; what each says by its step.

    Bodies as x, y, heading, scale; sight as x, y, heading, radius; the desired direction as x, y, heading, length;
    rooms as x, y, width, height, None where none was just reached. Where there are walls `cells` has for each step
    which of `seen` it is: rows of cells as x, y, number, those that are seen and those that are faced.
    """
    told: dict[str, Any] = {str(role): [] for role in (Role.ROBOT, Role.HUMAN, Role.SIGHT, Role.DESIRED, Role.GOAL)}
    told |= {str(Role.REACHED): [], str(Role.ROBOT_SAYS): {}, str(Role.HUMAN_SAYS): {}}
    seen: dict[str, int] = {}
    for step, shapes in enumerate(Scene(trial).moments()):
        for shape in shapes:
            if isinstance(shape, Sight) and shape.walled:
                cells = json.dumps([shape.rows_of_cells(SEES), shape.rows_of_cells(FACES)])
                told.setdefault("cells", []).append(seen.setdefault(cells, len(seen)))
            if isinstance(shape, Speech):
                told[shape.role][str(step)] = shape.text
            elif shape.role in told:
                told[shape.role].append(_numbers(shape))
        told[Role.REACHED] += [None] * (step + 1 - len(told[Role.REACHED]))
    return told | ({"seen": list(map(json.loads, seen))} if seen else {})


def _width_of(words: str) -> float:
    return LETTER * len(words)


def _numbers(shape: Shape) -> list[float]:
    match shape:
        case Body(place=place, heading=heading, scale=size) | Sight(place=place, heading=heading, radius=size):
            return [*_rounded(place), heading, size]
        case Arrow(start=start, end=end):
            east, south = (end - start).tolist()
            heading = round(math.atan2(-south, east) * N_DIRECTIONS / math.tau) % N_DIRECTIONS
            return [*_rounded(start), heading, round(math.hypot(east, south), 3)]
        case Area(corner=corner, size=size):
            return [*_rounded(corner), *_rounded(size)]
    raise AssertionError(f"{shape.role} is not drawn")


def _rounded(place: Vectors) -> list[float]:
    return [round(part, 3) for part in place.tolist()]
