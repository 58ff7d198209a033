"""A trial in ROS 2's terms (REP 103): metres, x east, y north, headings counter-clockwise from east as quaternions.

The frame `map` has its origin in the world's south-western corner, as a map of nav2 has. Rows go southwards, so that
the middle of cell (row, col) is at x = col + 1/2, y = rows - row - 1/2, in cells.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import open_doors_in
from visitlab_cli.world.enums import N_DIRECTIONS, Direction
from visitlab_cli.world.lab import ALL_OPEN, SOLID, Lab, arena_of
from visitlab_cli.world.sight import Doors

FRAME = "map"
STEP_NS = 1_000_000_000
PARTS = 10
"""Of a cell's side: so fine is the map, in which a wall is one part thick on each of its sides."""
FREE, OCCUPIED = 0, 100
Place = Sequence[float]


class Messages:
    """Makes the messages of a trial, of the types of a `store` of rosbags, with cells of `cell_size` metres."""

    def __init__(self, store: Any, trial: Trial, cell_size: float) -> None:
        """What it makes is of step 0 until `time` is set."""
        self._types = store.types
        self.trial, self.cell_size = trial, cell_size
        self.time = 0

    def make(self, name: str, *values: Any, **named: Any) -> Any:
        """A message of a type that is called as in `geometry_msgs/Point`."""
        return self._types[name.replace("/", "/msg/")](*values, **named)

    def stamp(self) -> Any:
        """The time, ns from 0, as a message."""
        return self.make("builtin_interfaces/Time", *divmod(self.time, STEP_NS))

    def header(self) -> Any:
        """Of a message in the frame `map`."""
        return self.make("std_msgs/Header", self.stamp(), FRAME)

    def point(self, x: float, y: float, z: float = 0.0) -> Any:
        """A place of the scene, in cells and y southwards, `z` cells above the floor."""
        metres = (float(x) * self.cell_size, (self.trial.rows - float(y)) * self.cell_size, z * self.cell_size)
        return self.make("geometry_msgs/Point", *metres)

    def turn(self, heading: float = 0.0) -> Any:
        """A heading in eighths of a circle, counter-clockwise from east, as a quaternion."""
        half = heading * math.pi / N_DIRECTIONS
        return self.make("geometry_msgs/Quaternion", 0.0, 0.0, math.sin(half), math.cos(half))

    def pose(self, point: Any, heading: float = 0.0) -> Any:
        """Where something is and where it heads."""
        return self.make("geometry_msgs/Pose", point, self.turn(heading))

    def pose_of(self, who: str, step: int) -> Any:
        """The stamped pose of `robot` or `human` after a step."""
        row, col, heading = (float(self.trial.steps[f"{who}_{part}"][step]) for part in ("row", "col", "heading"))
        return self.make(
            "geometry_msgs/PoseStamped", self.header(), self.pose(self.point(col + 0.5, row + 0.5), heading)
        )

    def grid(self) -> Any:
        """The world as an occupancy grid, `PARTS` parts a cell: occupied along each side that can't be crossed."""
        trial = self.trial
        lab = trial.lab if trial.arena is None else arena_of(trial.arena)
        cells = occupied(lab, open_doors_in(trial.steps))[::-1]  # from the south on
        height, width = cells.shape
        corner = self.point(0, trial.rows)
        info = self.make("nav_msgs/MapMetaData", self.stamp(), self.cell_size / PARTS, width, height, self.pose(corner))
        return self.make("nav_msgs/OccupancyGrid", self.header(), info, np.ascontiguousarray(cells).ravel())


def occupied(lab: Lab, open_doors: int = ALL_OPEN) -> npt.NDArray[np.int8]:
    """What can't be entered of a lab, from the north-west on: shape (rows * PARTS, cols * PARTS)."""
    found = np.full((lab.rows, PARTS, lab.cols, PARTS), FREE, np.int8)
    closed = lab.reach == 0
    if isinstance(lab.doors, Doors):
        closed |= (lab.doors.needed & ~np.int64(open_doors)) != 0
    sides = {
        Direction.NORTH: found[:, 0],
        Direction.SOUTH: found[:, -1],
        Direction.WEST: found[:, :, :, 0].swapaxes(1, 2),
        Direction.EAST: found[:, :, :, -1].swapaxes(1, 2),
    }
    for side, parts in sides.items():
        parts[closed[:, :, side]] = OCCUPIED
    found.swapaxes(1, 2)[lab.rooms == SOLID] = OCCUPIED
    return found.reshape(lab.rows * PARTS, lab.cols * PARTS)
