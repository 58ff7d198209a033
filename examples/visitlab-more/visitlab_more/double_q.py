"""Double Q-learning (van Hasselt, 2010): two tables, each of which judges what the other one would choose."""

from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli import CHOOSE, LEARN, AgentParameters
from visitlab_cli.random_numbers import happens, random_below

Table = npt.NDArray[np.float64]


class DoubleQ(NamedTuple):
    """`q` and `other` have shape (states, actions)."""

    q: Table
    other: Table
    alpha: float
    gamma: float
    epsilon: float


class DoubleQParameters(AgentParameters):
    """Epsilon-greedy in the sum of both tables."""

    kind: Literal["double_q"]
    alpha: float = Field(default=0.5, gt=0, le=1, description="learning rate")
    gamma: float = Field(default=0.9, ge=0, lt=1, description="discount factor")
    epsilon: float = Field(default=0.05, ge=0, le=1, description="probability of a random action")

    def create(self, setting):
        """Two tables of zeros."""
        shape = setting.n_states, setting.n_actions
        return DoubleQ(np.zeros(shape), np.zeros(shape), float(self.alpha), float(self.gamma), float(self.epsilon))

    def restore(self, setting, saved):
        """Go on with saved tables."""
        new = self.create(setting)
        return new._replace(q=saved["first"].copy(), other=saved["second"].copy())

    def save(self, record):
        """Both tables, and their mean, which is what it believes."""
        return {"q": (record.q + record.other) / 2, "first": record.q, "second": record.other}


@CHOOSE.of(DoubleQ)
def choose(agent, state, step, random):
    """The best by both tables, one of the best at random."""
    n_actions = agent.q.shape[1]
    if happens(random, agent.epsilon):
        return random_below(random, n_actions), True
    best, found, count = -np.inf, 0, 0
    for action in range(n_actions):
        value = agent.q[state, action] + agent.other[state, action]
        if value > best:
            best, found, count = value, action, 1
        elif value == best:
            count += 1
            if random_below(random, count) == 0:
                found = action
    return found, False


@LEARN.of(DoubleQ)
def learn(agent, state, action, reward, next_state, end, step, random):
    """One of the tables learns, by a coin, from what the other says of its own choice."""
    ours, theirs = agent.q, agent.other
    if happens(random, 0.5):
        ours, theirs = agent.other, agent.q
    chosen = 0
    for candidate in range(1, ours.shape[1]):
        if ours[next_state, candidate] > ours[next_state, chosen]:
            chosen = candidate
    ours[state, action] += agent.alpha * (reward + agent.gamma * theirs[next_state, chosen] - ours[state, action])
