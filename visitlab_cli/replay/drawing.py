"""A scene drawn with Rerun: each role of its shapes as one entity, whole columns at a time."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import rerun as rr

from visitlab_cli.replay.lettering import strokes, width_of
from visitlab_cli.replay.stage import Line, Stage
from visitlab_cli.scene.colours import FACING_FIELD, GOAL_FLOOR, INK, REACHED_FLOOR, VISUAL_FIELD, WALL, Colour
from visitlab_cli.scene.scene import TRAIL_STEPS
from visitlab_cli.scene.shapes import Area, Arrow, Body, Polygon, Role, Shape, Sight, Speech, Vectors
from visitlab_cli.scene.shapes import Line as Way
from visitlab_cli.scene.words import action_name

NOTHING, SEES, FACES, GOAL_ROOM, REACHED_ROOM, SOLID_CELL = range(6)
"""Classes of coloured cells, the first three those of `scene.sight`."""
CLASSES = [
    (NOTHING, "", (0, 0, 0, 0)),
    (SEES, "the human sees this cell", VISUAL_FIELD),
    (FACES, "the human faces this cell", FACING_FIELD),
    (GOAL_ROOM, "goal room", GOAL_FLOOR),
    (REACHED_ROOM, "goal room, just reached", REACHED_FLOOR),
]
SOLID_CLASS = (SOLID_CELL, "solid", WALL)
WHITE: Colour = (255, 255, 255)
NAME: Colour = (196, 196, 194)
PALE: dict[Role, Colour] = {Role.ROBOT_WAY: (244, 190, 150), Role.HUMAN_WAY: (150, 196, 226)}
FLOOR, GOAL, FIELD, WALLS, PATH, HUMAN, ROBOT, SAYS, SIGN = -30.0, -25.0, -22.0, -20.0, 1.0, 10.0, 20.0, 30.0, 40.0
"""Draw orders."""
NEAR_OPACITY, ELSEWHERE_OPACITY = 0.42, 0.14
LETTERS, SIGN_LETTERS, BUBBLE_LETTERS = 0.7, 1.1, 0.75
"""Heights in cells."""
NAME_MARGIN = 0.2
"""In cells: what a room's name leaves free on each side."""
Draw = Callable[[Shape], list[Line]]


def draw_scene(stage: Stage) -> None:
    """The place, and every moment of the trial in it."""
    moments = stage.scene.moments()
    solid = of_role(stage.scene.place(), Role.SOLID)
    stage.fixed("/", rr.AnnotationContext([*CLASSES, SOLID_CLASS] if solid else CLASSES))
    _draw_place(stage)
    _draw_goals(stage, moments)
    if stage.trial.has_plan:
        _draw_lines(stage, "human/wanted", moments, (Role.WANTED_HUMAN,), _strip, PATH + 2)
        _draw_lines(stage, "robot/wanted", moments, (Role.WANTED_ROBOT,), _strip, PATH + 2)
    _draw_human(stage, moments)
    _draw_robot(stage, moments)
    _draw_lines(stage, "robot/away", moments, (Role.AWAY,), _sign, SIGN)
    _draw_lines(stage, "robot/says", moments, (Role.ROBOT_SAYS,), lambda shape: _bubble(stage, shape), SAYS)
    if any(of_role(shapes, Role.HUMAN_SAYS) for shapes in moments):
        _draw_lines(stage, "human/says", moments, (Role.HUMAN_SAYS,), lambda shape: _bubble(stage, shape), SAYS)
    _draw_lines(stage, "robot/points", moments, (Role.POINTED,), _strip, SAYS)


def of_role(shapes: Sequence[Shape], *roles: Role) -> list[Shape]:
    """The shapes that stand for one of these."""
    return [shape for shape in shapes if shape.role in roles]


def _draw_place(stage: Stage) -> None:
    """Faint tiles, walls, and names; the floor itself is the view's background."""
    place = stage.scene.place()
    tiles = [line for shape in of_role(place, Role.TILE) for line in _strip(shape)]
    areas = [shape for shape in of_role(place, Role.FLOOR, Role.ROOM) if isinstance(shape, Area)]
    lines = [area.outline for area in areas if area.style.width]
    names = [stroke for area in areas if area.text for stroke in _name(area)]
    look: Any = {"colors": tiles[0].colour, "radii": tiles[0].radius, "draw_order": FLOOR}
    stage.fixed("lab/floor", rr.LineStrips2D([tile.points for tile in tiles], **look))
    stage.fixed("lab/walls", rr.LineStrips2D(lines, colors=WALL, radii=0.06, draw_order=WALLS))
    solid = of_role(place, Role.SOLID)
    if solid:
        cells = np.zeros((stage.trial.rows, stage.trial.cols), np.uint8)
        _fill(cells, solid, SOLID_CELL)
        stage.fixed("lab/solid", rr.SegmentationImage(cells, opacity=1.0, draw_order=FIELD + 1))
    parts = [line for shape in of_role(place, Role.OPEN, Role.WALL, Role.SHUT) for line in _strip(shape)]
    if parts:
        look = {"colors": [part.colour for part in parts], "radii": [part.radius for part in parts]}
        stage.fixed("lab/parts", rr.LineStrips2D([part.points for part in parts], **look, draw_order=WALLS + 1))
    if names:
        stage.fixed("lab/names", rr.LineStrips2D(names, colors=NAME, radii=0.06, draw_order=WALLS))


def _draw_goals(stage: Stage, moments: Sequence[Sequence[Shape]]) -> None:
    if not stage.trial.has_goal:
        return
    cells = np.zeros((len(moments), stage.trial.rows, stage.trial.cols), np.uint8)
    for step, shapes in enumerate(moments):
        for role, kind in ((Role.GOAL, GOAL_ROOM), (Role.REACHED, REACHED_ROOM)):
            _fill(cells[step], of_role(shapes, role), kind)
    stage.cells("lab/goal", cells, GOAL)
    _draw_lines(stage, "lab/flag", moments, (Role.CLOTH, Role.POLE), _strip, WALLS)


def _fill(cells: npt.NDArray[np.uint8], shapes: Sequence[Shape], kind: int) -> None:
    """Make the cells of areas, (rows, cols), of a class."""
    for area in shapes:
        if isinstance(area, Area):
            (x, y), (width, height) = area.corner.astype(int), area.size.astype(int)
            cells[y : y + height, x : x + width] = kind


def _draw_human(stage: Stage, moments: Sequence[Sequence[Shape]]) -> None:
    """The human from above, shoulders and head, where it has been, what it sees, where it should go."""
    if not stage.trial.has_human:
        return
    sights = [shape for shapes in moments for shape in shapes if isinstance(shape, Sight)]
    seen = np.stack([sight.cells for sight in sights])
    stage.cells("human/field/near", seen * sights[0].near, FIELD, NEAR_OPACITY)
    stage.cells("human/field/elsewhere", seen * ~sights[0].near, FIELD, ELSEWHERE_OPACITY)
    corners = np.array([[*sight.corner, 0] for sight in sights], np.float32)
    stage.columns("human/field", rr.Transform3D.columns(translation=corners))
    _draw_way(stage, "human", moments, Role.HUMAN_WAY)
    bodies = _bodies(moments, Role.HUMAN)
    for part, radius, colour, order in (
        ("outline", 0.38, INK, HUMAN),
        ("body", 0.30, bodies[0].style.colour, HUMAN + 1),
    ):
        stage.lines(f"human/{part}", [[_shoulders(body, radius, colour)] for body in bodies], order)
    _draw_headings(stage, "human", bodies, 0.4, HUMAN)
    stage.columns("human/place", rr.Points2D.columns(positions=[body.place for body in bodies]))
    stage.fixed("human/place", rr.Points2D.from_fields(radii=0.3, colors=WHITE, draw_order=HUMAN + 2))
    desired = [shape for shapes in moments for shape in of_role(shapes, Role.DESIRED) if isinstance(shape, Arrow)]
    if desired:
        _draw_arrows(stage, "human/desired", desired, HUMAN - 1)


def _draw_robot(stage: Stage, moments: Sequence[Sequence[Shape]]) -> None:
    """The robot, a square with an arrow, and where it has been."""
    _draw_way(stage, "robot", moments, Role.ROBOT_WAY)
    bodies = _bodies(moments, Role.ROBOT)
    stage.lines("robot/outline", [[_square(body, 0.52, INK)] for body in bodies], ROBOT)
    stage.lines("robot/body", [[_square(body, 0.44, body.style.colour)] for body in bodies], ROBOT + 1)
    _draw_headings(stage, "robot", bodies, 0.45, ROBOT)
    words = [action_name(stage.trial.steps, step) if step else "" for step in range(stage.trial.length)]
    stage.columns("robot/place", rr.Points2D.columns(positions=[body.place for body in bodies], labels=words))
    stage.fixed("robot/place", rr.Points2D.from_fields(radii=0.15, colors=WHITE, show_labels=False, draw_order=SAYS))


def _bodies(moments: Sequence[Sequence[Shape]], role: Role) -> list[Body]:
    return [shape for shapes in moments for shape in of_role(shapes, role) if isinstance(shape, Body)]


def _draw_way(stage: Stage, who: str, moments: Sequence[Sequence[Shape]], role: Role) -> None:
    """The whole way so far, pale, and the last steps of it in full colour."""
    ways = [shape for shapes in moments for shape in of_role(shapes, role) if isinstance(shape, Way)]
    moved = [way if len(way.points) > 1 else None for way in ways]
    path = [[Line(way.points, 0.06, PALE[role])] if way else [] for way in moved]
    trail = [
        [Line(way.points[-TRAIL_STEPS - 1 :], way.style.width / 2, way.style.colour)] if way else [] for way in moved
    ]
    stage.lines(f"{who}/path", path, PATH)
    stage.lines(f"{who}/trail", trail, PATH + 1)


def _draw_headings(stage: Stage, who: str, bodies: Sequence[Body], start: float, order: float) -> None:
    """Arrows from the edge of each body to its tip."""
    starts = [body.place + start * body.scale * body.ahead for body in bodies]
    ends = [body.tip for body in bodies]
    arrows = [Arrow(body.role, s, e, body.style) for body, s, e in zip(bodies, starts, ends, strict=True)]
    _draw_arrows(stage, f"{who}/heading", arrows, order)


def _draw_arrows(stage: Stage, entity: str, arrows: Sequence[Arrow], order: float) -> None:
    starts, ends = np.stack([arrow.start for arrow in arrows]), np.stack([arrow.end for arrow in arrows])
    stage.columns(entity, rr.Arrows2D.columns(origins=starts, vectors=ends - starts))
    style = arrows[0].style
    stage.fixed(entity, rr.Arrows2D.from_fields(colors=style.colour, radii=style.width / 2, draw_order=order))


def _draw_lines(
    stage: Stage, entity: str, moments: Sequence[Sequence[Shape]], roles: Sequence[Role], draw: Draw, order: float
) -> None:
    """The shapes of some roles as lines, at each step as many as there are."""
    steps = [[line for shape in of_role(shapes, *roles) for line in draw(shape)] for shapes in moments]
    stage.lines(entity, steps, order)


def _strip(shape: Shape) -> list[Line]:
    """A line, a shaft without a head, or a triangle filled with lines."""
    if isinstance(shape, Polygon):
        first, second, third = shape.points
        downs = np.linspace(0, 1, 17, dtype=np.float32)
        edges = [(first + down * (third - first), _along(first, second, third, float(down))) for down in downs]
        return [Line(np.stack(edge), 0.05, shape.style.colour) for edge in edges]
    if isinstance(shape, Way | Arrow):
        points = shape.points if isinstance(shape, Way) else np.stack([shape.start, shape.end])
        return [Line(points, shape.style.width / 2, shape.style.colour)]
    return []


def _along(first: Vectors, second: Vectors, third: Vectors, share: float) -> Vectors:
    """A point on the way from the first corner over the second to the third."""
    return first + 2 * share * (second - first) if share < 0.5 else second + (2 * share - 1) * (third - second)


def _square(body: Body, radius: float, colour: Colour) -> Line:
    """A rounded square that looks ahead."""
    aside, half = np.array([-body.ahead[1], body.ahead[0]], np.float32), radius * body.scale / 2
    corners = ((-1, -1), (-1, 1), (1, 1), (1, -1), (-1, -1))
    return Line(np.stack([body.place + half * (a * body.ahead + b * aside) for a, b in corners]), half, colour)


def _shoulders(body: Body, radius: float, colour: Colour) -> Line:
    aside = 0.5 * body.scale * np.array([-body.ahead[1], body.ahead[0]], np.float32)
    return Line(np.stack([body.place - aside, body.place + aside]), radius * body.scale, colour)


def _name(area: Area) -> list[Vectors]:
    """A room's name in its north-western corner."""
    text = area.name(lambda words: width_of(words, LETTERS), margin=2 * NAME_MARGIN).upper()
    width, (across, down) = width_of(text, LETTERS), area.size.tolist()
    x, y = area.corner + np.array([min(0.75, (across - width) / 2), min(0.5, (down - LETTERS) / 2)], np.float32)
    return strokes(text, (float(x) + width / 2, float(y) + LETTERS / 2), LETTERS)


def _sign(shape: Shape) -> list[Line]:
    """An arrow, and the number of its words: how far away."""
    if not isinstance(shape, Arrow):
        return []
    way = (shape.end - shape.start) / np.linalg.norm(shape.end - shape.start)
    aside = np.array([-way[1], way[0]], np.float32)
    head = np.stack([shape.end - 0.8 * way - 0.6 * aside, shape.end, shape.end - 0.8 * way + 0.6 * aside])
    x, y = map(float, shape.start - 1.6 * way)
    number = strokes("".join(filter(str.isdigit, shape.text)), (x, y), SIGN_LETTERS)
    lines = [np.stack([shape.start, shape.end]), head, *number]
    return [Line(points.astype(np.float32), shape.style.width / 2, shape.style.colour) for points in lines]


def _bubble(stage: Stage, shape: Shape) -> list[Line]:
    """A bubble above who speaks, or below, within the world."""
    if not isinstance(shape, Speech):
        return []
    place, padding, up = np.array(shape.place), 0.62, -1.0 if shape.above else 1.0
    half = width_of(shape.text, BUBBLE_LETTERS) / 2
    middle = np.array([np.clip(place[0], half + padding, stage.trial.cols - half - padding), place[1] + 2.2 * up])
    aside, towards = np.array([half, 0]), np.array([0, 0.8 * up])
    base, tail = np.stack([middle - aside, middle + aside]), np.stack([place + towards, middle])
    drawn = [Line(base, padding + 0.09, INK), Line(tail, 0.16, INK), Line(base, padding, WHITE)]
    return drawn + [Line(each, 0.085, INK) for each in strokes(shape.text, (middle[0], middle[1]), BUBBLE_LETTERS)]
