"""The place where a trial plays, as shapes: floor, rooms with their names, walls, doors, goal rooms with their flag."""

import numpy as np

from visitlab_cli.scene.colours import FLAG, FLOOR, GOAL_FLOOR, INK, OPEN, REACHED_FLOOR, SHUT, TILE, WALL
from visitlab_cli.scene.shapes import Area, Line, Polygon, Role, Shape, Style, Vectors
from visitlab_cli.scene.words import room_name
from visitlab_cli.world.lab import ALL_OPEN, SOLID, Lab, Wall, borders_of, box_of, is_box, runs, shut_doors, walls_of
from visitlab_cli.world.sight import Walls

TILE_SIDE = 4
"""Of the tiles of an open floor, in cells; in the lab each cell is one."""
WALL_WIDTH, DOOR_WIDTH = 0.24, 0.36
FLAG_FOOT = (1.8, 2.4)
"""Where a goal room's flag stands: how far west and south of the room's north-eastern corner."""
POLE = ((0.0, 0.0), (0.0, -1.9))
CLOTH = ((0.0, -1.9), (1.4, -1.4), (0.0, -0.9))
"""Points of the flag, from its foot."""


def lab_shapes(lab: Lab, open_doors: int = ALL_OPEN) -> list[Shape]:
    """The lab: its floor of cells, its rooms, each as the largest rectangle in it, its walls, the doors that are shut.

    A lab without walls has its rooms outlined, those that are rectangles; in others walls and doors part them, and a
    thin line where they pass into each other.
    """
    walled = isinstance(lab.walls, Walls)
    outline = [Style(WALL, 0.12 if is_box(lab, room) and not walled else 0.0) for room in range(lab.n_rooms)]
    rooms = [_room(lab, Role.ROOM, room, style, room_name(lab, room)) for room, style in enumerate(outline)]
    solid = [
        Area(Role.SOLID, _vector(begin, row), _vector(end - begin, 1), Style(WALL))
        for row, cells in enumerate(lab.rooms == SOLID)
        for begin, end in runs(cells)
    ]
    passed = borders_of(lab, open_doors) if walled else []
    open_borders = [_line(Role.OPEN, border, Style(OPEN, 0.06)) for border in passed]
    walls = [_line(Role.WALL, wall, Style(INK, WALL_WIDTH)) for wall in walls_of(lab)]
    shut = [_line(Role.SHUT, wall, Style(SHUT, DOOR_WIDTH)) for wall in shut_doors(lab, open_doors)]
    return [
        _floor(lab.cols, lab.rows),
        *_tiles((0, lab.cols), (0, lab.rows), 1),
        *rooms,
        *solid,
        *open_borders,
        *walls,
        *shut,
    ]


def arena_shapes(size: int, x_range: tuple[float, float], y_range: tuple[float, float]) -> list[Shape]:
    """An open floor of `size` cells a side, with tiles where it is seen."""
    return [_floor(size, size), *_tiles(_inside(x_range, size), _inside(y_range, size), TILE_SIDE)]


def goal_shapes(lab: Lab, room: int) -> list[Shape]:
    """The goal room and its flag."""
    goal = _room(lab, Role.GOAL, room, Style(GOAL_FLOOR))
    west, south = FLAG_FOOT
    foot = goal.corner + np.array([goal.size[0].item() - west, south], np.float32)
    return [
        goal,
        Polygon(Role.CLOTH, foot + np.array(CLOTH, np.float32), Style(FLAG)),
        Line(Role.POLE, foot + np.array(POLE, np.float32), Style(INK, 0.14)),
    ]


def reached_shape(lab: Lab, room: int) -> Shape:
    """The room in which a goal was just reached."""
    return _room(lab, Role.REACHED, room, Style(REACHED_FLOOR))


def _line(role: Role, wall: Wall, style: Style) -> Line:
    return Line(role, np.array([(wall.col, wall.row), (wall.end_col, wall.end_row)], np.float32), style)


def _floor(width: int, height: int) -> Area:
    return Area(Role.FLOOR, _vector(0, 0), _vector(width, height), Style(FLOOR, 0.12))


def _room(lab: Lab, role: Role, room: int, style: Style, text: str = "") -> Area:
    box = box_of(lab, room)
    return Area(role, _vector(box.col, box.row), _vector(box.cols, box.rows), style, text)


def _tiles(xs: tuple[int, int], ys: tuple[int, int], side: int) -> list[Line]:
    """Lines between the floor's tiles, between two x and two y."""
    ends = [((x, ys[0]), (x, ys[1])) for x in range(xs[0], xs[1] + 1, side)]
    ends += [((xs[0], y), (xs[1], y)) for y in range(ys[0], ys[1] + 1, side)]
    return [Line(Role.TILE, np.array(pair, np.float32), Style(TILE, 0.04)) for pair in ends]


def _inside(bounds: tuple[float, float], size: int) -> tuple[int, int]:
    low, high = int(bounds[0] // TILE_SIDE) * TILE_SIDE, int(-(-bounds[1] // TILE_SIDE)) * TILE_SIDE
    return max(low, 0), min(high, size)


def _vector(x: float, y: float) -> Vectors:
    return np.array([x, y], np.float32)
