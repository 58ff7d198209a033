"""The place: floor, rooms with their names, the goal room with its flag; in the social task the open floor."""

import numpy as np
import numpy.typing as npt
import rerun as rr

from visitlab_cli.replay.lettering import strokes
from visitlab_cli.replay.stage import Line, Stage
from visitlab_cli.story import FACING_FIELD, INK, VISUAL_FIELD, Colour, room_name
from visitlab_cli.world.lab import LAB_SIZE, N_ROOMS, ROOM_SIZE, ROOMS_PER_SIDE
from visitlab_cli.world.tasks import VISIT

NOTHING, GOAL_ROOM, REACHED_ROOM, SEES, FACES = range(5)
"""Classes of coloured cells."""
FLAG: Colour = (222, 140, 0)
GOAL_FLOOR: Colour = (252, 226, 154)
REACHED_FLOOR: Colour = (214, 200, 230)
WALL: Colour = (120, 120, 125)
FAINT: Colour = (222, 222, 220)
NAME: Colour = (196, 196, 194)
ORDER_FLOOR, ORDER_GOAL, ORDER_NAMES = -30.0, -25.0, -20.0
TILE = 4
NAME_PLACE, NAME_HEIGHT = np.array([2.2, 0.85]), 0.7
FLAG_PLACE = np.array([6.2, 2.3])


def draw_legend(stage: Stage) -> None:
    """The colours of the classes; pointing at a cell shows its class."""
    classes = [
        (NOTHING, "", (0, 0, 0, 0)),
        (GOAL_ROOM, "goal room", GOAL_FLOOR),
        (REACHED_ROOM, "goal room, just reached", REACHED_FLOOR),
        (SEES, "the human sees this cell", VISUAL_FIELD),
        (FACES, "the human faces this cell", FACING_FIELD),
    ]
    stage.fixed("/", rr.AnnotationContext(classes))


def draw_rooms(stage: Stage) -> None:
    """The nine rooms of the lab."""
    corners = np.arange(ROOMS_PER_SIDE + 1) * ROOM_SIZE
    lines = [_line((x, 0), (x, LAB_SIZE)) for x in corners] + [_line((0, y), (LAB_SIZE, y)) for y in corners]
    _draw_floor(stage, (0, LAB_SIZE), (0, LAB_SIZE), 1)
    stage.fixed("lab/walls", rr.LineStrips2D(lines, colors=WALL, radii=0.06, draw_order=ORDER_NAMES))
    names = [
        stroke
        for room in range(N_ROOMS)
        for stroke in strokes(room_name(room).upper(), (*(_corner(room) + NAME_PLACE),), NAME_HEIGHT)
    ]
    stage.fixed("lab/names", rr.LineStrips2D(names, colors=NAME, radii=0.06, draw_order=ORDER_NAMES))


def draw_open_floor(stage: Stage, x_range: tuple[float, float], y_range: tuple[float, float]) -> None:
    """The part of the social task's arena that is seen, as tiles, and the arena's border."""
    size = stage.trial.size
    _draw_floor(stage, _inside(x_range, size), _inside(y_range, size), TILE)
    border = [[(0, 0), (size, 0), (size, size), (0, size), (0, 0)]]
    stage.fixed("lab/walls", rr.LineStrips2D(border, colors=WALL, radii=0.06, draw_order=ORDER_NAMES))


def draw_goal(stage: Stage) -> None:
    """The goal room in its colour with its flag; at the step in which it is reached, that room in lilac."""
    goals = stage.trial.steps["goal_room"].astype(np.int64)
    classes = np.stack([_room_cells(goal) * GOAL_ROOM for goal in goals])
    if stage.trial.task == VISIT:
        for step in np.flatnonzero(stage.trial.steps["reward"][1:] > 0) + 1:
            classes[step] += _room_cells(goals[step - 1]) * REACHED_ROOM
    stage.cells("lab/goal", classes, ORDER_GOAL)
    stage.lines("lab/flag", [_flag(_corner(goal) + FLAG_PLACE) for goal in goals], ORDER_NAMES)


def _flag(foot: npt.NDArray[np.float64]) -> list[Line]:
    """A flag on its pole."""
    x, y = foot
    pole = Line(_line((x, y), (x, y - 1.9)), 0.07, INK)
    base = Line(_line((x - 0.35, y), (x + 0.35, y)), 0.07, INK)
    cloth = [
        Line(
            _line((x + 0.1, y - 1.85 + down), (x + 0.1 + 1.3 * (1 - abs(down - 0.5) / 0.55), y - 1.85 + down)),
            0.085,
            FLAG,
        )
        for down in np.linspace(0, 1, 9)
    ]
    return [*cloth, pole, base]


def _corner(room: int) -> npt.NDArray[np.float64]:
    """The north-western corner of a room as x, y."""
    return np.array([room % ROOMS_PER_SIDE, room // ROOMS_PER_SIDE], float) * ROOM_SIZE


def _room_cells(room: int) -> npt.NDArray[np.uint8]:
    """1 for the cells of a room, shape (rows, cols)."""
    cells = np.zeros((LAB_SIZE, LAB_SIZE), np.uint8)
    x, y = _corner(room).astype(int)
    cells[y : y + ROOM_SIZE, x : x + ROOM_SIZE] = 1
    return cells


def _line(start: object, end: object) -> npt.NDArray[np.float32]:
    return np.array([start, end], np.float32)


def _inside(bounds: tuple[float, float], size: int) -> tuple[int, int]:
    low, high = int(bounds[0] // TILE) * TILE, int(-(-bounds[1] // TILE)) * TILE
    return max(low, 0), min(high, size)


def _draw_floor(stage: Stage, xs: tuple[int, int], ys: tuple[int, int], tile: int) -> None:
    """Faint lines between the floor's tiles, between two x and two y; the floor itself is the view's background."""
    lines = [_line((x, ys[0]), (x, ys[1])) for x in range(xs[0], xs[1] + 1, tile)]
    lines += [_line((xs[0], y), (xs[1], y)) for y in range(ys[0], ys[1] + 1, tile)]
    stage.fixed("lab/floor", rr.LineStrips2D(lines, colors=FAINT, radii=0.02, draw_order=ORDER_FLOOR))
