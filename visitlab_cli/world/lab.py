"""The lab: a grid of cells, its rooms, walls and doors, and how a move ends (TASK.md, 'Grid, headings, movement').

Cells are (row, column), row 0 in the north, column 0 in the west. `reach` says how many unit steps may be taken one
after the other; that one table holds the borders, the walls and the rule for diagonals. A door that is shut puts
walls back: `doors` says which doors a unit step needs open, one bit a door, and a scene says which ones are.
"""

import weakref
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache, lru_cache
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import Operation, kernel
from visitlab_cli.random_numbers import RandomState, happens, random_below
from visitlab_cli.world.enums import N_DIRECTIONS, Direction
from visitlab_cli.world.sight import Doors, NoDoors, NoWalls, Walls, in_sight, sight_of
from visitlab_cli.world.walls import COL_STEPS as COL_STEPS
from visitlab_cli.world.walls import ROW_STEPS as ROW_STEPS
from visitlab_cli.world.walls import Cell, Pair, crossing, inside, reach_of

Ints = npt.NDArray[np.int64]

ALL_OPEN = -1
"""The doors of a scene in which none is shut: every bit set."""
MOST_DOORS = 64
SOLID = -1
"""The room of a cell that is none: nobody is ever in it."""


class Lab(NamedTuple):
    """A lab as kernels see it; arrays over cells have the shape (rows, cols), over unit steps (rows, cols, 8).

    A lab is the same as itself only, so that what is computed of it can be kept.
    """

    rows: int
    cols: int
    n_rooms: int
    rooms: npt.NDArray[np.int64]  # the room of a cell, 0..n_rooms-1, or SOLID
    reach: npt.NDArray[np.int64]  # unit steps from a cell, at most 3, that stay inside and cross no wall
    doors: NoDoors | Doors
    walls: NoWalls | Walls

    def __eq__(self, other: object) -> bool:
        return self is other

    def __ne__(self, other: object) -> bool:
        return self is not other

    def __hash__(self) -> int:
        return id(self)


class _About(NamedTuple):
    """What kernels need not know of a lab: its rooms' names, which may be goals, and its doors' names.

    `doors` are those that a scene may shut, `closed` those that are shut for good: what these part, (rows, cols, 8).
    """

    names: tuple[str, ...]
    goals: tuple[int, ...]
    doors: tuple[str, ...]
    closed: Mapping[str, npt.NDArray[np.bool_]]


_about: dict[int, _About] = {}
"""Of every lab that is in use, by the address of its `rooms`."""


def room_names(lab: Lab) -> tuple[str, ...]:
    """What the rooms are called, by their numbers: letters, or the numbers themselves."""
    return _about[id(lab.rooms)].names


def goals_of(lab: Lab) -> tuple[int, ...]:
    """The rooms that may be goals, ascending."""
    return _about[id(lab.rooms)].goals


def starts_of(lab: Lab) -> npt.NDArray[np.int64]:
    """The cells, row * cols + col, in which a trial may begin, ascending."""
    return lab.walls.starts if isinstance(lab.walls, Walls) else np.arange(lab.rows * lab.cols)


class Box(NamedTuple):
    """A rectangle of cells, from its north-western one on."""

    row: int
    col: int
    rows: int
    cols: int


def make_lab(
    rows: int,
    cols: int,
    walls: Iterable[Pair] = (),
    doors: Sequence[Iterable[Pair]] = (),
    rooms: npt.ArrayLike | None = None,
    *,
    chances: Sequence[float] | None = None,
    shut: Collection[int] = (),
    starts: npt.ArrayLike | None = None,
    goals: Sequence[int] | None = None,
    letters: str = "",
    named: Sequence[str] = (),
    closed: Mapping[str, Iterable[Pair]] = MappingProxyType({}),
) -> Lab:
    """A lab of `rows` x `cols` cells with a wall between each pair of straight neighbours in `walls`.

    Args:
        rows: cells from north to south, at least 1.
        cols: cells from west to east, at least 1.
        walls: which pairs of cells have one between them.
        doors: of each door that a scene may shut, at most 64, the pairs of cells that it parts then.
        rooms: the room of each cell, shape (rows, cols), from 0, `SOLID` where there is none; one room if not given.
        chances: how likely each of `doors` is opened or shut before a trial; never if not given.
        shut: which of `doors`, by their place, are shut at first.
        starts: in which cells a trial may begin, shape (rows, cols); in all that are not solid if not given.
        goals: the rooms that may be goals, all if not given.
        letters: the name of each room, a letter; "" where they have numbers only.
        named: the names of `doors`; their places if not given.
        closed: by their names the doors that are shut for good, which are walls to all but those who draw or tell.

    Raises:
        ValueError: a wall does not lie between two neighbouring cells, or there are too many doors.
    """
    if len(doors) > MOST_DOORS:
        raise ValueError(f"at most {MOST_DOORS} doors can be shut, not {len(doors)}")
    plan = np.zeros((rows, cols), np.int64) if rooms is None else np.array(rooms, np.int64).reshape(rows, cols)
    n_rooms = int(plan.max()) + 1
    kept_shut = {name: crossing(rows, cols, pairs) for name, pairs in closed.items()}
    barred = np.logical_or.reduce([crossing(rows, cols, walls), *kept_shut.values()])
    passable = inside(rows, cols) & ~barred
    needed = np.zeros((rows, cols, N_DIRECTIONS), np.int64)
    for number, leaves in enumerate(doors):
        needed |= np.where(crossing(rows, cols, leaves), np.uint64(1 << number), np.uint64(0)).view(np.int64)
    begin = (plan != SOLID) if starts is None else np.asarray(starts, np.bool_)
    is_open = not (len(doors) or barred.any()) and bool(begin.all())
    sight, masks = (np.zeros((0, 0), np.uint8), np.zeros(0, np.int64)) if is_open else sight_of(passable, needed)
    lab = Lab(
        rows,
        cols,
        n_rooms,
        plan,
        reach_of(passable),
        _doors(needed, masks, chances or [0.0] * len(doors), shut) if len(doors) else NoDoors(),
        NoWalls() if is_open else Walls(sight, np.flatnonzero(begin)),
    )
    names = tuple(letters) or tuple(map(str, range(n_rooms)))
    may_be_shut = tuple(named) or tuple(map(str, range(len(doors))))
    about = _About(names, tuple(range(n_rooms)) if goals is None else tuple(goals), may_be_shut, kept_shut)
    _about[id(plan)] = about
    weakref.finalize(plan, _about.pop, id(plan)).atexit = False
    return lab


def _doors(needed: Ints, masks: Ints, chances: Sequence[float], shut: Collection[int]) -> Doors:
    begin = np.uint64((1 << len(chances)) - 1 - sum(1 << door for door in shut)).astype(np.int64)  # bits, no number
    return Doors(len(chances), needed, masks, np.array(chances), int(begin))


@cache
def box_of(lab: Lab, room: int) -> Box:
    """The largest rectangle of a room's cells, of equals the northernmost: all of them where the room is one."""
    inside = lab.rooms == room
    best = Box(0, 0, 0, 0)
    for row in np.flatnonzero(inside.any(axis=1)).tolist():
        free = inside[row].copy()
        for below in range(row, lab.rows):
            free &= inside[below]
            ends = np.flatnonzero(np.diff(np.pad(free.astype(np.int8), 1)))
            if not len(ends):
                break
            begin, end = max(zip(ends[::2].tolist(), ends[1::2].tolist(), strict=True), key=lambda run: run[1] - run[0])
            box = Box(row, begin, below + 1 - row, end - begin)
            best = max(best, box, key=lambda each: each.rows * each.cols)
    return best


def is_box(lab: Lab, room: int) -> bool:
    """Whether a room is a rectangle of cells."""
    box = box_of(lab, room)
    return box.rows * box.cols == int((lab.rooms == room).sum())


class Wall(NamedTuple):
    """A straight line between two corners of cells, as rows and columns from the north-western corner of the lab."""

    row: int
    col: int
    end_row: int
    end_col: int


def walls_of(lab: Lab) -> list[Wall]:
    """What parts cells for good and is no door, as lines as long as straight; the lab's outer border is left out."""
    parted = (lab.reach == 0) & ~shut_steps(lab, ALL_OPEN)
    solid = lab.rooms == SOLID
    east = parted[:, :-1, Direction.EAST] & ~(solid[:, :-1] & solid[:, 1:])
    south = parted[:-1, :, Direction.SOUTH] & ~(solid[:-1] & solid[1:])
    return _lines(east, south)


def shut_doors(lab: Lab, open_doors: int) -> list[Wall]:
    """The doors that are shut while only `open_doors` are open, and those shut for good, as lines."""
    shut = shut_steps(lab, open_doors)
    return _lines(shut[:, :-1, Direction.EAST], shut[:-1, :, Direction.SOUTH])


def borders_of(lab: Lab, open_doors: int) -> list[Wall]:
    """Where rooms pass into each other while `open_doors` are open, as lines."""
    free = (lab.reach > 0) & ~shut_steps(lab, open_doors)
    east = free[:, :-1, Direction.EAST] & (lab.rooms[:, :-1] != lab.rooms[:, 1:])
    south = free[:-1, :, Direction.SOUTH] & (lab.rooms[:-1] != lab.rooms[1:])
    return _lines(east, south)


def shut_steps(lab: Lab, open_doors: int) -> npt.NDArray[np.bool_]:
    """Whether a unit step crosses one of these doors: shape (rows, cols, 8)."""
    shut = np.zeros(lab.reach.shape, np.bool_)
    for crossed in _about[id(lab.rooms)].closed.values():
        shut |= crossed
    if isinstance(lab.doors, Doors):
        shut |= (lab.doors.needed & ~np.int64(open_doors)) != 0
    return shut


def names_of_shut(lab: Lab, open_doors: int) -> list[str]:
    """The names of these doors, in order."""
    about = _about[id(lab.rooms)]
    return sorted([*about.closed, *(name for door, name in enumerate(about.doors) if not open_doors >> door & 1)])


def _lines(east: npt.NDArray[np.bool_], south: npt.NDArray[np.bool_]) -> list[Wall]:
    """Lines where something is east of a cell, shape (rows, cols - 1), or south of it, shape (rows - 1, cols)."""
    found = []
    for col, down in enumerate(east.T, 1):
        found += [Wall(begin, col, end, col) for begin, end in runs(down)]
    for row, along in enumerate(south, 1):
        found += [Wall(row, begin, row, end) for begin, end in runs(along)]
    return found


def runs(flags: npt.NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Where runs of True begin and end."""
    ends = np.flatnonzero(np.diff(np.pad(flags.astype(np.int8), 1))).tolist()
    return list(zip(ends[::2], ends[1::2], strict=True))


@cache
def paper_lab() -> Lab:
    """The paper's: 3 x 3 rooms of 8 x 8 cells, numbered row by row from the north-west, without walls."""
    rows = np.arange(24) // 8
    return make_lab(24, 24, rooms=rows[:, None] * 3 + rows[None, :])


@lru_cache(maxsize=4)
def arena_of(cells: int) -> Lab:
    """A square of `cells` x `cells` cells, all one room, without walls."""
    return make_lab(cells, cells)


def _random_cell(walls, rows, cols, random):  # type: ignore[no-untyped-def]
    """A cell in which a trial may begin, uniform."""


RANDOM_CELL = Operation(_random_cell)
random_cell_of = RANDOM_CELL.function


@RANDOM_CELL.of(NoWalls)
def _any_cell(walls: NoWalls, rows: int, cols: int, random: RandomState) -> Cell:
    return random_below(random, rows), random_below(random, cols)


@RANDOM_CELL.of(Walls)
def _cell_within_reach(walls: Walls, rows: int, cols: int, random: RandomState) -> Cell:
    cell = walls.starts[random_below(random, len(walls.starts))]
    return cell // cols, cell % cols


@kernel
def random_cell(lab: Lab, random: RandomState) -> Cell:
    """A cell in which a trial may begin, uniform."""
    cell: Cell = random_cell_of(lab.walls, lab.rows, lab.cols, random)
    return cell


@kernel
def sees(lab: Lab, row: int, col: int, other_row: int, other_col: int, open_doors: int) -> bool:
    """Whether two cells see each other, with a bit in `open_doors` for each door that is open."""
    seen: bool = in_sight(lab.walls, lab.doors, lab.cols, row, col, other_row, other_col, open_doors)
    return seen


def _toggled(doors, open_doors, random):  # type: ignore[no-untyped-def]
    """Which doors are open in a trial, given those of the trial before."""


TOGGLED = Operation(_toggled)
toggled_of = TOGGLED.function


@TOGGLED.of(NoDoors)
def _as_they_were(doors: NoDoors, open_doors: int, random: RandomState) -> int:
    return open_doors


@TOGGLED.of(Doors)
def _perhaps(doors: Doors, open_doors: int, random: RandomState) -> int:
    for door in range(doors.number):
        if doors.chances[door] > 0.0 and happens(random, doors.chances[door]):
            open_doors ^= 1 << door
    return open_doors


@kernel
def toggled(lab: Lab, open_doors: int, random: RandomState) -> int:
    """Which doors are open in a trial, given those of the trial before: each may have been opened or shut."""
    now: int = toggled_of(lab.doors, open_doors, random)
    return now


def open_at_first(lab: Lab) -> int:
    """The doors that are open as a cell or a phase begins."""
    return lab.doors.begin if isinstance(lab.doors, Doors) else ALL_OPEN


def _before_shut(doors, row, col, direction, steps, open_doors):  # type: ignore[no-untyped-def]
    """How many of `steps` unit steps end before a door that is shut."""


BEFORE_SHUT = Operation(_before_shut)
before_shut = BEFORE_SHUT.function


@BEFORE_SHUT.of(NoDoors)
def _all(doors: NoDoors, row: int, col: int, direction: int, steps: int, open_doors: int) -> int:
    return steps


@BEFORE_SHUT.of(Doors)
def _looking(doors: Doors, row: int, col: int, direction: int, steps: int, open_doors: int) -> int:
    for step in range(steps):
        if doors.needed[row + step * ROW_STEPS[direction], col + step * COL_STEPS[direction], direction] & ~open_doors:
            return step
    return steps


@kernel
def move(lab: Lab, row: int, col: int, direction: int, speed: int, open_doors: int) -> Cell:
    """Where `speed` unit steps in `direction` end; the first that is not free ends the move, without sliding.

    `open_doors` has a bit for each door that is open.
    """
    steps = min(speed, lab.reach[row, col, direction])
    steps = before_shut(lab.doors, row, col, direction, steps, open_doors)
    return row + steps * ROW_STEPS[direction], col + steps * COL_STEPS[direction]
