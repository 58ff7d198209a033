"""What a visit goes on to learn of moving, once navigation's training is over: a door that was shut, or opened.

Of each cell and physical action one end is known, whatever the goal. It is learned from the robot's executed moves and
from those of a human who follows: one who does not move is blocked in its direction at every speed.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import Saved
from visitlab_cli.compiled import kernel, long_kernel
from visitlab_cli.simulation.estimates import UNKNOWN_DIRECTION, direction_seen
from visitlab_cli.simulation.successors import Successors, apart, pooled_counts
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS, N_MOVES, N_PHYSICAL_ACTIONS, InteractionLevel
from visitlab_cli.world.scene import Scene

LAST_SEEN, OWN = "last_seen", "own"
"""How it learns: the end that was seen last, or the one that was seen most often, training included."""
_NOTHING, _LAST, _MOST_OFTEN = range(3)
_MODES: Mapping[str | None, int] = {None: _NOTHING, LAST_SEEN: _LAST, OWN: _MOST_OFTEN}


class Learning(NamedTuple):
    """How it learns; `often` (cells, 25, 4): how often an action got 0 to 3 cells far, empty where that is all one."""

    mode: int
    often: npt.NDArray[np.int64]


def make_learning(how: str | None, model: Saved, known: Successors) -> Learning:
    """Learning by `LAST_SEEN` or `OWN`, which begins with what navigation's `model` has seen; None: nothing learns."""
    often = np.zeros((len(known.after) if how == OWN else 0, N_PHYSICAL_ACTIONS, MAX_SPEED + 1), np.int64)
    if how == OWN:
        for cell, action, end, count in zip(*pooled_counts(model, len(known.after)), strict=True):
            often[cell, action, abs(known.place[cell] - known.place[end]).max()] += int(count)
    return Learning(_MODES[how], often)


@long_kernel
def learn_moves(learning: Learning, known: Successors, before: Scene, after: Scene, cols: int) -> bool:
    """Learn from a step in a lab with `cols` columns; whether an action is now known to end elsewhere."""
    if learning.mode == _NOTHING:
        return False
    changed = False
    if after.executed_action < N_MOVES:
        robot, end = before.robot_row * cols + before.robot_col, after.robot_row * cols + after.robot_col
        changed = _saw(learning, known, robot, after.executed_action, end)
    follows = InteractionLevel.FOLLOWS
    direction = direction_seen(before, after)
    if before.perceived_level != follows or after.perceived_level != follows or direction == UNKNOWN_DIRECTION:
        return changed
    human, end = before.human_row * cols + before.human_col, after.human_row * cols + after.human_col
    gone = apart(known, human, end)
    for slower in range(MAX_SPEED):
        if gone in (0, slower + 1):
            changed = _saw(learning, known, human, N_DIRECTIONS * slower + direction, end) or changed
    return changed


@kernel
def _saw(learning: Learning, known: Successors, cell: int, action: int, end: int) -> bool:
    """An action in a cell ended in another; whether that is news."""
    if learning.mode == _MOST_OFTEN:
        gone, so_far = apart(known, cell, end), apart(known, cell, known.after[cell, action])
        learning.often[cell, action, gone] += 1
        if learning.often[cell, action, gone] <= learning.often[cell, action, so_far]:
            return False
    if known.after[cell, action] == end:
        return False
    known.after[cell, action] = end
    return True
