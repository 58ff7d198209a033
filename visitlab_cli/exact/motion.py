"""Exact values where only the robot moves, and its moves are certain: sums over a trial, and discounted values.

A world is two tables: `after[cell, action]`, where an action ends, and `reward[cell, context]`, what a step that
ends in a cell earns. A context is all that stays as it is during a trial: a goal room, a human who stands still.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Table = npt.NDArray[np.float64]
PRECISION = 1e-10
"""Largest error of a discounted value."""


class Motion(NamedTuple):
    """`after` has shape (cells, actions), `reward` (cells, contexts), of 0 and 1."""

    after: npt.NDArray[np.int64]
    reward: npt.NDArray[np.uint8]


def optimal_sums(motion: Motion, steps: int) -> npt.NDArray[np.unsignedinteger]:
    """The largest sum of rewards in `steps` steps from each cell: shape (cells, contexts), whole numbers.

    Backward induction: V_0 = 0, V_k(c) = max_a (r + V_{k-1})(after(c, a)), the policy of the finite horizon.
    """
    values = np.zeros(motion.reward.shape, np.min_scalar_type(steps))
    for _ in range(steps):
        ending_in = values + motion.reward
        values = ending_in[motion.after[:, 0]]
        for ends in motion.after.T[1:]:
            np.maximum(values, ending_in[ends], out=values)
    return values


def random_sums(motion: Motion, steps: int) -> Table:
    """The expected sum of rewards of uniformly random actions from each cell, over all contexts: shape (cells,)."""
    mean_reward = motion.reward.mean(axis=1)
    values = np.zeros(len(mean_reward))
    for _ in range(steps):
        values = (mean_reward + values)[motion.after].mean(axis=1)
    return values


def optimal_q(motion: Motion, gamma: float) -> Table:
    """The optimal discounted Q of each context, cell and action, within `PRECISION`: (contexts, cells, actions).

    Value iteration; after a change of at most d no value is farther than d gamma / (1 - gamma) from the exact one.
    """
    reward = motion.reward.T.astype(np.float64)
    values = np.zeros_like(reward)
    while True:
        q = (reward + gamma * values)[:, motion.after]
        change = np.abs(q.max(axis=2) - values).max()
        values = q.max(axis=2)
        if change * gamma <= PRECISION * (1 - gamma):
            return q


def random_discounted(motion: Motion, gamma: float) -> Table:
    """The discounted value of uniformly random actions: (contexts, cells); V = (I - gamma P)^-1 P r."""
    cells, actions = motion.after.shape
    transition = np.zeros((cells, cells))
    np.add.at(transition, (np.arange(cells)[:, None], motion.after), 1 / actions)
    expected = transition @ motion.reward
    values = np.linalg.solve(np.eye(cells) - gamma * transition, expected)
    return np.asarray(values.T, np.float64)
