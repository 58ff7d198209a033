"""The lab: a grid of cells, its rooms and walls, and how a move ends (TASK.md, 'Grid, headings, movement').

Cells are (row, column), row 0 in the north, column 0 in the west. A unit step may be taken where `passable`
says so; that one table holds the borders, the walls and the rule for diagonals.
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import kernel
from visitlab_cli.world.enums import N_DIRECTIONS

Cell = tuple[int, int]

ROOM_SIZE = 8
ROOMS_PER_SIDE = 3
N_ROOMS = ROOMS_PER_SIDE**2
LAB_SIZE = ROOM_SIZE * ROOMS_PER_SIDE

ROW_STEPS = np.array([0, -1, -1, -1, 0, 1, 1, 1])
"""Rows that a unit step in each direction goes, shape (8,)."""
COL_STEPS = np.array([1, 1, 0, -1, -1, -1, 0, 1])
"""Columns that a unit step in each direction goes, shape (8,)."""


class Grid(NamedTuple):
    """`passable[row, col, direction]`: whether a unit step from there stays inside and crosses no wall."""

    rows: int
    cols: int
    passable: npt.NDArray[np.bool_]


def make_grid(rows: int, cols: int, walls: Iterable[tuple[Cell, Cell]] = ()) -> Grid:
    """A grid of `rows` x `cols` with a wall between each pair of straight neighbours in `walls`.

    Raises:
        ValueError: a wall does not lie between two neighbouring cells.
    """
    closed = set()
    for (row, col), (other_row, other_col) in walls:
        if abs(row - other_row) + abs(col - other_col) != 1:
            raise ValueError(f"a wall lies between straight neighbours, not {(row, col)}, {(other_row, other_col)}")
        closed |= {((row, col), (other_row, other_col)), ((other_row, other_col), (row, col))}

    def straight(cell: Cell, row_step: int, col_step: int) -> bool:
        row, col = cell[0] + row_step, cell[1] + col_step
        return 0 <= row < rows and 0 <= col < cols and (cell, (row, col)) not in closed

    def free(cell: Cell, row_step: int, col_step: int) -> bool:
        if row_step == 0 or col_step == 0:
            return straight(cell, row_step, col_step)
        beside, ahead = (cell[0], cell[1] + col_step), (cell[0] + row_step, cell[1])
        return (
            straight(cell, 0, col_step)
            and straight(cell, row_step, 0)
            and straight(beside, row_step, 0)
            and straight(ahead, 0, col_step)
        )

    passable = np.empty((rows, cols, N_DIRECTIONS), np.bool_)
    for row in range(rows):
        for col in range(cols):
            for direction in range(N_DIRECTIONS):
                steps = int(ROW_STEPS[direction]), int(COL_STEPS[direction])
                passable[row, col, direction] = free((row, col), *steps)
    return Grid(rows, cols, passable)


@kernel
def move(grid: Grid, row: int, col: int, direction: int, speed: int) -> Cell:
    """Where `speed` unit steps in `direction` end; the first that is not free ends the move, without sliding."""
    for _ in range(speed):
        if not grid.passable[row, col, direction]:
            break
        row += ROW_STEPS[direction]
        col += COL_STEPS[direction]
    return row, col


@kernel
def room_of(row: int, col: int) -> int:
    """The room of a cell of the lab, 0..8, row by row from the north-west."""
    return (row // ROOM_SIZE) * ROOMS_PER_SIDE + col // ROOM_SIZE
