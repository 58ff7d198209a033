"""Distance, angle, and who sees and faces whom, from tables over (row, column) differences (TASK.md, 'Geometry').

Bearings are whole hundredths of 45 degrees, so that the bounds of the visual fields are exact.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import kernel
from visitlab_cli.world.enums import N_DIRECTIONS, InteractionLevel

DISTANCES = (1, 2, 4, 5)
"""Largest Chebyshev distances, in cells, of the categories 0 to 3."""
CLOSEST_APPROPRIATE, FARTHEST_APPROPRIATE = 1, 3
TOO_FAR = 4
"""The category of what is farther, and of who is behind a wall."""
HUNDREDTHS = 100
CIRCLE = N_DIRECTIONS * HUNDREDTHS
BEHIND = CIRCLE // 2
VISUAL_FIELD = 2 * HUNDREDTHS  # 90 degrees to each side
FACING_FIELD = 1 * HUNDREDTHS


class Geometry(NamedTuple):
    """Tables of shape (2 reach + 1, 2 reach + 1), by robot_row - human_row and human_col - robot_col plus `reach`."""

    reach: int
    bearing: npt.NDArray[np.int64]  # from robot to human, hundredths of 45 degrees, 0..799
    angle: npt.NDArray[np.int64]  # the nearest direction, 0..7
    distance: npt.NDArray[np.int64]  # category 0..4


def make_geometry(rows: int, cols: int, distances: Sequence[int] = DISTANCES) -> Geometry:
    """The tables of a grid of `rows` x `cols` cells with the four `distances` thresholds, in cells."""
    return _tables(rows, cols, tuple(distances))


@lru_cache(maxsize=8)
def _tables(rows: int, cols: int, distances: tuple[int, ...]) -> Geometry:
    reach = max(rows, cols) - 1
    differences = np.arange(-reach, reach + 1)
    north, east = np.meshgrid(differences, differences, indexing="ij")
    turns = np.arctan2(north, east) / (np.pi / 4) % N_DIRECTIONS
    bearing = np.rint(turns * HUNDREDTHS).astype(np.int64) % CIRCLE
    nearest = np.rint(bearing / HUNDREDTHS)  # a tie goes to the even one, as in TASK.md
    chebyshev = np.maximum(abs(north), abs(east))
    category = np.searchsorted(distances, chebyshev, side="left")
    return Geometry(reach, bearing, (nearest % N_DIRECTIONS).astype(np.int64), category.astype(np.int64))


@kernel
def is_appropriate(distance: int) -> bool:
    """Whether the category of a distance is one to interact at."""
    return CLOSEST_APPROPRIATE <= distance <= FARTHEST_APPROPRIATE


@kernel
def _within(heading: int, bearing: int, field: int) -> bool:
    turn = (heading * HUNDREDTHS - bearing) % CIRCLE
    return min(turn, CIRCLE - turn) <= field


@kernel
def sight(geometry: Geometry, north: int, east: int, robot_heading: int, human_heading: int) -> int:
    """Interaction level 0..4: who sees and faces whom, engagement aside.

    `north` is robot_row - human_row and `east` is human_col - robot_col, in cells.
    """
    bearing = int(geometry.bearing[north + geometry.reach, east + geometry.reach])
    to_robot = bearing + BEHIND
    if not _within(human_heading, to_robot, VISUAL_FIELD):
        return InteractionLevel.NOT_SEEN.value
    human_faces = _within(human_heading, to_robot, FACING_FIELD)
    robot_faces = _within(robot_heading, bearing, FACING_FIELD)
    if human_faces:
        return InteractionLevel.BOTH_FACE.value if robot_faces else InteractionLevel.HUMAN_FACES.value
    return InteractionLevel.ROBOT_FACES.value if robot_faces else InteractionLevel.SEEN.value
