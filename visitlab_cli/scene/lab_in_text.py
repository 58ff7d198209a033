"""A lab from above in plain characters, two for each cell: for a terminal."""

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.enums import Direction
from visitlab_cli.world.lab import SOLID, Lab, box_of, open_at_first, room_names, shut_steps

BESIDE = {"wall": "|", "shut": "!", "room": ":", "": " "}
BELOW = {"wall": "_", "shut": "=", "room": ".", "": " "}
"""What parts two cells: a wall, a door that is shut, another room without a wall, nothing."""
LEGEND = "| and _: wall; ! and =: shut door; : and .: where another room begins, without a wall; #: solid"


def lab_in_text(lab: Lab) -> str:
    """A line for each row of cells under the northern border; each room's name stands in its middle."""
    names = {}
    for room, name in enumerate(room_names(lab)):
        box = box_of(lab, room)
        names[box.row + (box.rows - 1) // 2, box.col + (box.cols - 1) // 2] = name[0]
    shut = shut_steps(lab, open_at_first(lab))
    lines = [" " + "_" * (2 * lab.cols - 1)]
    for row in range(lab.rows):
        line = "|"
        for col in range(lab.cols):
            solid = lab.rooms[row, col] == SOLID
            below, beside = (_parting(lab, shut, row, col, way) for way in (Direction.SOUTH, Direction.EAST))
            line += "#" if solid else names.get((row, col), BELOW[below])
            line += BESIDE[beside] if beside else BELOW[below] if below == "wall" else " "
        lines.append(line)
    return "\n".join(lines)


def _parting(lab: Lab, shut: npt.NDArray[np.bool_], row: int, col: int, direction: Direction) -> str:
    """What is between a cell and its neighbour in the south or the east."""
    there = row + (direction == Direction.SOUTH), col + (direction == Direction.EAST)
    if there[0] == lab.rows or there[1] == lab.cols:
        return "wall"
    if lab.rooms[row, col] == SOLID and lab.rooms[there] == SOLID:
        return ""
    if shut[row, col, direction]:
        return "shut"
    if lab.reach[row, col, direction] == 0:
        return "wall"
    return "room" if lab.rooms[row, col] != lab.rooms[there] else ""
