"""How fast a human moves and how often it loses attention, estimated from what the robot sees of it.

Only cells, interaction levels and the robot's own actions are looked at: never the human's parameters, nor the speed
that it drew. A move that was cut short may have been meant at several speeds: it counts for each by how likely that
was. Each estimate is (STRENGTH x prior + counts) / (STRENGTH + chances), over all chances or over the last few.
"""

from typing import NamedTuple

import numpy as np

from visitlab_cli.agents.exploration import Table
from visitlab_cli.compiled import kernel, long_kernel
from visitlab_cli.simulation.successors import Successors
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS, Action, InteractionLevel
from visitlab_cli.world.geometry import is_appropriate
from visitlab_cli.world.human import is_gesture
from visitlab_cli.world.lab import COL_STEPS, ROW_STEPS
from visitlab_cli.world.scene import Scene

STRENGTH = 10.0
"""What the prior counts for, in chances."""
PRIOR_LOSS = 0.1
RECENT = 200
"""How many chances are remembered where one human may take the place of another."""
UNKNOWN_DIRECTION = -1


class Estimates(NamedTuple):
    """`speeds` (3,) is p_S, `loss` (1,) p_A; what they follow from: `moves` (3,), `losses` (2,) lost and kept.

    `recent_moves` (window, 3) and `recent_losses` (window, 2) are the last chances, in a ring; without a window all
    count. `seen` (2,) is how many moves and chances to lose attention there were. `fixed`: told, and not estimated.
    """

    speeds: Table
    loss: Table
    moves: Table
    losses: Table
    recent_moves: Table
    recent_losses: Table
    seen: Table
    fixed: bool


def make_estimates(window: int = 0, told: tuple[tuple[float, ...], float] | None = None) -> Estimates:
    """Fresh estimates over the last `window` chances (0: all of them); or the p_S and p_A that are `told`."""
    speeds, loss = told or ((1 / MAX_SPEED,) * MAX_SPEED, PRIOR_LOSS)
    return Estimates(
        np.array(speeds, float),
        np.array([loss], float),
        np.zeros(MAX_SPEED),
        np.zeros(2),
        np.zeros((window, MAX_SPEED)),
        np.zeros((window, 2)),
        np.zeros(2),
        told is not None,
    )


@long_kernel
def notice(estimates: Estimates, known: Successors, before: Scene, after: Scene, cols: int) -> None:
    """Learn from one step of a lab with `cols` columns, from the scene `before` to that `after`."""
    if estimates.fixed:
        return
    engaged = before.perceived_level >= InteractionLevel.GREETED
    human = before.human_row * cols + before.human_col
    in_reach = is_appropriate(before.distance)
    if engaged and in_reach and after.executed_action != Action.HELLO:  # a hello may win it back at once
        _notice_attention(estimates, after.perceived_level < InteractionLevel.GREETED)
    direction = direction_seen(before, after)
    if direction != UNKNOWN_DIRECTION:
        _notice_move(estimates, known, human, after.human_row * cols + after.human_col, direction)


@kernel
def direction_seen(before: Scene, after: Scene) -> int:
    """Where the human went: towards the robot if it follows, blocked or not, else as its cells tell."""
    follows = InteractionLevel.FOLLOWS
    if before.perceived_level == follows and after.perceived_level == follows:
        if is_gesture(after.executed_action):
            return UNKNOWN_DIRECTION
        return (before.angle + N_DIRECTIONS // 2) % N_DIRECTIONS
    rows, cols = after.human_row - before.human_row, after.human_col - before.human_col
    cells = max(abs(rows), abs(cols))
    if cells > 0:
        for direction in range(N_DIRECTIONS):
            if rows == cells * ROW_STEPS[direction] and cols == cells * COL_STEPS[direction]:
                return direction
    return UNKNOWN_DIRECTION


@kernel
def _notice_move(estimates: Estimates, known: Successors, start: int, end: int, direction: int) -> None:
    """Share a move out among the speeds at which it ends where it did; one that none explains tells nothing."""
    likely = 0.0
    for slower in range(MAX_SPEED):
        if known.after[start, N_DIRECTIONS * slower + direction] == end:
            likely += estimates.speeds[slower]
    if likely <= 0.0:
        return
    ring = int(estimates.seen[0]) % max(1, len(estimates.recent_moves))
    estimates.seen[0] += 1
    total = 0.0
    for slower in range(MAX_SPEED):
        share = 0.0
        if known.after[start, N_DIRECTIONS * slower + direction] == end:
            share = estimates.speeds[slower] / likely
        estimates.moves[slower] += _in_window(estimates.recent_moves, ring, slower, share)
        total += estimates.moves[slower]
    for slower in range(MAX_SPEED):
        estimates.speeds[slower] = (STRENGTH / MAX_SPEED + estimates.moves[slower]) / (STRENGTH + total)


@kernel
def _notice_attention(estimates: Estimates, lost: bool) -> None:
    ring = int(estimates.seen[1]) % max(1, len(estimates.recent_losses))
    estimates.seen[1] += 1
    estimates.losses[0] += _in_window(estimates.recent_losses, ring, 0, 1.0 if lost else 0.0)
    estimates.losses[1] += _in_window(estimates.recent_losses, ring, 1, 0.0 if lost else 1.0)
    chances = estimates.losses[0] + estimates.losses[1]
    estimates.loss[0] = (STRENGTH * PRIOR_LOSS + estimates.losses[0]) / (STRENGTH + chances)


@kernel
def _in_window(recent: Table, ring: int, column: int, value: float) -> float:
    """What a new value changes of a sum over the window; all that there ever was without one."""
    if len(recent) == 0:
        return value
    forgotten = recent[ring, column]
    recent[ring, column] = value
    return value - float(forgotten)
