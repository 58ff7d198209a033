"""The known motion as a model of what an agent observes: where each state and action leads, and what it brings.

In navigation the state says all, so one state follows. In go_to_human cells are hidden: the model is the mean over all
cells and headings, drawn uniformly as a trial begins; what a state's past tells of the cells it leaves out.
"""

from collections.abc import Sequence
from functools import cache
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from visitlab_cli.exact.go_to_human import by_offset, go_to_human_motion, scene_of
from visitlab_cli.exact.motion import PRECISION, Table
from visitlab_cli.exact.navigation import navigation_motion
from visitlab_cli.world.enums import N_DIRECTIONS, N_PHYSICAL_ACTIONS
from visitlab_cli.world.geometry import DISTANCES, TOO_FAR
from visitlab_cli.world.go_to_human import GoToHuman, go_to_human_state, make_go_to_human
from visitlab_cli.world.lab import Lab, make_lab, paper_lab, starts_of
from visitlab_cli.world.sight import Walls
from visitlab_cli.world.tasks import GO_TO_HUMAN, TASKS

Number = TypeVar("Number", np.int64, np.float64)


class Known(NamedTuple):
    """A model whose moves are certain: `P[s, a]` is the next state, `R[s, a]` the reward, shapes (states, actions)."""

    P: npt.NDArray[np.int64]
    R: Table


class Expected(NamedTuple):
    """`P[s, a, s']` is a probability, shape (states, actions, states); `R[s, a]` the expected reward."""

    P: Table
    R: Table


@cache
def navigation_model(lab: Lab | None = None) -> Known:
    """Of `navigation` in `lab`, the paper's unless given; states as the task numbers them, 5184 in the paper's lab."""
    motion = navigation_motion(lab)
    cells, rooms = motion.reward.shape
    P = np.arange(rooms)[:, None, None] * cells + motion.after
    R = motion.reward.T[:, motion.after].astype(np.float64)
    return Known(_shared(P.reshape(rooms * cells, -1)), _shared(R.reshape(rooms * cells, -1)))


@cache
def go_to_human_model(
    success: str = "facing", distances: Sequence[int] = DISTANCES, lab: Lab | None = None
) -> Expected:
    """Of `go_to_human` in `lab`, the paper's unless given, on its 320 states; what is behind a wall is too far."""
    lab = lab or paper_lab()
    motion = go_to_human_motion(success, distances, lab)
    task, size = make_go_to_human(success=success, distances=distances, lab=lab), TASKS[GO_TO_HUMAN].size(lab)
    states = _states(task, lab)
    P = np.zeros((size.n_states, size.n_actions, size.n_states))
    R = np.zeros((size.n_states, size.n_actions))
    starts = starts_of(lab)
    humans = (starts[:, None] * N_DIRECTIONS + np.arange(N_DIRECTIONS)).ravel()
    begun = states[np.ix_(starts, humans)].ravel()
    often = np.bincount(begun, minlength=size.n_states)
    for action in range(N_PHYSICAL_ACTIONS):
        ends = np.ix_(motion.after[starts, action], humans)
        pairs = begun * size.n_states + states[ends].ravel()
        P[:, action] = np.bincount(pairs, minlength=size.n_states**2).reshape(size.n_states, -1)
        R[:, action] = np.bincount(begun, motion.reward[ends].ravel(), size.n_states)
    seen = np.maximum(often, 1)  # in a small lab some states never come about: nothing follows
    return Expected(_shared(P / seen[:, None, None]), _shared(R / seen[:, None]))


def _states(task: GoToHuman, lab: Lab) -> npt.NDArray[np.int64]:
    """The state of each robot and human: shape (cells, humans), a human being its cell times 8 plus its heading."""
    unwalled = task._replace(lab=make_lab(lab.rows, lab.cols))
    seen = by_offset(lab, lambda robot, human: go_to_human_state(scene_of(unwalled, robot, human)))
    if not isinstance(lab.walls, Walls):
        return seen
    hidden = by_offset(
        lab, lambda robot, human: go_to_human_state(scene_of(unwalled, robot, human)._replace(distance=TOO_FAR))
    )
    return np.where(np.repeat(lab.walls.visible, N_DIRECTIONS, axis=1), seen, hidden)


@cache
def go_to_human_mean_q(
    gamma: float, success: str = "facing", distances: Sequence[int] = DISTANCES, lab: Lab | None = None
) -> Table:
    """The optimal discounted Q of the mean model, shape (320, 25 actions): what a planner with endless practice has."""
    P, R = go_to_human_model(success, distances, lab)
    values = np.zeros(len(R))
    while True:
        q = R + gamma * (P @ values)
        change = np.abs(q.max(axis=1) - values).max()
        values = q.max(axis=1)
        if change * gamma <= PRECISION * (1 - gamma):
            return _shared(q)


def _shared(array: npt.NDArray[Number]) -> npt.NDArray[Number]:
    array.setflags(write=False)  # shared by all who ask
    return array
