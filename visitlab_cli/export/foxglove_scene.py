"""A scene drawn for Foxglove's 3D panel: the shapes as its primitives, y turned northwards, robot and human as frames.

x goes east, y north, in cells; the south-western corner is the origin of the frame `lab`. Robot and human have
frames of their own, whose x is where they head.
"""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from visitlab_cli.scene.colours import FACING_FIELD, INK, VISUAL_FIELD, Colour, shares
from visitlab_cli.scene.scene import BODIES, SAYS, WANTED, Scene
from visitlab_cli.scene.shapes import Area, Arrow, Body, Line, Role, Shape, Sight, Speech, Style, Vectors
from visitlab_cli.scene.sight import FACES, FACES_DEGREES, SEES, SEES_DEGREES
from visitlab_cli.world.enums import N_DIRECTIONS

LAB = "lab"
Fields = dict[str, Any]
Place = Sequence[float]

_HEIGHT, _WIDTH = 1.0, 0.8
"""Of a body, in cells."""
_ON_FLOOR, _UNDER_LINES, _ABOVE_HEADS = 0.06, 0.02, 0.5
_SIGHT_OPACITY = 0.35
_ENTITIES = {
    Role.GOAL: "goal room",
    Role.ROBOT_WAY: "robot's way",
    Role.HUMAN_WAY: "human's way",
    Role.DESIRED: "desired direction",
    Role.WANTED_HUMAN: "where the plan wants the human",
    Role.WANTED_ROBOT: "where the plan wants the robot",
}
_SEEN = "what the human sees"
"""The names of entities in the frame `lab`."""


def lab_entities(scene: Scene) -> list[Fields]:
    """What stays as it is: the floor, the rooms with their names, walls, and doors that are shut."""
    place = scene.place()
    areas = [shape for shape in place if isinstance(shape, Area)]
    floors = [_slab(scene, area, -0.05, 0.1) for area in areas if area.role == Role.FLOOR]
    floors += [_slab(scene, area, _HEIGHT / 2, _HEIGHT) for area in areas if area.role == Role.SOLID]
    outlined = [area for area in areas if area.style.width]
    walls = [_line(_raised(_northwards(scene, area.outline[:4])), INK, loop=True) for area in outlined]
    barred = [shape for shape in place if isinstance(shape, Line) and shape.role in (Role.WALL, Role.SHUT)]
    floors += [_wall(scene, wall) for wall in barred]
    named = [(area.name(_width_of, margin=0.4), area) for area in areas if area.text]
    names = [_text(name, (*_at_northern_edge(scene, area), 0.1), INK) for name, area in named]
    return [_entity("floor", LAB, cubes=floors, lines=walls, texts=names)]


def scene_entities(scene: Scene, step: int) -> list[Fields]:
    """What is to be seen at a step; an entity of an earlier one is replaced by the one of its name."""
    shapes = scene.moment(step)
    sights = [shape for shape in shapes if isinstance(shape, Sight)]
    entities = []
    for shape in shapes:
        if isinstance(shape, Body):
            said = [each.text for each in shapes if isinstance(each, Speech) and each.role == SAYS[str(shape.role)]]
            sectors = [sight for sight in sights if not sight.walled and shape.role == Role.HUMAN]
            entities.append(_body(scene, step, shape, said, sectors))
        elif isinstance(shape, Sight):
            entities += [_entity(_SEEN, LAB, cubes=_cells(scene, shape))] if shape.walled else []
        elif shape.role in _ENTITIES:
            entities.append(_entity(_ENTITIES[shape.role], LAB, **_PRIMITIVES[type(shape)](scene, shape)))
    if scene.trial.has_plan:  # what is not wanted any more is replaced by nothing
        unwanted = {*WANTED.values()} - {shape.role for shape in shapes}
        entities += [_entity(_ENTITIES[role], LAB) for role in sorted(unwanted)]
    return entities


def transforms(scene: Scene, step: int) -> list[Fields]:
    """Where robot and human are, and where they head."""
    return [
        {
            "parent_frame_id": LAB,
            "child_frame_id": who,
            "translation": dict(zip("xy", _place(scene, who, step), strict=True)),
            "rotation": _turn(int(scene.trial.steps[f"{who}_heading"][step])),
        }
        for who in BODIES
        if f"{who}_row" in scene.trial.steps
    ]


def _body(scene: Scene, step: int, body: Body, said: Sequence[str], sights: Sequence[Sight]) -> Fields:
    """Robot or human in its own frame: beside its origin where the two share a cell."""
    (x, y), (own_x, own_y) = _northwards(scene, body.place[None])[0], _place(scene, str(body.role), step)
    angle = body.heading * math.tau / N_DIRECTIONS
    east, north = x - own_x, y - own_y
    ahead, left = (
        east * math.cos(angle) + north * math.sin(angle),
        north * math.cos(angle) - east * math.sin(angle),
    )
    width, colour = _WIDTH * body.scale, body.style.colour
    return _entity(
        str(body.role),
        str(body.role),
        cubes=[_box((ahead, left, _HEIGHT / 2), (width, width, _HEIGHT), colour)],
        arrows=[_arrow((ahead, left, _HEIGHT), 0, math.dist(body.tip, body.place), colour)],
        lines=[line for sight in sights for line in _sight(sight)],
        texts=[_text(text, (ahead, left, _HEIGHT + 1.6), INK) for text in said],
    )


def _area(scene: Scene, area: Area) -> Fields:
    return {"cubes": [_slab(scene, area, _UNDER_LINES, 2 * _UNDER_LINES)]}


def _way(scene: Scene, way: Line) -> Fields:
    return {"lines": [_line(_raised(_northwards(scene, way.points)), way.style.colour)]}


def _desired(scene: Scene, arrow: Arrow) -> Fields:
    (x, y), (to_x, to_y) = _northwards(scene, arrow.start[None])[0], _northwards(scene, arrow.end[None])[0]
    heading = math.atan2(to_y - y, to_x - x) * N_DIRECTIONS / math.tau
    place = (x, y, _HEIGHT + _ABOVE_HEADS)
    return {"arrows": [_arrow(place, heading, math.dist((x, y), (to_x, to_y)), arrow.style.colour)]}


_PRIMITIVES: dict[type[Shape], Callable[..., Fields]] = {Area: _area, Line: _way, Arrow: _desired}


def _sight(sight: Sight) -> list[Fields]:
    """The borders of both fields, as far as the two can interact."""
    fields = ((SEES_DEGREES, VISUAL_FIELD), (FACES_DEGREES, FACING_FIELD))
    return [_line(_sector(sight.radius, math.radians(degrees)), colour) for degrees, colour in fields]


def _cells(scene: Scene, sight: Sight) -> list[Fields]:
    """The cells that walls leave of both fields, as far as the two can interact."""
    fields = ((SEES, VISUAL_FIELD), (FACES, FACING_FIELD))
    return [
        _slab(scene, Area(sight.role, np.array((x, y)), np.array((n, 1)), Style(colour)), _UNDER_LINES, _ON_FLOOR)
        | {"color": _rgb(colour) | {"a": _SIGHT_OPACITY}}
        for kind, colour in fields
        for x, y, n in sight.rows_of_cells(kind)
    ]


def _sector(radius: float, half_width: float) -> list[Place]:
    """The border of a field of sight, `half_width` to each side of x, as a closed strip."""
    angles = [half_width * part / 8 for part in range(-8, 9)]
    arc = [(radius * math.cos(angle), radius * math.sin(angle), _ON_FLOOR) for angle in angles]
    return [(0, 0, _ON_FLOOR), *arc, (0, 0, _ON_FLOOR)]


def _entity(name: str, frame: str, **primitives: list[Fields]) -> Fields:
    return {"id": name, "frame_id": frame, "frame_locked": True, **primitives}


def _place(scene: Scene, who: str, step: int) -> tuple[float, float]:
    """The middle of a cell as x, y."""
    steps = scene.trial.steps
    return float(steps[f"{who}_col"][step]) + 0.5, scene.trial.rows - float(steps[f"{who}_row"][step]) - 0.5


def _northwards(scene: Scene, points: Vectors) -> list[tuple[float, float]]:
    """Points of a scene, whose y goes southwards."""
    return [(float(x), scene.trial.rows - float(y)) for x, y in points]


def _raised(points: Sequence[tuple[float, float]]) -> list[Place]:
    """On the floor, where lines can be seen."""
    return [(x, y, _ON_FLOOR) for x, y in points]


def _at_northern_edge(scene: Scene, area: Area) -> tuple[float, float]:
    (x, y), (width, _) = area.corner, area.size
    return float(x + width / 2), scene.trial.rows - float(y) - 1


def _slab(scene: Scene, area: Area, height: float, thickness: float) -> Fields:
    ((x, y),) = _northwards(scene, (area.corner + area.size / 2)[None])
    width, depth = map(float, area.size)
    return _box((x, y, height), (width, depth, thickness), area.style.colour)


def _wall(scene: Scene, wall: Line) -> Fields:
    """As high as a body."""
    (x, y), (to_x, to_y) = _northwards(scene, wall.points)
    size = (abs(to_x - x) + wall.style.width, abs(to_y - y) + wall.style.width, _HEIGHT)
    return _box(((x + to_x) / 2, (y + to_y) / 2, _HEIGHT / 2), size, wall.style.colour)


def _width_of(words: str) -> float:
    return 0.6 * len(words)


def _turn(heading: float) -> Fields:
    """A heading, counter-clockwise from east in steps of 45 degrees, as a quaternion."""
    half = heading * math.pi / 8
    return {"z": math.sin(half), "w": math.cos(half)}


def _point(place: Place) -> Fields:
    return dict(zip("xyz", map(float, place), strict=True))


def _pose(place: Place, heading: float = 0) -> Fields:
    return {"position": _point(place), "orientation": _turn(heading)}


def _rgb(colour: Colour) -> Fields:
    return {**dict(zip("rgb", shares(colour), strict=True)), "a": 1.0}


def _box(middle: Place, size: Place, colour: Colour) -> Fields:
    return {"pose": _pose(middle), "size": _point(size), "color": _rgb(colour)}


def _arrow(place: Place, heading: float, length: float, colour: Colour) -> Fields:
    shape = {"shaft_length": length * 0.7, "shaft_diameter": 0.2, "head_length": length * 0.3, "head_diameter": 0.5}
    return {"pose": _pose(place, heading), "color": _rgb(colour), **shape}


def _line(points: Sequence[Place], colour: Colour, loop: bool = False) -> Fields:
    kind = "LINE_LOOP" if loop else "LINE_STRIP"
    shape = {"type": kind, "thickness": 0.1, "points": [_point(point) for point in points]}
    return {"pose": _pose((0, 0, 0)), "color": _rgb(colour), **shape}


def _text(text: str, place: Place, colour: Colour) -> Fields:
    return {"pose": _pose(place), "billboard": True, "font_size": 1.0, "color": _rgb(colour), "text": text}
