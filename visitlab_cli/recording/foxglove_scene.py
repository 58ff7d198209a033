"""The scene of a trial in Foxglove's 3D panel: rooms, goal, robot and human with heading, gesture, way so far.

x goes east, y north, in cells; the south-western corner is the origin of the frame `lab`. Robot and human have
frames of their own, whose x is where they head.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from visitlab_cli.recording.reader import Columns
from visitlab_cli.world.lab import ROOM_SIZE, ROOMS_PER_SIDE

LAB, ROBOT, HUMAN = "lab", "robot", "human"
RIGHT_ANGLE = 2  # in headings of 45 degrees
Colour = tuple[int, int, int]
Fields = dict[str, Any]

_HEIGHT = 1.0
_FIELD_RADIUS = 5.0  # cells: how far away the human can be engaged
_TRAIL_HEIGHT = 0.06
_ABOVE = 1.6


class Look(NamedTuple):
    """The colours of a scene."""

    robot: Colour
    human: Colour
    goal: Colour
    desired: Colour
    field: Colour
    ink: Colour
    floor: Colour


class ShownTrial(NamedTuple):
    """A trial and what is said of it.

    `steps` are its columns, `captions` and `bubbles` (what the robot says, maybe nothing) have one text a row,
    `room_names` one a room of the lab, or none in a world without rooms; `size` is the world's side in cells.
    """

    number: int
    steps: Columns
    captions: Sequence[str]
    bubbles: Sequence[str]
    room_names: Sequence[str]
    size: int


def lab_entities(trial: ShownTrial, look: Look) -> list[Fields]:
    """What stays as it is: the floor, and the rooms with their names."""
    size = trial.size
    floor = _box((size / 2, size / 2, -0.05), (size, size, 0.1), look.floor)
    rooms = [_room_corner(trial, room) for room in range(len(trial.room_names))]
    walls = [_line(_square(x, y, ROOM_SIZE), look.ink, loop=True) for x, y in rooms]
    names = [
        _text(name, (x + ROOM_SIZE / 2, y + ROOM_SIZE - 1, 0.1), look.ink)
        for (x, y), name in zip(rooms, trial.room_names, strict=True)
    ]
    border = _line(_square(0, 0, size), look.ink, loop=True)
    return [_entity("floor", LAB, cubes=[floor], lines=[border, *walls], texts=names)]


def scene_entities(trial: ShownTrial, row: int, look: Look) -> list[Fields]:
    """What is to be seen at a row of the trial; an entity of an earlier row is replaced by the one of its name."""
    steps = trial.steps
    bubble = [_text(trial.bubbles[row], (0, 0, _HEIGHT + _ABOVE), look.ink)] if trial.bubbles[row] else []
    entities = [
        _entity(
            ROBOT,
            ROBOT,
            cubes=[_box((0, 0, _HEIGHT / 2), (0.8, 0.8, _HEIGHT), look.robot)],
            arrows=[_arrow((0, 0, _HEIGHT), 0, 1.2, look.robot)],
            texts=bubble,
        ),
        _entity("robot's way", LAB, lines=[_line(_way(trial, ROBOT, row), look.robot)]),
    ]
    if "human_row" in steps:
        sight = [_line(_sector(RIGHT_ANGLE), look.field), _line(_sector(RIGHT_ANGLE / 2), look.human)]
        human = _box((0, 0, _HEIGHT / 2), (0.8, 0.8, _HEIGHT), look.human)
        entities += [
            _entity(HUMAN, HUMAN, cubes=[human], arrows=[_arrow((0, 0, _HEIGHT), 0, 1.2, look.human)], lines=sight),
            _entity("human's way", LAB, lines=[_line(_way(trial, HUMAN, row), look.human)]),
        ]
    if "desired_direction" in steps:
        x, y = _place(trial, HUMAN, row)
        desired = _arrow((x, y, _HEIGHT + 0.5), int(steps["desired_direction"][row]), 2.0, look.desired)
        entities.append(_entity("desired direction", LAB, arrows=[desired]))
    if "goal_room" in steps and trial.room_names:
        x, y = _room_corner(trial, int(steps["goal_room"][row]))
        goal = _box((x + ROOM_SIZE / 2, y + ROOM_SIZE / 2, 0.02), (ROOM_SIZE, ROOM_SIZE, 0.04), look.goal)
        entities.append(_entity("goal room", LAB, cubes=[goal]))
    return entities


def transforms(trial: ShownTrial, row: int) -> list[Fields]:
    """Where robot and human are, and where they head."""
    found = []
    for who in (ROBOT, HUMAN):
        if f"{who}_row" in trial.steps:
            x, y = _place(trial, who, row)
            found.append(
                {
                    "parent_frame_id": LAB,
                    "child_frame_id": who,
                    "translation": {"x": x, "y": y},
                    "rotation": _turn(int(trial.steps[f"{who}_heading"][row])),
                }
            )
    return found


def _entity(name: str, frame: str, **primitives: list[Fields]) -> Fields:
    return {"id": name, "frame_id": frame, "frame_locked": True, **primitives}


def _place(trial: ShownTrial, who: str, row: int) -> tuple[float, float]:
    """The middle of a cell as x, y."""
    steps = trial.steps
    return float(steps[f"{who}_col"][row]) + 0.5, trial.size - float(steps[f"{who}_row"][row]) - 0.5


def _way(trial: ShownTrial, who: str, row: int) -> list[tuple[float, float, float]]:
    return [(*_place(trial, who, earlier), _TRAIL_HEIGHT) for earlier in range(row + 1)]


def _room_corner(trial: ShownTrial, room: int) -> tuple[float, float]:
    """The south-western corner of a room as x, y."""
    return room % ROOMS_PER_SIDE * ROOM_SIZE, trial.size - (room // ROOMS_PER_SIDE + 1) * ROOM_SIZE


def _square(x: float, y: float, side: float) -> list[tuple[float, float, float]]:
    z = _TRAIL_HEIGHT
    return [(x, y, z), (x + side, y, z), (x + side, y + side, z), (x, y + side, z)]


def _sector(half_width: float) -> list[tuple[float, float, float]]:
    """The border of a field of sight, `half_width` headings to each side of x, as a closed strip."""
    angles = [half_width * math.pi / 4 * part / 8 for part in range(-8, 9)]
    arc = [(_FIELD_RADIUS * math.cos(angle), _FIELD_RADIUS * math.sin(angle), _TRAIL_HEIGHT) for angle in angles]
    return [(0, 0, _TRAIL_HEIGHT), *arc, (0, 0, _TRAIL_HEIGHT)]


def _turn(heading: int) -> Fields:
    """A heading, counter-clockwise from east in steps of 45 degrees, as a quaternion."""
    half = heading * math.pi / 8
    return {"z": math.sin(half), "w": math.cos(half)}


def _point(place: Sequence[float]) -> Fields:
    return dict(zip("xyz", map(float, place), strict=True))


def _pose(place: Sequence[float], heading: int = 0) -> Fields:
    return {"position": _point(place), "orientation": _turn(heading)}


def _rgb(colour: Colour, opacity: float = 1.0) -> Fields:
    red, green, blue = (part / 255 for part in colour)
    return {"r": red, "g": green, "b": blue, "a": opacity}


def _box(middle: Sequence[float], size: Sequence[float], colour: Colour) -> Fields:
    return {"pose": _pose(middle), "size": _point(size), "color": _rgb(colour)}


def _arrow(place: Sequence[float], heading: int, length: float, colour: Colour) -> Fields:
    shape = {"shaft_length": length * 0.7, "shaft_diameter": 0.2, "head_length": length * 0.3, "head_diameter": 0.5}
    return {"pose": _pose(place, heading), "color": _rgb(colour), **shape}


def _line(points: Sequence[Sequence[float]], colour: Colour, loop: bool = False) -> Fields:
    kind = "LINE_LOOP" if loop else "LINE_STRIP"
    shape = {"type": kind, "thickness": 0.1, "points": [_point(point) for point in points]}
    return {"pose": _pose((0, 0, 0)), "color": _rgb(colour), **shape}


def _text(text: str, place: Sequence[float], colour: Colour) -> Fields:
    return {"pose": _pose(place), "billboard": True, "font_size": 1.0, "color": _rgb(colour), "text": text}
