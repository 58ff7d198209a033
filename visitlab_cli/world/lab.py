"""The lab: a grid of cells, its rooms, walls and doors, and how a move ends (TASK.md, 'Grid, headings, movement').

Cells are (row, column), row 0 in the north, column 0 in the west. A unit step may be taken where `passable`
says so; that one table holds the borders, the walls and the rule for diagonals. A door that is shut puts walls
back: `doors` says which doors a unit step needs open, one bit a door, and a scene says which ones are.
"""

from collections.abc import Iterable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import kernel
from visitlab_cli.world.enums import N_DIRECTIONS

Cell = tuple[int, int]
Wall = tuple[Cell, Cell]
"""Between two straight neighbours."""

ROOM_SIZE = 8
ROOMS_PER_SIDE = 3
N_ROOMS = ROOMS_PER_SIDE**2
LAB_SIZE = ROOM_SIZE * ROOMS_PER_SIDE

ALL_OPEN = -1
"""The doors of a scene in which none is shut: every bit set."""
MOST_DOORS = 64

ROW_STEPS = np.array([0, -1, -1, -1, 0, 1, 1, 1])
"""Rows that a unit step in each direction goes, shape (8,)."""
COL_STEPS = np.array([1, 1, 0, -1, -1, -1, 0, 1])
"""Columns that a unit step in each direction goes, shape (8,)."""


class Lab(NamedTuple):
    """A lab as kernels see it; arrays over cells have the shape (rows, cols), over unit steps (rows, cols, 8)."""

    rows: int
    cols: int
    n_rooms: int
    n_doors: int
    rooms: npt.NDArray[np.int64]  # the room of a cell, 0..n_rooms-1
    passable: npt.NDArray[np.bool_]  # whether a unit step stays inside and crosses no wall
    doors: npt.NDArray[np.int64]  # the doors that it needs open, bit i for door i; (0, 0, 0) where there are none


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
    needed = np.zeros((rows, cols, N_DIRECTIONS) if len(doors) else (0, 0, 0), np.int64)
    for number, leaves in enumerate(doors):
        needed |= np.where(_crossing(rows, cols, leaves), np.uint64(1 << number), np.uint64(0)).view(np.int64)
    return Lab(rows, cols, int(plan.max()) + 1, len(doors), plan, passable, needed)


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


@cache
def paper_lab() -> Lab:
    """The paper's: 3 x 3 rooms of 8 x 8 cells, numbered row by row from the north-west, without walls."""
    rows = np.arange(LAB_SIZE) // ROOM_SIZE
    return make_lab(LAB_SIZE, LAB_SIZE, rooms=rows[:, None] * ROOMS_PER_SIDE + rows[None, :])


@kernel
def move(lab: Lab, row: int, col: int, direction: int, speed: int, open_doors: int) -> Cell:
    """Where `speed` unit steps in `direction` end; the first that is not free ends the move, without sliding.

    `open_doors` has a bit for each door that is open.
    """
    for _ in range(speed):
        if not lab.passable[row, col, direction]:
            break
        if lab.n_doors > 0 and lab.doors[row, col, direction] & ~open_doors != 0:
            break
        row += ROW_STEPS[direction]
        col += COL_STEPS[direction]
    return row, col
