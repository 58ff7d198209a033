"""Who is in whose sight where there are walls: tables over all pairs of cells, and the doors that may be shut between.

Two cells see each other when the straight segment between their middles crosses no wall. From (r0, c0) on, with
dr = |r1 - r0| and dc = |c1 - c0|, it crosses the i-th border between rows at (2i + 1) / (2 dr) of its length, and the
j-th between columns at (2j + 1) / (2 dc); in whole numbers, (2i + 1) dc against (2j + 1) dr says which comes first.
Where both come at once it runs through a corner, and the diagonal unit step must be free: no wall ends there.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import Operation
from visitlab_cli.world.enums import N_DIRECTIONS
from visitlab_cli.world.walls import COL_STEPS, ROW_STEPS

UNSEEN, SEEN, THROUGH_DOORS = range(3)
"""How two cells are to each other."""


class NoDoors(NamedTuple):
    """The doors of a lab without any, a type of its own: where there are none, nothing is compiled that looks."""

    number: int = 0


class Doors(NamedTuple):
    """Doors that can be shut: which of them a unit step needs open, bit i for door i, shape (rows, cols, 8).

    `masks` are the sets of doors that pairs of cells need open to see each other, as `Walls.sight` numbers them.
    `chances` (number,) is how likely each is opened or shut before a trial, `begin` which are open at first.
    """

    number: int
    needed: npt.NDArray[np.int64]
    masks: npt.NDArray[np.int64]
    chances: npt.NDArray[np.float64]
    begin: int


class NoWalls(NamedTuple):
    """The walls of an open lab: everywhere is in sight, which costs nothing."""

    number: int = 0


class Walls(NamedTuple):
    """`sight[a, b]`: `UNSEEN`, `SEEN`, or from `THROUGH_DOORS` on which of `Doors.masks` must be open: (cells, cells).

    `starts` are the cells, row * cols + col, in which a trial may begin: those that can be reached.
    """

    sight: npt.NDArray[np.unsignedinteger[Any]]
    starts: npt.NDArray[np.int64]

    @property
    def visible(self) -> npt.NDArray[np.bool_]:
        """Whether two cells see each other with all doors open, shape (cells, cells)."""
        visible: npt.NDArray[np.bool_] = self.sight != UNSEEN
        return visible


def sight_of(
    passable: npt.NDArray[np.bool_], needed: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.unsignedinteger[Any]], npt.NDArray[np.int64]]:
    """`Walls.sight` and `Doors.masks`, from which unit steps are free, and the doors that each needs open."""
    seen = _over_segments(passable, np.logical_and, identity=True)
    if not needed.any():
        return seen.astype(np.uint8), np.zeros(0, np.int64)
    masks, which = np.unique(_over_segments(needed, np.bitwise_or, identity=0), return_inverse=True)
    through = which.reshape(seen.shape) - 1 + THROUGH_DOORS  # the first of the masks, 0, needs none
    sight = np.where(seen, np.where(which.reshape(seen.shape) == 0, SEEN, through), UNSEEN)
    return sight.astype(np.min_scalar_type(int(sight.max()))), masks[1:]


def _over_segments(of_steps: npt.NDArray[Any], combine: Any, identity: Any) -> npt.NDArray[Any]:
    """What the unit steps and corners on the segment between each two cells have, combined: shape (cells, cells)."""
    rows, cols, _ = of_steps.shape
    found = np.full((rows, cols, rows, cols), identity, of_steps.dtype)
    for down in range(rows):
        for right in range(1 - cols, cols):
            if (down, right) <= (0, 0):
                continue  # the way back, which is the same
            west, east = max(0, -right), cols - max(0, right)
            along = np.full((rows - down, east - west), identity, of_steps.dtype)
            for row, col, direction in crossings(down, right):
                steps = of_steps[row : row + rows - down, west + col : east + col, direction]
                combine(along, steps, out=along)
            first, second = np.arange(rows - down)[:, None], np.arange(west, east)[None, :]
            found[first, second, first + down, second + right] = along
            found[first + down, second + right, first, second] = along
    return found.reshape(rows * cols, rows * cols)


def crossings(down: int, right: int) -> Iterator[tuple[int, int, int]]:
    """The unit steps that a segment to a cell `down` rows and `right` columns away takes, in their order.

    Each as the rows and columns from the segment's first cell, and a direction, diagonal where it meets a corner.
    """
    rows, cols = abs(down), abs(right)
    row_step, col_step = (1 if down > 0 else -1), (1 if right > 0 else -1)
    i = j = 0
    while i < rows or j < cols:
        row_border, col_border = (2 * i + 1) * cols, (2 * j + 1) * rows
        goes_down = i < rows and (j == cols or row_border <= col_border)
        goes_right = j < cols and (i == rows or col_border <= row_border)
        step = goes_down * row_step, goes_right * col_step
        yield i * row_step, j * col_step, _DIRECTIONS[step]
        i, j = i + goes_down, j + goes_right


_DIRECTIONS = {(int(ROW_STEPS[each]), int(COL_STEPS[each])): each for each in range(N_DIRECTIONS)}


def _seen_through(doors, sight, open_doors):  # type: ignore[no-untyped-def]
    """Whether two cells see each other that are to each other as `sight` says."""


def _in_sight(walls, doors, cols, row, col, other_row, other_col, open_doors):  # type: ignore[no-untyped-def]
    """Whether two cells of a lab, `cols` wide, see each other while `open_doors` are open."""


SEEN_THROUGH, IN_SIGHT = Operation(_seen_through), Operation(_in_sight)
seen_through, in_sight = SEEN_THROUGH.function, IN_SIGHT.function


@SEEN_THROUGH.of(NoDoors)
def _nothing_shut(doors: NoDoors, sight: int, open_doors: int) -> bool:
    return sight != UNSEEN


@SEEN_THROUGH.of(Doors)
def _nothing_shut_between(doors: Doors, sight: int, open_doors: int) -> bool:
    if sight < THROUGH_DOORS:
        return sight != UNSEEN
    open_all: bool = (doors.masks[sight - THROUGH_DOORS] & ~open_doors) == 0
    return open_all


@IN_SIGHT.of(NoWalls)
def _everywhere(
    walls: NoWalls,
    doors: NoDoors | Doors,
    cols: int,
    row: int,
    col: int,
    other_row: int,
    other_col: int,
    open_doors: int,
) -> bool:
    return True


@IN_SIGHT.of(Walls)
def _behind_no_wall(
    walls: Walls, doors: NoDoors | Doors, cols: int, row: int, col: int, other_row: int, other_col: int, open_doors: int
) -> bool:
    sight = int(walls.sight[row * cols + col, other_row * cols + other_col])
    seen: bool = seen_through(doors, sight, open_doors)
    return seen
