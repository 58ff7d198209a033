"""Walls between cells: which unit steps they leave free, and how many in a row (TASK.md, 'Grid, headings, movement').

Over unit steps arrays have the shape (rows, cols, 8), by the cell that a step leaves and its direction.
"""

from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS

Cell = tuple[int, int]
Pair = tuple[Cell, Cell]
"""Two straight neighbours, that a wall may part."""

ROW_STEPS = np.array([0, -1, -1, -1, 0, 1, 1, 1])
"""Rows that a unit step in each direction goes, shape (8,)."""
COL_STEPS = np.array([1, 1, 0, -1, -1, -1, 0, 1])
"""Columns that a unit step in each direction goes, shape (8,)."""


def inside(rows: int, cols: int) -> npt.NDArray[np.bool_]:
    """Whether a unit step stays inside, shape (rows, cols, 8)."""
    row, col = np.arange(rows)[:, None, None] + ROW_STEPS, np.arange(cols)[None, :, None] + COL_STEPS
    stays: npt.NDArray[np.bool_] = (row >= 0) & (row < rows) & (col >= 0) & (col < cols)
    return stays


def crossing(rows: int, cols: int, walls: Iterable[Pair]) -> npt.NDArray[np.bool_]:
    """Whether a unit step crosses one of `walls`, shape (rows, cols, 8); a diagonal one has four ways round.

    Raises:
        ValueError: a wall does not lie between two neighbouring cells.
    """
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

    found = np.zeros((rows, cols, N_DIRECTIONS), np.bool_)
    near = {(row + r, col + c) for wall in closed for row, col in wall for r in (-1, 0, 1) for c in (-1, 0, 1)}
    for row, col in near:
        if 0 <= row < rows and 0 <= col < cols:
            for direction in range(N_DIRECTIONS):
                found[row, col, direction] = crosses((row, col), int(ROW_STEPS[direction]), int(COL_STEPS[direction]))
    return found


def reach_of(passable: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
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
