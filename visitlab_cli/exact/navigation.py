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
from visitlab_cli.world.lab import Lab, goals_of, paper_lab, starts_of
from visitlab_cli.world.navigation import make_navigation, step
from visitlab_cli.world.scene import NOWHERE


@cache
def navigation_motion(lab: Lab | None = None) -> Motion:
    """`after` (cells, 25 actions) and `reward` (cells, rooms) of the task in `lab`, the paper's unless given."""
    lab = lab or paper_lab()
    task, unused = make_navigation(lab=lab), random_state(0)
    cells = lab.rows * lab.cols
    after = np.empty((cells, N_PHYSICAL_ACTIONS), np.int64)
    reward = np.empty((cells, lab.n_rooms), np.uint8)
    for cell in range(cells):
        row, col = divmod(cell, lab.cols)
        scene = NOWHERE._replace(robot_row=row, robot_col=col, goal_room=0)
        for action in range(N_PHYSICAL_ACTIONS):
            moved, _, _ = step(task, scene, action, unused)
            after[cell, action] = moved.robot_row * lab.cols + moved.robot_col
        for room in range(lab.n_rooms):
            reward[cell, room] = step(task, scene._replace(goal_room=room), Action.STAY.value, unused)[1]
    return Motion(after, reward)


@cache
def navigation_optimum(trial_steps: int, lab: Lab | None = None) -> float:
    """The largest expected sum of rewards in a trial; it begins as the task's trials do."""
    lab = lab or paper_lab()
    return float(optimal_sums(_to_goals(lab), trial_steps)[starts_of(lab)].mean())


@cache
def navigation_random(trial_steps: int, lab: Lab | None = None) -> float:
    """The expected sum of rewards of uniformly random actions in a trial."""
    lab = lab or paper_lab()
    return float(random_sums(_to_goals(lab), trial_steps)[starts_of(lab)].mean())


def _to_goals(lab: Lab) -> Motion:
    """The motion of a lab, rewarded in the rooms that may be goals."""
    motion = navigation_motion(lab)
    return motion._replace(reward=motion.reward[:, list(goals_of(lab))])


@cache
def navigation_optimal_q(gamma: float, lab: Lab | None = None) -> Table:
    """The optimal discounted Q, shape (states, 25 actions), states as the task numbers them."""
    q = optimal_q(navigation_motion(lab), gamma).reshape(-1, N_PHYSICAL_ACTIONS)
    q.setflags(write=False)  # shared by all who ask
    return q


def navigation_discounted(gamma: float, lab: Lab | None = None) -> tuple[float, float]:
    """The discounted value of the best policy and of uniformly random actions, means over the starts of trials."""
    lab = lab or paper_lab()
    motion, starts = _to_goals(lab), starts_of(lab)
    best = optimal_q(motion, gamma).max(axis=2)
    return float(best[:, starts].mean()), float(random_discounted(motion, gamma)[:, starts].mean())
