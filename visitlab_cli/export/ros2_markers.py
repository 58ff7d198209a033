"""The shapes of a scene as markers that RViz draws."""

from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import Any

import numpy as np

from visitlab_cli.export.ros2_messages import Messages
from visitlab_cli.scene.colours import FACING_FIELD, INK, VISUAL_FIELD, Colour, shares
from visitlab_cli.scene.shapes import Area, Arrow, Body, Line, Polygon, Role, Shape, Sight, Speech
from visitlab_cli.scene.sight import FACES, SEES

_DELETE_ALL = 3
_ARROW, _CUBE, _CYLINDER, _LINES, _CUBES, _TEXT, _TRIANGLES = 0, 1, 3, 4, 6, 9, 11
"""Types of a marker, as `visualization_msgs/Marker` numbers them."""
_HEIGHT, _WIDTH, _LETTERS, _ABOVE = 1.0, 0.8, 0.8, 1.6
"""Of bodies and texts, in cells."""
_THIN = 0.06
_LEVELS = {Role.FLOOR: -0.2, Role.TILE: -0.08, Role.REACHED: -0.12, Role.GOAL: -0.16, Role.SIGHT: -0.02}
"""How far below the robot's feet what lies on the floor is, in cells: none hides in another."""
_SIGHT_OPACITY = 0.35


def marker_array(messages: Messages, shapes: Iterable[Shape]) -> Any:
    """What is to be seen at the messages' time; it takes the place of what was there before on its topic."""
    cleared = _marker(messages, "", _CUBE, action=_DELETE_ALL)
    drawn = [marker for shape in shapes for marker in _MARKERS[type(shape)](messages, shape)]
    for number, marker in enumerate(drawn):
        marker.id = number
    return messages.make("visualization_msgs/MarkerArray", [cleared, *drawn])


def _area(messages: Messages, area: Area) -> list[Any]:
    width, depth = map(float, area.size)
    made = []
    if area.role == Role.ROOM and area.style.width:
        outline = [messages.point(x, y, _THIN) for x, y in area.outline]
        made.append(_marker(messages, area.role, _LINES, area.style.colour, (_THIN, 0, 0), points=outline))
    elif area.role != Role.ROOM:
        x, y = area.corner + area.size / 2
        place = messages.pose(messages.point(x, y, _LEVELS.get(Role(area.role), 0)))
        made.append(_marker(messages, area.role, _CUBE, area.style.colour, (width, depth, _THIN), pose=place))
    if area.text:
        x, y = area.corner[0] + width / 2, area.corner[1] + 1
        name = area.name(lambda words: 0.6 * _LETTERS * len(words), margin=0.4)
        made.append(_text(messages, f"{area.role} name", name, (x, y, _THIN)))
    return made


def _line(messages: Messages, line: Line) -> list[Any]:
    if len(line.points) < 2:
        return []  # a way that has just begun
    points = [messages.point(x, y, _LEVELS.get(Role(line.role), _THIN)) for x, y in line.points]
    return [_marker(messages, line.role, _LINES, line.style.colour, (line.style.width, 0, 0), points=points)]


def _polygon(messages: Messages, polygon: Polygon) -> list[Any]:
    corners = [messages.point(x, y, _THIN) for x, y in polygon.points]
    fan = [corner for pair in pairwise(corners[1:]) for corner in (corners[0], *pair)]
    return [_marker(messages, polygon.role, _TRIANGLES, polygon.style.colour, (1, 1, 1), points=fan)]


def _arrow(messages: Messages, arrow: Arrow) -> list[Any]:
    ends = [messages.point(x, y, _HEIGHT) for x, y in (arrow.start, arrow.end)]
    return [_marker(messages, arrow.role, _ARROW, arrow.style.colour, (0.2, 0.5, 0.6), points=ends)]


def _body(messages: Messages, body: Body) -> list[Any]:
    (x, y), wide = body.place, _WIDTH * body.scale
    shape = _CUBE if body.role == Role.ROBOT else _CYLINDER
    place = messages.pose(messages.point(x, y, _HEIGHT / 2), body.heading)
    ends = [messages.point(east, south, _HEIGHT) for east, south in (body.place, body.tip)]
    return [
        _marker(messages, body.role, shape, body.style.colour, (wide, wide, _HEIGHT), pose=place),
        _marker(messages, f"{body.role} heading", _ARROW, body.style.colour, (0.15, 0.4, 0.5), points=ends),
    ]


def _sight(messages: Messages, sight: Sight) -> list[Any]:
    """The cells that the human sees at a distance to interact."""
    made = []
    for what, colour in ((SEES, VISUAL_FIELD), (FACES, FACING_FIELD)):
        rows, cols = np.nonzero((sight.cells == what) & sight.near)
        left, top = sight.corner + 0.5
        points = [
            messages.point(left + col, top + row, _LEVELS[Role.SIGHT]) for row, col in zip(rows, cols, strict=True)
        ]
        if points:
            made.append(
                _marker(messages, sight.role, _CUBES, colour, (1, 1, _THIN), points=points, opacity=_SIGHT_OPACITY)
            )
    return made


def _speech(messages: Messages, speech: Speech) -> list[Any]:
    return [_text(messages, speech.role, speech.text, (*speech.place, _HEIGHT + _ABOVE))]


def _text(messages: Messages, name: str, text: str, place: tuple[float, float, float]) -> Any:
    pose = messages.pose(messages.point(*place))
    return _marker(messages, name, _TEXT, INK, (0, 0, _LETTERS), pose=pose, text=text)


_MARKERS: dict[type[Shape], Callable[[Messages, Any], list[Any]]] = {
    Area: _area,
    Line: _line,
    Polygon: _polygon,
    Arrow: _arrow,
    Body: _body,
    Sight: _sight,
    Speech: _speech,
}


def _marker(
    messages: Messages,
    name: str,
    kind: int,
    colour: Colour = INK,
    scale: tuple[float, float, float] = (1, 1, 1),
    *,
    action: int = 0,
    pose: Any = None,
    points: Iterable[Any] = (),
    text: str = "",
    opacity: float = 1.0,
) -> Any:
    """A marker with all that its type has; `scale` is in cells, a `pose` left out the origin of the frame."""
    make = messages.make
    nothing = np.zeros(0, np.uint8)
    still = make("builtin_interfaces/Time", 0, 0)
    return make(
        "visualization_msgs/Marker",
        header=messages.header(),
        ns=str(name),
        id=0,
        type=kind,
        action=action,
        pose=pose or messages.pose(make("geometry_msgs/Point", 0.0, 0.0, 0.0)),
        scale=make("geometry_msgs/Vector3", *(float(size) * messages.cell_size for size in scale)),
        color=make("std_msgs/ColorRGBA", *shares(colour), opacity),
        lifetime=make("builtin_interfaces/Duration", 0, 0),
        frame_locked=False,
        points=list(points),
        colors=[],
        texture_resource="",
        texture=make("sensor_msgs/CompressedImage", make("std_msgs/Header", still, ""), "", nothing),
        uv_coordinates=[],
        text=text,
        mesh_resource="",
        mesh_file=make("visualization_msgs/MeshFile", "", nothing),
        mesh_use_embedded_materials=False,
    )
