"""What the human sees: the cells of its visual field, 90 degrees to each side, and facing field, 45 (paper, Fig. 3)."""

from functools import cache

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.enums import N_DIRECTIONS
from visitlab_cli.world.geometry import (
    BEHIND,
    CIRCLE,
    CLOSEST_APPROPRIATE,
    FACING_FIELD,
    FARTHEST_APPROPRIATE,
    HUNDREDTHS,
    VISUAL_FIELD,
    make_geometry,
)
from visitlab_cli.world.lab import Lab, sees
from visitlab_cli.world.sight import Walls

NOTHING, SEES, FACES = range(3)
"""Classes of cells."""
REACH = 8
"""How far the fields are drawn as cells."""
SEES_DEGREES, FACES_DEGREES = (field * 360 / CIRCLE for field in (VISUAL_FIELD, FACING_FIELD))
"""How far to each side of its heading."""


@cache
def fields_around(distances: tuple[int, ...]) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.bool_]]:
    """The cells around a human: their class by its heading, and which are at a distance to interact.

    Shapes (8, 2 REACH + 1, 2 REACH + 1), by heading, row and col, and without the heading.
    """
    geometry = make_geometry(REACH + 1, REACH + 1, distances)
    from_human = np.arange(-REACH, REACH + 1)
    north, east = np.meshgrid(from_human, -from_human, indexing="ij")  # from a robot in that cell to the human
    to_robot = geometry.bearing[north + geometry.reach, east + geometry.reach] + BEHIND
    category = geometry.distance[north + geometry.reach, east + geometry.reach]
    turn = (np.arange(N_DIRECTIONS)[:, None, None] * HUNDREDTHS - to_robot) % CIRCLE
    turn = np.minimum(turn, CIRCLE - turn)
    fields = np.where(turn <= FACING_FIELD, FACES, np.where(turn <= VISUAL_FIELD, SEES, NOTHING))
    fields[:, REACH, REACH] = NOTHING
    near = (category >= CLOSEST_APPROPRIATE) & (category <= FARTHEST_APPROPRIATE)
    return fields.astype(np.uint8), near


@cache
def unwalled_around(lab: Lab, row: int, col: int, open_doors: int) -> npt.NDArray[np.bool_]:
    """Which of the cells around one are behind no wall of a lab, shape (2 REACH + 1, 2 REACH + 1)."""
    found = np.ones((2 * REACH + 1, 2 * REACH + 1), np.bool_)
    if isinstance(lab.walls, Walls):
        for place in np.ndindex(found.shape):
            other_row, other_col = row + place[0] - REACH, col + place[1] - REACH
            if 0 <= other_row < lab.rows and 0 <= other_col < lab.cols:
                found[place] = sees(lab, row, col, other_row, other_col, open_doors)
    return found


def cells_seen(
    row: int, col: int, heading: int, world: tuple[int, int], distances: tuple[int, ...]
) -> npt.NDArray[np.uint8]:
    """Classes of the cells around a human in a `world` of (rows, cols), shape (2 REACH + 1, 2 REACH + 1)."""
    around = np.arange(-REACH, REACH + 1)
    rows, cols = row + around, col + around
    inside = ((rows >= 0) & (rows < world[0]))[:, None] & ((cols >= 0) & (cols < world[1]))
    seen: npt.NDArray[np.uint8] = fields_around(distances)[0][heading] * inside
    return seen
