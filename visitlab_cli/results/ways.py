"""How far it is from each cell of a lab to a room, by the fewest moves."""

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.lab import ALL_OPEN, COL_STEPS, ROW_STEPS, Lab
from visitlab_cli.world.sight import Doors


def distances_to(lab: Lab, room: int, open_doors: int = ALL_OPEN) -> npt.NDArray[np.int64]:
    """The fewest moves of one cell from each cell to a room: shape (rows, cols), -1 for never.

    `open_doors` has a bit for each door that is open meanwhile.
    """
    free = lab.reach > 0
    if isinstance(lab.doors, Doors):
        free &= (lab.doors.needed & ~np.int64(open_doors)) == 0
    found = np.where(lab.rooms == room, 0, -1)
    edge = [(int(row), int(col)) for row, col in zip(*np.nonzero(lab.rooms == room), strict=True)]
    steps = 0
    while edge:
        steps += 1
        further = []
        for row, col in edge:
            for direction, (south, east) in enumerate(zip(ROW_STEPS, COL_STEPS, strict=True)):
                place = row + int(south), col + int(east)
                if free[row, col, direction] and found[place] < 0:
                    found[place] = steps
                    further.append(place)
        edge = further
    return found
