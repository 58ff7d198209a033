"""The exact values of `go_to_human` for who knows all: both cells and the human's heading.

The human stands still and moves are certain. The robot's heading changes neither its moves nor the reward, so
robot cell, human cell and human heading are the full state: 576 x 576 x 8 in the paper's lab. An agent on the task's
320 states knows less; what it reaches is below this optimum. Where there are walls nothing is rewarded through them.
"""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.exact.motion import Motion, optimal_sums, random_sums
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.enums import N_DIRECTIONS, N_PHYSICAL_ACTIONS, Action
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.go_to_human import GoToHuman, make_go_to_human, step
from visitlab_cli.world.lab import Lab, make_lab, paper_lab, starts_of
from visitlab_cli.world.scene import NOWHERE, Body, Scene, first_scene
from visitlab_cli.world.sight import Walls


@cache
def go_to_human_motion(success: str = "facing", distances: Sequence[int] = DISTANCES, lab: Lab | None = None) -> Motion:
    """`after` (cells, 25 actions) and `reward` (cells, humans: cell x heading) of the task.

    In `lab`, the paper's unless given.
    """
    lab = lab or paper_lab()
    task, unused = make_go_to_human(success=success, distances=distances, lab=lab), random_state(0)
    cells = lab.rows * lab.cols
    after = np.empty((cells, N_PHYSICAL_ACTIONS), np.int64)
    for cell in range(cells):
        scene = scene_of(task, Body(*divmod(cell, lab.cols), 0), Body(0, 0, 0))
        for action in range(N_PHYSICAL_ACTIONS):
            moved, _, _ = step(task, scene, action, unused)
            after[cell, action] = moved.robot_row * lab.cols + moved.robot_col
    unwalled = make_go_to_human(success=success, distances=distances, lab=make_lab(lab.rows, lab.cols))
    reward = by_offset(
        lab, lambda robot, human: step(unwalled, scene_of(unwalled, robot, human), Action.STAY.value, unused)[1]
    )
    if isinstance(lab.walls, Walls):
        reward *= np.repeat(lab.walls.visible, N_DIRECTIONS, axis=1)
    return Motion(after, reward.astype(np.uint8))


def by_offset(lab: Lab, value: Callable[[Body, Body], float]) -> npt.NDArray[np.int64]:
    """A whole number for each robot and human, of which only their places to each other matter: (cells, humans).

    A human is its cell times 8 plus its heading; `value` is asked once for each offset and heading.
    """
    southmost, eastmost = lab.rows - 1, lab.cols - 1
    found = np.empty((2 * southmost + 1, 2 * eastmost + 1, N_DIRECTIONS), np.int64)
    for south in range(-southmost, southmost + 1):
        for east in range(-eastmost, eastmost + 1):
            robot, human = Body(max(south, 0), max(east, 0), 0), Body(max(-south, 0), max(-east, 0), 0)
            for heading in range(N_DIRECTIONS):
                found[south + southmost, east + eastmost, heading] = value(robot, human._replace(heading=heading))
    cells = lab.rows * lab.cols
    rows, cols = np.divmod(np.arange(cells), lab.cols)
    below, beside = rows[:, None] - rows, cols[:, None] - cols  # the robot's place less the human's
    values: npt.NDArray[np.int64] = found[below + southmost, beside + eastmost].reshape(cells, cells * N_DIRECTIONS)
    return values


def scene_of(task: GoToHuman, robot: Body, human: Body) -> Scene:
    """How a trial with these two begins."""
    return first_scene(task.lab, task.geometry, NOWHERE, robot, human)


@cache
def go_to_human_optimum(
    trial_steps: int, success: str = "facing", distances: Sequence[int] = DISTANCES, lab: Lab | None = None
) -> float:
    """The largest expected sum of rewards in a trial; it begins as the task's trials do."""
    return _mean(optimal_sums(_with_humans(success, distances, lab), trial_steps), lab)


@cache
def go_to_human_random(
    trial_steps: int, success: str = "facing", distances: Sequence[int] = DISTANCES, lab: Lab | None = None
) -> float:
    """The expected sum of rewards of uniformly random actions in a trial."""
    return _mean(random_sums(_with_humans(success, distances, lab), trial_steps), lab)


def _with_humans(success: str, distances: Sequence[int], lab: Lab | None) -> Motion:
    """The motion with the humans that a trial may begin with."""
    motion, starts = go_to_human_motion(success, distances, lab), starts_of(lab or paper_lab())
    humans = (starts[:, None] * N_DIRECTIONS + np.arange(N_DIRECTIONS)).ravel()
    return motion if len(humans) == motion.reward.shape[1] else motion._replace(reward=motion.reward[:, humans])


def _mean(values: npt.NDArray[Any], lab: Lab | None) -> float:
    """Over the cells in which the robot may begin."""
    return float(values[starts_of(lab or paper_lab())].mean())
