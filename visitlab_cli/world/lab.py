"""The lab: a grid of cells, its rooms, walls and doors, and how a move ends (TASK.md, 'Grid, headings, movement').

Cells are (row, column), row 0 in the north, column 0 in the west. `reach` says how many unit steps may be taken one
after the other; that one table holds the borders, the walls and the rule for diagonals. A door that is shut puts
walls back: `doors` says which doors a unit step needs open, one bit a door, and a scene says which ones are.
"""

from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import Operation, kernel
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS

Cell = tuple[int, int]
Wall = tuple[Cell, Cell]
"""Between two straight neighbours."""

ALL_OPEN = -1
"""The doors of a scene in which none is shut: every bit set."""
MOST_DOORS = 64

ROW_STEPS = np.array([0, -1, -1, -1, 0, 1, 1, 1])
"""Rows that a unit step in each direction goes, shape (8,)."""
COL_STEPS = np.array([1, 1, 0, -1, -1, -1, 0, 1])
"""Columns that a unit step in each direction goes, shape (8,)."""


class NoDoors(NamedTuple):
    """The doors of a lab without any, a type of its own: where there are none, nothing is compiled that looks."""

    number: int = 0


class Doors(NamedTuple):
    """Doors that can be shut: which of them a unit step needs open, bit i for door i, shape (rows, cols, 8)."""

    number: int
    needed: npt.NDArray[np.int64]


class Lab(NamedTuple):
    """A lab as kernels see it; arrays over cells have the shape (rows, cols), over unit steps (rows, cols, 8).

    A lab is the same as itself only, so that what is computed of it can be kept.
    """

    rows: int
    cols: int
    n_rooms: int
    rooms: npt.NDArray[np.int64]  # the room of a cell, 0..n_rooms-1
    reach: npt.NDArray[np.int64]  # unit steps from a cell, at most 3, that stay inside and cross no wall
    doors: NoDoors | Doors

    def __eq__(self, other: object) -> bool:
        return self is other

    def __ne__(self, other: object) -> bool:
        return self is not other

    def __hash__(self) -> int:
        return id(self)


class Box(NamedTuple):
    """A rectangle of cells, from its north-western one on."""

    row: int
    col: int
    rows: int
    cols: int


def make_lab(
    rows: int,
    cols: int,
    walls: Iterable[Wall] = (),
    doors: Sequence[Iterable[Wall]] = (),
    rooms: npt.ArrayLike | None = None,
) -> Lab:
    """A lab of `rows` x `cols` cells with a wall between each pair of straight neighbours in `walls`.

    Args:
        rows: cells from north to south, at least 1.
        cols: cells from west to east, at least 1.
        walls: which pairs of cells have one between them.
        doors: of each door, at most 64, the pairs of cells that it parts when it is shut.
        rooms: the room of each cell, shape (rows, cols), from 0; one room where there is none.

    Raises:
        ValueError: a wall does not lie between two neighbouring cells, or there are too many doors.
    """
    if len(doors) > MOST_DOORS:
        raise ValueError(f"at most {MOST_DOORS} doors can be shut, not {len(doors)}")
    plan = np.zeros((rows, cols), np.int64) if rooms is None else np.array(rooms, np.int64).reshape(rows, cols)
    passable = ~_crossing(rows, cols, walls)
    passable &= _inside(rows, cols)
    needed = np.zeros((rows, cols, N_DIRECTIONS), np.int64)
    for number, leaves in enumerate(doors):
        needed |= np.where(_crossing(rows, cols, leaves), np.uint64(1 << number), np.uint64(0)).view(np.int64)
    shut = Doors(len(doors), needed) if len(doors) else NoDoors()
    return Lab(rows, cols, int(plan.max()) + 1, plan, _reach(passable), shut)


def _reach(passable: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """How many unit steps in each direction are free one after the other, at most as many as a move has.

    Both `passable`, whether one is free, and what comes back have the shape (rows, cols, 8).
    """
    rows, cols, _ = passable.shape
    reach = np.zeros(passable.shape, np.int64)
    for _ in range(MAX_SPEED):  # one more than the cell ahead has
        around = np.pad(reach, ((1, 1), (1, 1), (0, 0)))
        for direction in range(N_DIRECTIONS):
            row, col = 1 + ROW_STEPS[direction], 1 + COL_STEPS[direction]
            ahead = around[row : row + rows, col : col + cols, direction]
            free = passable[:, :, direction]
            reach[:, :, direction] = np.where(free, np.minimum(ahead + 1, MAX_SPEED), 0)
    return reach


def _inside(rows: int, cols: int) -> npt.NDArray[np.bool_]:
    """Whether a unit step stays inside, shape (rows, cols, 8)."""
    row, col = np.arange(rows)[:, None, None] + ROW_STEPS, np.arange(cols)[None, :, None] + COL_STEPS
    inside: npt.NDArray[np.bool_] = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
    return inside


def _crossing(rows: int, cols: int, walls: Iterable[Wall]) -> npt.NDArray[np.bool_]:
    """Whether a unit step crosses one of `walls`, shape (rows, cols, 8); a diagonal one has four ways round."""
    closed = set()
    for wall in walls:
        (row, col), (other_row, other_col) = wall
        if abs(row - other_row) + abs(col - other_col) != 1:
            raise ValueError(f"a wall lies between straight neighbours, not {(row, col)}, {(other_row, other_col)}")
        closed |= {wall, wall[::-1]}

    def crosses(cell: Cell, row_step: int, col_step: int) -> bool:
        ahead, beside = (cell[0] + row_step, cell[1]), (cell[0], cell[1] + col_step)
        there = ahead[0], beside[1]
        if row_step == 0 or col_step == 0:
            return (cell, there) in closed
        return not closed.isdisjoint({(cell, ahead), (cell, beside), (ahead, there), (beside, there)})

    crossing = np.zeros((rows, cols, N_DIRECTIONS), np.bool_)
    near = {(row + r, col + c) for wall in closed for row, col in wall for r in (-1, 0, 1) for c in (-1, 0, 1)}
    for row, col in near:
        if 0 <= row < rows and 0 <= col < cols:
            for direction in range(N_DIRECTIONS):
                crossing[row, col, direction] = crosses(
                    (row, col), int(ROW_STEPS[direction]), int(COL_STEPS[direction])
                )
    return crossing


def box_of(lab: Lab, room: int) -> Box:
    """The smallest rectangle around the cells of a room."""
    rows, cols = np.nonzero(lab.rooms == room)
    row, col = int(rows.min()), int(cols.min())
    return Box(row, col, int(rows.max()) + 1 - row, int(cols.max()) + 1 - col)


@cache
def paper_lab() -> Lab:
    """The paper's: 3 x 3 rooms of 8 x 8 cells, numbered row by row from the north-west, without walls."""
    rows = np.arange(24) // 8
    return make_lab(24, 24, rooms=rows[:, None] * 3 + rows[None, :])


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
