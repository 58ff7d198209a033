"""Model-based that forgets: at each outcome of a pair, what it counted of that pair before fades by 1 - 1/k."""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, Saved, Setting, zeros
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as
from visitlab_cli.agents.sparse_model import SparseModel, cap, count, empty_model, restored_model, sweep
from visitlab_cli.agents.swept import SweptParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT

FORGOTTEN = 1e-12
"""A successor whose count has faded below this leaves its row."""


class Forgetting(NamedTuple):
    """`q` has shape (states, actions), `values` (states,); `model` counts in floats, of which `kept` stays."""

    q: Table
    values: Table
    model: SparseModel
    kept: float
    gamma: float
    epsilon: float
    plan_every: int
    fill_unvisited: bool


class ForgettingParameters(SweptParameters):
    """As model_based, but what was counted of a pair fades with each of its outcomes; n(s, a) stays below `k`."""

    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 0.58, GO_TO_HUMAN: 0.32, SOCIAL: 0.78, VISIT: 2.9}
    kind: Literal["forgetting"]
    k: int = Field(
        default=50, ge=1, le=10**6, description="outcomes that it remembers, about: counts fade by 1 - 1/k at each"
    )

    def _create(self, setting: Setting) -> Forgetting:
        """Q of zeros and an empty model."""
        return self._record(zeros(setting), empty_model(setting, np.float64))

    def _restore(self, setting: Setting, saved: Saved) -> Forgetting:
        """Go on with a saved model, in which no pair counts more than `k`."""
        model = restored_model(setting, saved)
        cap(model, self.k)
        return self._record(saved["q"].copy(), model)

    @property
    def weighted(self) -> bool:
        """What fades is no whole number."""
        return True

    def _record(self, q: Table, model: SparseModel) -> Forgetting:
        gamma, epsilon = float(self.gamma), float(self.epsilon)
        kept = 1.0 - 1.0 / self.k
        return Forgetting(q, np.zeros(len(q)), model, kept, gamma, epsilon, self.plan_every, self.fills)


@kernel
def fade(model: SparseModel, pair: int, kept: float) -> None:
    """Scale what is counted of `pair`; R stays as it was until the pair is next counted."""
    model.visits[pair] *= kept
    model.reward_sums[pair] *= kept
    place, last = model.first[pair], model.first[pair] + model.length[pair] - 1
    while place <= last:
        model.pool_counts[place] *= kept
        if model.pool_counts[place] < FORGOTTEN:
            model.pool_states[place] = model.pool_states[last]
            model.pool_counts[place] = model.pool_counts[last]
            last -= 1
        else:
            place += 1
    model.length[pair] = last + 1 - model.first[pair]


@CHOOSE.of(Forgetting)
def choose(agent: Forgetting, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy."""
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@CHOOSE_AS.of(Forgetting)
def choose_as(
    agent: Forgetting, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.q[state], meant, agent.epsilon, random)


@LEARN.of(Forgetting)
def learn(
    agent: Forgetting,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Let the pair's counts fade and count the transition; sweep at every `plan_every`-th step."""
    pair = state * agent.q.shape[1] + action
    fade(agent.model, pair, agent.kept)
    count(agent.model, pair, reward, next_state)
    if step % agent.plan_every == 0:
        sweep(agent.model, agent.q, agent.values, agent.gamma, 1, agent.fill_unvisited)
