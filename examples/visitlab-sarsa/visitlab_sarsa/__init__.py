"""SARSA(lambda) with replacing traces (Singh and Sutton, 1996), as an agent for visitlab in plain Python."""

from typing import Literal

import numpy as np
from pydantic import Field

from visitlab_cli import AgentParameters

FORGOTTEN = 1e-3
"""A trace below this is dropped."""


class SarsaParameters(AgentParameters):
    """On-policy, epsilon-greedy."""

    kind: Literal["sarsa_plain"]
    alpha: float = Field(default=0.2, gt=0, le=1, description="learning rate")
    gamma: float = Field(default=0.9, ge=0, lt=1, description="discount factor")
    epsilon: float = Field(default=0.05, ge=0, le=1, description="probability of a random action")
    lambda_: float = Field(
        default=0.8, ge=0, le=1, alias="lambda", description="what a trace keeps of itself at a step"
    )

    def agent(self, setting):
        """A table of zeros."""
        return Sarsa(self, setting)


class Sarsa:
    """The next action is drawn while learning, for it is part of what is learned from; then it is taken."""

    def __init__(self, parameters, setting):
        self.alpha, self.gamma, self.epsilon = parameters.alpha, parameters.gamma, parameters.epsilon
        self.decay = parameters.gamma * parameters.lambda_
        self.q = np.zeros((setting.n_states, setting.n_actions))
        self.traces = {}
        self.drawn = None

    def act(self, state, random, step):
        """The action that was drawn ahead; a trial's first is drawn now."""
        drawn, self.drawn = self.drawn, None
        return self._draw(state, random) if drawn is None else drawn

    def _draw(self, state, random):
        if random.random() < self.epsilon:
            return int(random.integers(self.q.shape[1])), True
        return self.greedy(state), False

    def greedy(self, state):
        """The first of the best."""
        return int(self.q[state].argmax())

    def learn(self, state, action, reward, next_state, end, random, step):
        """Bootstrap from the action that follows, at a trial's end from one that nobody takes."""
        following = self._draw(next_state, random)
        error = reward + self.gamma * self.q[next_state, following[0]] - self.q[state, action]
        self.traces[state, action] = 1.0
        for pair, trace in list(self.traces.items()):
            self.q[pair] += self.alpha * error * trace
            if trace * self.decay < FORGOTTEN:
                del self.traces[pair]
            else:
                self.traces[pair] = trace * self.decay
        self.drawn = None if end else following  # after an end `act` is asked about another trial
        if end:
            self.traces.clear()

    def values(self):
        """What it believes each action is worth."""
        return self.q

    def arrays(self):
        """The table: traces end with a trial, as every cell does."""
        return {"q": self.q}

    def restore(self, arrays):
        """Go on with a table."""
        self.q = arrays["q"]
