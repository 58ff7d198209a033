"""Dyna: at each step the pair just tried is updated, and others, drawn among those ever tried, by the learned model.

Sutton (1990). An update is expected, over all that the model knows of a pair, or sampled, as a step of Q-learning.
"""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, counts
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as, maximum
from visitlab_cli.agents.known_values import (
    Known,
    KnownValuesParameters,
    expected,
    fill_untried,
    no_values,
    revalue,
    saved_values,
    untried,
)
from visitlab_cli.agents.sparse_model import Ints, SparseModel, count, empty_model, restored_model
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class Dyna(NamedTuple):
    """`q` has shape (states, actions); `tried` the pairs that were, in the order of their first trial, so many `n`."""

    q: Table
    model: SparseModel
    known: Known
    tried: Ints
    n: Ints  # shape (1,)
    gamma: float
    epsilon: float
    alpha: float
    backups: int
    sampled: bool


class DynaParameters(KnownValuesParameters):
    """Epsilon-greedy, with `backups` values updated at each step: the pair just tried, and pairs drawn at random."""

    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 1, GO_TO_HUMAN: 0.72, SOCIAL: 1.3, VISIT: 1.4}
    kind: Literal["dyna"]
    backups: int = Field(default=10, ge=1, le=10**6, description="values that are updated at each step")
    updates: Literal["expected", "sampled"] = Field(
        default="expected", description="by all that is known of a pair, or by one of its outcomes, as Q-learning does"
    )
    alpha: float = Field(default=0.1, gt=0, le=1, description="learning rate of sampled updates")

    def _create(self, setting: Setting) -> Dyna:
        """Q of zeros and an empty model."""
        tried = np.zeros(setting.n_states * setting.n_actions, np.int64)
        return self._record(zeros(setting), empty_model(setting), no_values(setting), tried, 0)

    def _restore(self, setting: Setting, saved: Saved) -> Dyna:
        """Go on with a saved model and its values."""
        pairs = saved["tried"]
        tried = np.zeros(saved["visits"].size, np.int64)
        tried[: len(pairs)] = pairs
        return self._record(saved["q"].copy(), restored_model(setting, saved), saved_values(saved), tried, len(pairs))

    def _save(self, record: Dyna) -> Saved:
        """Also the pairs that were tried, in the order of their first trial."""
        return {**super()._save(record), "tried": record.tried[: record.n[0]]}

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """Also those pairs."""
        pairs = setting.n_states * setting.n_actions
        return {**super().arrays(setting), "tried": counts(None, high=pairs - 1, dtype="<i8")}

    def _fault(self, saved: Saved) -> str | None:
        """Also whether they are those that were."""
        tried = np.array_equal(np.sort(saved["tried"]), np.flatnonzero(saved["visits"]))
        return super()._fault(saved) or (None if tried else "tried are not the pairs with visits")

    def updates_a_step(self, setting: Setting, saved: Saved) -> float:
        """As many as it is told."""
        return float(self.backups)

    def _record(self, q: Table, model: SparseModel, known: Known, tried: Ints, n: int) -> Dyna:
        numbers = float(self.gamma), float(self.epsilon), float(self.alpha), self.backups, self.updates == "sampled"
        return Dyna(q, model, known, tried, np.array([n], np.int64), *numbers)


@kernel
def update(agent: Dyna, pair: int, sampled: bool, reward: float, next_state: int) -> None:
    """Update one pair: sampled by this reward and next state, or expected."""
    n_actions = agent.q.shape[1]
    state, action = pair // n_actions, pair % n_actions
    u = untried(agent.known, agent.gamma)
    if sampled:
        target = reward + agent.gamma * max(agent.known.values[next_state], u)
        agent.q[state, action] += agent.alpha * (target - agent.q[state, action])
    else:
        agent.q[state, action] = expected(agent.model, agent.known, pair, u, agent.gamma)
    fill_untried(agent.q, agent.model, state, u)
    revalue(agent.known, state, maximum(agent.q[state]))


@kernel
def drawn_successor(model: SparseModel, pair: int, random: RandomState) -> int:
    """One of the states that followed `pair`, as often as it did."""
    left, place = random_below(random, model.visits[pair]), model.first[pair]
    while left >= model.pool_counts[place]:
        left -= model.pool_counts[place]
        place += 1
    return int(model.pool_states[place])


@CHOOSE.of(Dyna)
def choose(agent: Dyna, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy."""
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@CHOOSE_AS.of(Dyna)
def choose_as(
    agent: Dyna, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.q[state], meant, agent.epsilon, random)


@LEARN.of(Dyna)
def learn(
    agent: Dyna,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Count the transition; update its pair, then pairs drawn uniformly among those that were tried."""
    pair = state * agent.q.shape[1] + action
    if agent.model.visits[pair] == 0:
        agent.tried[agent.n[0]] = pair
        agent.n[0] += 1
    count(agent.model, pair, reward, next_state)
    update(agent, pair, agent.sampled, reward, next_state)
    for _ in range(agent.backups - 1):
        pair = agent.tried[random_below(random, agent.n[0])]
        following = drawn_successor(agent.model, pair, random) if agent.sampled else 0
        update(agent, pair, agent.sampled, agent.model.mean_rewards[pair], following)
