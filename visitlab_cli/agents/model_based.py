"""Epsilon-greedy value iteration, the paper's model-based agent: a learned model, swept every `plan_every` steps."""

from collections.abc import Mapping
from math import sqrt
from typing import Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, AgentParameters, Saved, Setting
from visitlab_cli.agents.declared import LARGEST
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as
from visitlab_cli.agents.sparse_model import SparseModel, cap, count, empty_model, sweep
from visitlab_cli.agents.swept import SweptParameters
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.settings import since
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class ModelBased(NamedTuple):
    """`q` has shape (states, actions), `values` (states,); with a `bonus` the model's R has it, too."""

    q: Table
    values: Table
    model: SparseModel
    gamma: float
    epsilon: float
    plan_every: int
    fill_unvisited: bool
    bonus: float = 0.0


class ModelBasedParameters(SweptParameters):
    """Epsilon-greedy value iteration (paper, section 4.2)."""

    pools: ClassVar[bool] = True
    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 0.64, GO_TO_HUMAN: 0.33, SOCIAL: 0.76, VISIT: 3.1}
    kind: Literal["model_based"]
    prior_strength: float | None = Field(
        default=None,
        ge=1,
        le=LARGEST,
        description="as how many visits to a pair what is known of it counts, at most, when another human comes: at a "
        "visit's start, and where phases change the human; null: as many as there were",
        json_schema_extra=since("0.2.0"),
    )
    exploration: Literal["epsilon", "optimistic", "count_bonus"] = Field(
        default="epsilon",
        description="what leads to pairs that were seldom tried, beside epsilon: nothing; or that one never tried is "
        "worth 1 / (1 - gamma); or that sweeps add bonus / sqrt(n) to the reward of one tried n times, and one never "
        "tried is worth bonus / (1 - gamma)",
        json_schema_extra=since("0.2.0"),
    )
    bonus: float | None = Field(
        default=None, gt=0, le=1e6, description="that of count_bonus", json_schema_extra=since("0.2.0")
    )

    @model_validator(mode="after")
    def _explores(self) -> Self:
        if (self.exploration == "count_bonus") != (self.bonus is not None):
            raise ValueError("exploration: count_bonus goes with a bonus, and only that does")
        if self.exploration != "epsilon" and self.unvisited == "zero":
            raise ValueError(f"unvisited means nothing with exploration: {self.exploration}; leave it out")
        return self

    @property
    def fills(self) -> bool:
        """Not where what was never tried has a value of its own."""
        return super().fills and self.exploration == "epsilon"

    @property
    def weighted(self) -> bool:
        """Also where it scales counts itself."""
        return super().weighted or self.prior_strength is not None

    def goes_on_from(self, other: AgentParameters) -> str | None:
        """One to which what was never tried is worth nothing only from one to which it was not worth more."""
        optimistic = getattr(other, "exploration", "epsilon") != "epsilon"
        if optimistic and self.exploration == "epsilon" and not self.fills:
            return "what was never tried is worth zero to only one of them"
        return super().goes_on_from(other)

    def _create(self, setting: Setting) -> ModelBased:
        """Q of what pairs never tried are worth, and an empty model."""
        q = np.full((setting.n_states, setting.n_actions), self._untried)
        return self._record(q, empty_model(setting, np.float64 if self.weighted else np.int32))

    def _restore(self, setting: Setting, saved: Saved) -> ModelBased:
        """Go on with a saved model."""
        return self._record(*self._learned(setting, saved))

    def _learned(self, setting: Setting, saved: Saved) -> tuple[Table, SparseModel]:
        """Also with what explores, whoever saved it."""
        q, model = super()._learned(setting, saved)
        if self.exploration != "epsilon":
            q[saved["visits"] == 0] = self._untried
        model.mean_rewards[:] += self._bonuses(model)
        return q, model

    def _meet(self, record: ModelBased, human: int) -> None:
        """What is known counts less."""
        if self.prior_strength is not None:
            before = self._bonuses(record.model)
            cap(record.model, self.prior_strength)
            record.model.mean_rewards[:] += self._bonuses(record.model) - before

    def _forget_rewards(self, record: Any) -> None:
        """A bonus is none."""
        record.model.mean_rewards[:] = self._bonuses(record.model)

    def _bonuses(self, model: SparseModel) -> Table:
        """What the R that sweeps use has beside mean rewards, shape (pairs,); of pairs never tried it is not used."""
        bonuses: Table = (self.bonus or 0.0) / np.sqrt(np.maximum(model.visits, 1))
        return bonuses

    @property
    def _untried(self) -> float:
        """What a pair never tried is worth at first."""
        best = {"epsilon": 0.0, "optimistic": 1.0, "count_bonus": self.bonus or 0.0}[self.exploration]
        return best / (1 - float(self.gamma))

    def _record(self, q: Table, model: SparseModel) -> ModelBased:
        numbers = float(self.gamma), float(self.epsilon), self.plan_every, self.fills, float(self.bonus or 0.0)
        return ModelBased(q, np.zeros(len(q)), model, *numbers)


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
    pair = state * agent.q.shape[1] + action
    count(agent.model, pair, reward, next_state)
    if agent.bonus > 0.0:
        agent.model.mean_rewards[pair] += agent.bonus / sqrt(agent.model.visits[pair])
    if step % agent.plan_every == 0:
        sweep(agent.model, agent.q, agent.values, agent.gamma, 1, agent.fill_unvisited)
