"""An agent on a table: where each pair of state and action leads, and what it brings."""

from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import choose, learn
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState


@kernel
def play_table(
    agent: Any,
    state: int,
    first: int,
    next_states: npt.NDArray[np.int64],
    rewards: npt.NDArray[np.float64],
    trial_steps: int,
    random: RandomState,
    actions: npt.NDArray[np.int64],
) -> int:
    """Play as many steps as there are `actions`, which are filled, from `state` and the agent's step `first` on.

    The tables have shape (states, actions); a trial ends each `trial_steps`, and the world stays as it is. The state
    in the end; -1 after an action that there is not.
    """
    for index in range(len(actions)):
        step = first + index
        action, _ = choose(agent, state, step, random)
        actions[index] = action
        if action < 0 or action >= rewards.shape[1]:
            return -1
        next_state = next_states[state, action]
        learn(agent, state, action, rewards[state, action], next_state, step % trial_steps == 0, step, random)
        state = next_state
    return state
