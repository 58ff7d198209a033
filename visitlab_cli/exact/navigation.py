"""Navigation's exact values: what the best policy and random behaviour reach (TASK.md, 'The four tasks').

The tables are made by the world's own `step`, one call for each cell and action, so no rule stands here again.
"""

from functools import cache

import numpy as np

from visitlab_cli.exact.motion import (
    Motion,
    Table,
    optimal_q,
    optimal_sums,
    random_discounted,
    random_sums,
)
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.enums import N_PHYSICAL_ACTIONS, Action
from visitlab_cli.world.lab import LAB_SIZE, N_ROOMS
from visitlab_cli.world.navigation import make_navigation, step
from visitlab_cli.world.scene import NOWHERE

CELLS = LAB_SIZE * LAB_SIZE


@cache
def navigation_motion() -> Motion:
    """`after` (576 cells, 25 actions) and `reward` (576 cells, 9 goal rooms) of the task."""
    task, unused = make_navigation(), random_state(0)
    after = np.empty((CELLS, N_PHYSICAL_ACTIONS), np.int64)
    reward = np.empty((CELLS, N_ROOMS), np.uint8)
    for cell in range(CELLS):
        row, col = divmod(cell, LAB_SIZE)
        scene = NOWHERE._replace(robot_row=row, robot_col=col, goal_room=0)
        for action in range(N_PHYSICAL_ACTIONS):
            moved, _, _ = step(task, scene, action, unused)
            after[cell, action] = moved.robot_row * LAB_SIZE + moved.robot_col
        for room in range(N_ROOMS):
            reward[cell, room] = step(task, scene._replace(goal_room=room), Action.STAY.value, unused)[1]
    return Motion(after, reward)


@cache
def navigation_optimum(trial_steps: int) -> float:
    """The largest expected sum of rewards in a trial; cell and goal room are uniform."""
    return float(optimal_sums(navigation_motion(), trial_steps).mean())


@cache
def navigation_random(trial_steps: int) -> float:
    """The expected sum of rewards of uniformly random actions in a trial."""
    return float(random_sums(navigation_motion(), trial_steps).mean())


@cache
def navigation_optimal_q(gamma: float) -> Table:
    """The optimal discounted Q, shape (5184 states, 25 actions), states as the task numbers them."""
    q = optimal_q(navigation_motion(), gamma).reshape(N_ROOMS * CELLS, N_PHYSICAL_ACTIONS)
    q.setflags(write=False)  # shared by all who ask
    return q


@cache
def navigation_random_discounted(gamma: float) -> float:
    """The discounted value of uniformly random actions, mean over all states."""
    return float(random_discounted(navigation_motion(), gamma).mean())
