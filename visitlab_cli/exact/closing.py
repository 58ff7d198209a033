"""What a door that closes costs navigation, exactly: which starts are affected, and what a policy reaches then."""

from functools import cache

import numpy as np
import numpy.typing as npt

from visitlab_cli.exact.motion import Motion, Table, optimal_sums
from visitlab_cli.exact.navigation import navigation_motion
from visitlab_cli.world.lab import Lab, goals_of, starts_of


@cache
def affected_starts(before: Lab, after: Lab, trial_steps: int) -> npt.NDArray[np.bool_]:
    """Where a trial may begin from which less can be reached than before: shape (cells, rooms).

    Args:
        before: the lab as it was.
        after: the same cells with other doors.
        trial_steps: steps in a trial.
    """
    falls = optimal_sums(navigation_motion(before), trial_steps) > optimal_sums(navigation_motion(after), trial_steps)
    begins = np.zeros_like(falls)
    begins[np.ix_(starts_of(after), np.array(goals_of(after)))] = True
    affected: npt.NDArray[np.bool_] = falls & begins
    return affected


def optimum_from(lab: Lab, starts: npt.NDArray[np.bool_], trial_steps: int) -> float:
    """The best sum of rewards in a trial, a mean over some `starts`, shape (cells, rooms)."""
    return float(optimal_sums(navigation_motion(lab), trial_steps)[starts].mean())


def reward_from(lab: Lab, starts: npt.NDArray[np.bool_], trial_steps: int, q: Table, epsilon: float) -> float:
    """The expected sum of rewards of an epsilon-greedy policy in a trial, a mean over some starts.

    Args:
        lab: where it acts.
        starts: shape (cells, rooms).
        trial_steps: steps in a trial.
        q: by which it is greedy, ties at random: shape (rooms * cells, 25).
        epsilon: how likely it is to act at random.
    """
    return float(policy_sums(navigation_motion(lab), greedy_policy(q, epsilon), trial_steps)[starts].mean())


def greedy_policy(q: Table, epsilon: float) -> Table:
    """The probability of each action: as `q`."""
    best = q == q.max(axis=1, keepdims=True)
    policy: Table = (1 - epsilon) * best / best.sum(axis=1, keepdims=True) + epsilon / q.shape[1]
    return policy


def policy_sums(motion: Motion, policy: Table, steps: int) -> Table:
    """The expected sum of rewards of a policy, shape (rooms * cells, actions), from each cell: (cells, rooms)."""
    cells, rooms = motion.reward.shape
    chances = policy.reshape(rooms, cells, -1).transpose(1, 2, 0)  # (cells, actions, rooms)
    values = np.zeros((cells, rooms))
    for _ in range(steps):
        values = ((values + motion.reward)[motion.after] * chances).sum(axis=1)
    return values
