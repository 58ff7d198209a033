"""Q-learning, the paper's model-free agent: Q <- Q + alpha (r + gamma max_a' Q(s', a') - Q), epsilon-greedy."""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, EPSILON, GAMMA, LEARN, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, counts, floats
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as, maximum
from visitlab_cli.agents.sparse_model import Counts
from visitlab_cli.agents.tabular import TabularParameters
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class QLearning(NamedTuple):
    """`q` and `visits` have shape (states, actions)."""

    q: Table
    visits: Counts
    gamma: float
    epsilon: float
    alpha: float


class QLearningParameters(TabularParameters):
    """Tabular Q-learning (paper, section 4.2)."""

    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {
        NAVIGATION: 0.28,
        GO_TO_HUMAN: 0.28,
        SOCIAL: 0.39,
        VISIT: 0.35,
    }
    kind: Literal["q_learning"]
    gamma: float = GAMMA
    epsilon: float = EPSILON
    alpha: float = Field(default=0.5, gt=0, le=1, description="learning rate")

    def _create(self, setting: Setting) -> QLearning:
        """A table of zeros."""
        return self.with_table(zeros(setting), np.zeros((setting.n_states, setting.n_actions), np.int32))

    def _restore(self, setting: Setting, saved: Saved) -> QLearning:
        """Go on with a saved table."""
        return self.with_table(saved["q"].copy(), saved["visits"].copy())

    def with_table(self, q: Table, visits: Counts) -> QLearning:
        """These parameters acting on a given table, which is shared, not copied."""
        return QLearning(q, visits, float(self.gamma), float(self.epsilon), float(self.alpha))

    def _save(self, record: QLearning) -> Saved:
        """The table and how often each pair was updated."""
        return {"q": record.q, "visits": record.visits}

    def updates_a_step(self, setting: Setting, saved: Saved) -> float:
        """The pair that was tried."""
        return 1.0

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """The table and the counts."""
        return {"q": floats(setting.n_states, setting.n_actions), "visits": counts(setting.n_states, setting.n_actions)}


@CHOOSE.of(QLearning)
def choose(agent: QLearning, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy."""
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@CHOOSE_AS.of(QLearning)
def choose_as(
    agent: QLearning, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.q[state], meant, agent.epsilon, random)


@LEARN.of(QLearning)
def learn(
    agent: QLearning,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """One temporal-difference update; a trial's end does not cut the bootstrap."""
    target = reward + agent.gamma * maximum(agent.q[next_state])
    agent.q[state, action] += agent.alpha * (target - agent.q[state, action])
    agent.visits[state, action] += 1
