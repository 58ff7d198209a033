"""Q-learning in plain Python, as a user would write it in a file of their own."""

from typing import Literal

import numpy as np
from pydantic import Field

from visitlab_cli.agents.base import AgentParameters


class PlainQParameters(AgentParameters):
    """Tabular Q-learning; `wrong_at` is a step at which it answers nonsense."""

    kind: Literal["plain_q"]
    alpha: float = Field(default=0.5, gt=0, le=1, description="learning rate")
    wrong_at: int = Field(default=-1, description="a step at which it fails; none where negative")

    def agent(self, setting):
        return PlainQ(self, setting)


class PlainQ:
    def __init__(self, parameters, setting):
        self.alpha, self.wrong_at = parameters.alpha, parameters.wrong_at
        self.q = np.zeros((setting.n_states, setting.n_actions))

    def act(self, state, random, step):
        if step == self.wrong_at:
            return self.q.shape[1]
        if random.random() < 0.05:
            return int(random.integers(self.q.shape[1])), True
        return self.greedy(state)

    def greedy(self, state):
        return int(self.q[state].argmax())

    def learn(self, state, action, reward, next_state, end, random, step):
        self.q[state, action] += self.alpha * (reward + 0.9 * self.q[next_state].max() - self.q[state, action])

    def values(self):
        return self.q

    def arrays(self):
        return {"q": self.q}

    def restore(self, arrays):
        self.q = arrays["q"]
