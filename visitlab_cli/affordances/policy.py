"""Where a social module would go and what it would do around the human: a polar map of its best actions.

The eight desired directions are turned onto one another: directions are told against the desired one, in eighths
of a circle, counter-clockwise. A situation is a level, a distance and where the robot stands as seen from the human.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.enums import N_DIRECTIONS, N_DISTANCES, N_LEVELS, N_MOVES, N_SOCIAL_ACTIONS
from visitlab_cli.world.social import Ints, parts_of

UNSEEN = -1


class PolicyMap(NamedTuple):
    """Arrays of shape (levels, distances, bearings); bearing 0: the robot stands ahead, in the desired direction.

    `action` is the best one, a move's direction again against the desired one; `UNSEEN` in a situation that the
    module never was in. `share` is how much of its visits to the situation, over the eight desired directions, the
    best action is the greedy one in; `visits` counts them; `value` is the mean of max Q over them (nan if unseen).
    """

    action: Ints
    share: npt.NDArray[np.float64]
    visits: Ints
    value: npt.NDArray[np.float64]


def policy_map(q: npt.NDArray[np.float64], tried: npt.NDArray[np.integer]) -> PolicyMap:
    """The map of a social module's values and of how often it tried each action, both of shape (states, actions).

    Exact ties share a state's vote, visits are the weights.
    """
    visits = tried.sum(axis=1).astype(np.int64)
    state = parts_of(np.arange(len(q)))
    bearing = (state.angle + N_DIRECTIONS // 2 - state.desired_direction) % N_DIRECTIONS
    shape = N_LEVELS, N_DISTANCES, N_DIRECTIONS
    situation = np.ravel_multi_index((state.level, state.distance, bearing), shape)
    actions = np.arange(N_SOCIAL_ACTIONS)
    # action `turned[s, a]` of the map is action a in state s
    turned = (actions - state.desired_direction[:, None]) % N_DIRECTIONS + actions // N_DIRECTIONS * N_DIRECTIONS
    turned = np.where(actions < N_MOVES, turned, actions)
    best = q == q.max(axis=1, keepdims=True)
    votes = np.zeros((np.prod(shape), N_SOCIAL_ACTIONS))
    np.add.at(votes, (situation[:, None], turned), best / best.sum(axis=1, keepdims=True) * visits[:, None])
    total = np.bincount(situation, visits, len(votes))
    seen = total > 0
    share, value = np.full(len(votes), np.nan), np.full(len(votes), np.nan)
    np.divide(votes.max(axis=1), total, out=share, where=seen)
    np.divide(np.bincount(situation, visits * q.max(axis=1), len(votes)), total, out=value, where=seen)
    action = np.where(seen, votes.argmax(axis=1), UNSEEN)
    return PolicyMap(
        action.reshape(shape), share.reshape(shape), total.astype(np.int64).reshape(shape), value.reshape(shape)
    )
