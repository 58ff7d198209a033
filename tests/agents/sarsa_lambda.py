"""SARSA(lambda) as a kind of agent in one file: on-policy, with traces that end with a trial.

Written as whoever adds a kind would write it; `test_sarsa_lambda.py` plays it beside a plain second computation.
"""

from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, EPSILON, GAMMA, LEARN, AgentParameters, Saved, Setting, zeros
from visitlab_cli.agents.exploration import Table, epsilon_greedy
from visitlab_cli.random_numbers import RandomState

NONE = -1


class SarsaLambda(NamedTuple):
    """`q` and `traces` have shape (states, actions); `following`, shape (1,), is the action drawn ahead, or `NONE`."""

    q: Table
    traces: Table
    following: npt.NDArray[np.int64]
    gamma: float
    epsilon: float
    alpha: float
    decay: float


class SarsaLambdaParameters(AgentParameters):
    """Sutton and Barto (2018), section 12.7, with a table."""

    kind: Literal["sarsa_lambda"]
    gamma: float = GAMMA
    epsilon: float = EPSILON
    alpha: float = Field(default=0.5, gt=0, le=1, description="learning rate")
    lambda_: float = Field(default=0.9, ge=0, le=1, alias="lambda", description="what a trace keeps at a step")

    def create(self, setting: Setting) -> SarsaLambda:
        """Zeros, and nothing drawn ahead."""
        return self._record(zeros(setting))

    def restore(self, setting: Setting, saved: Saved) -> SarsaLambda:
        """Go on with a saved table at a trial's start."""
        return self._record(saved["q"].copy())

    def _record(self, q: Table) -> SarsaLambda:
        numbers = (float(each) for each in (self.gamma, self.epsilon, self.alpha, self.gamma * self.lambda_))
        return SarsaLambda(q, np.zeros_like(q), np.array([NONE]), *numbers)

    def save(self, record: SarsaLambda) -> Saved:
        """The table."""
        return {"q": record.q}


@CHOOSE.of(SarsaLambda)
def choose(agent: SarsaLambda, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """The action drawn while learning; a trial's first is drawn here."""
    if agent.following[0] != NONE:
        return agent.following[0], False
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@LEARN.of(SarsaLambda)
def learn(
    agent: SarsaLambda,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Draw the next action, bootstrap from it, and spread the error over what led here."""
    following = epsilon_greedy(agent.q[next_state], agent.epsilon, random)[0]
    error = reward + agent.gamma * agent.q[next_state, following] - agent.q[state, action]
    agent.traces[state, action] += 1.0
    agent.q[:] += agent.alpha * error * agent.traces
    agent.traces[:] *= agent.decay
    agent.following[0] = following
    if end:  # the next trial begins elsewhere
        agent.following[0] = NONE
        agent.traces[:] = 0.0
