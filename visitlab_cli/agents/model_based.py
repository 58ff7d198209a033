"""Epsilon-greedy value iteration, the paper's model-based agent: a learned model, swept every `plan_every` steps."""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import (
    CHOOSE,
    CHOOSE_AS,
    LEARN,
    Saved,
    Setting,
    zeros,
)
from visitlab_cli.agents.declared import LARGEST
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as
from visitlab_cli.agents.sparse_model import (
    SparseModel,
    cap,
    count,
    empty_model,
    restored_model,
    sweep,
)
from visitlab_cli.agents.swept import SweptParameters
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.settings import since
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class ModelBased(NamedTuple):
    """`q` has shape (states, actions), `values` (states,)."""

    q: Table
    values: Table
    model: SparseModel
    gamma: float
    epsilon: float
    plan_every: int
    fill_unvisited: bool


class ModelBasedParameters(SweptParameters):
    """Epsilon-greedy value iteration (paper, section 4.2)."""

    pools: ClassVar[bool] = True
    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 2.5, GO_TO_HUMAN: 1.3, SOCIAL: 5.3, VISIT: 22.0}
    kind: Literal["model_based"]
    prior_strength: float | None = Field(
        default=None,
        ge=1,
        le=LARGEST,
        description="as how many visits to a pair what is known of it counts, at most, when another human comes: at a "
        "visit's start, and where phases change the human; null: as many as there were",
        json_schema_extra=since("0.2.0"),
    )

    def _create(self, setting: Setting) -> ModelBased:
        """Q of zeros and an empty model."""
        return self._record(zeros(setting), empty_model(setting, np.float64 if self.weighted else np.int32))

    def _restore(self, setting: Setting, saved: Saved) -> ModelBased:
        """Go on with a saved model."""
        return self._record(saved["q"].copy(), restored_model(setting, saved))

    @property
    def weighted(self) -> bool:
        """Also where it scales counts itself."""
        return super().weighted or self.prior_strength is not None

    def _meet(self, record: ModelBased, human: int) -> None:
        """What is known counts less."""
        if self.prior_strength is not None:
            cap(record.model, self.prior_strength)

    def _record(self, q: Table, model: SparseModel) -> ModelBased:
        gamma, epsilon = float(self.gamma), float(self.epsilon)
        return ModelBased(q, np.zeros(len(q)), model, gamma, epsilon, self.plan_every, self.fills)


@CHOOSE.of(ModelBased)
def choose(agent: ModelBased, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy."""
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@CHOOSE_AS.of(ModelBased)
def choose_as(
    agent: ModelBased, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.q[state], meant, agent.epsilon, random)


@LEARN.of(ModelBased)
def learn(
    agent: ModelBased,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Count the transition; sweep at every `plan_every`-th step."""
    count(agent.model, state * agent.q.shape[1] + action, reward, next_state)
    if step % agent.plan_every == 0:
        sweep(agent.model, agent.q, agent.values, agent.gamma, 1, agent.fill_unvisited)
