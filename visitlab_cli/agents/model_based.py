"""Epsilon-greedy value iteration, the paper's model-based agent: a learned model, swept every `plan_every` steps."""

from collections.abc import Mapping, Sequence
from typing import ClassVar, Literal, NamedTuple, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, PrivateAttr, model_validator

from visitlab_cli.agents.base import (
    CHOOSE,
    CHOOSE_AS,
    EPSILON,
    GAMMA,
    LEARN,
    PLAN_EVERY,
    Saved,
    Setting,
    zeros,
)
from visitlab_cli.agents.declared import LARGEST
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as
from visitlab_cli.agents.one_model import OneModelParameters
from visitlab_cli.agents.sparse_model import (
    SparseModel,
    cap,
    count,
    empty_model,
    pooled_models,
    restored_model,
    sweep,
)
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


SWEEPS_OF_A_POOL = 40
"""That many sweeps of a model that was put together make its values."""


class ModelBasedParameters(OneModelParameters):
    """Epsilon-greedy value iteration (paper, section 4.2)."""

    pools: ClassVar[bool] = True
    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 2.5, GO_TO_HUMAN: 1.3, SOCIAL: 5.3, VISIT: 22.0}
    kind: Literal["model_based"]
    gamma: float = GAMMA
    epsilon: float = EPSILON
    plan_every: int = PLAN_EVERY
    unvisited: Literal["uniform", "zero"] = Field(
        default="uniform",
        description="the model of a pair never tried: no reward and any state next, or a value of zero",
    )

    prior_strength: float | None = Field(
        default=None,
        ge=1,
        le=LARGEST,
        description="as how many visits to a pair what is known of it counts, at most, when another human comes: at a "
        "visit's start, and where phases change the human; null: as many as there were",
        json_schema_extra=since("0.2.0"),
    )
    _from_a_pool: bool = PrivateAttr(default=False)

    @model_validator(mode="after")
    def _symmetric_zero(self) -> Self:
        if self.symmetric and self.unvisited == "uniform":
            raise ValueError("symmetric goes with unvisited: zero only; uniform is over states of which it has no rows")
        return self

    def _create(self, setting: Setting) -> ModelBased:
        """Q of zeros and an empty model."""
        return self._record(zeros(setting), empty_model(setting, np.float64 if self.weighted else np.int32))

    def _restore(self, setting: Setting, saved: Saved) -> ModelBased:
        """Go on with a saved model."""
        return self._record(saved["q"].copy(), restored_model(setting, saved))

    @property
    def weighted(self) -> bool:
        """Where counts are scaled."""
        return self.prior_strength is not None or self._from_a_pool

    def taking_in_a_pool(self) -> Self:
        """Its counts will be weighted."""
        taking = self.model_copy()
        taking._from_a_pool = True
        return taking

    def pooled(self, setting: Setting, several: Sequence[Saved], strength: float) -> Saved:
        """Their models as one, the mean of their values, swept until they fit the model."""
        mean: Table = np.mean([each["q"] for each in several], axis=0)
        record = self.restore(setting, {"q": mean, **pooled_models(several, strength)})
        inner: ModelBased = self.learning(record)
        for _ in range(SWEEPS_OF_A_POOL):
            sweep(inner.model, inner.q, inner.values, inner.gamma, 1, inner.fill_unvisited)
        return self.save(record)

    def _meet(self, record: ModelBased, human: int) -> None:
        """What is known counts less."""
        if self.prior_strength is not None:
            cap(record.model, self.prior_strength)

    def updates_a_step(self, setting: Setting, saved: Saved) -> float:
        """All pairs in a sweep, or those that were tried."""
        pairs = np.size(saved["visits"]) if self.unvisited == "uniform" else np.count_nonzero(saved["visits"])
        return float(pairs) / self.plan_every

    def _record(self, q: Table, model: SparseModel) -> ModelBased:
        gamma, epsilon = float(self.gamma), float(self.epsilon)
        fill = self.unvisited == "uniform"
        return ModelBased(q, np.zeros(len(q)), model, gamma, epsilon, self.plan_every, fill)


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
