"""What the planners share that sweep one learned model every `plan_every` steps, as the paper's model-based agent."""

from typing import Literal, Self

import numpy as np
from pydantic import Field, model_validator

from visitlab_cli.agents.base import EPSILON, GAMMA, PLAN_EVERY, Saved, Setting
from visitlab_cli.agents.one_model import OneModelParameters


class SweptParameters(OneModelParameters):
    """Epsilon-greedy value iteration; its records have a `plan_every`, too."""

    gamma: float = GAMMA
    epsilon: float = EPSILON
    plan_every: int = PLAN_EVERY
    unvisited: Literal["uniform", "zero"] = Field(
        default="uniform",
        description="the model of a pair never tried: no reward and any state next, or a value of zero",
    )

    @model_validator(mode="after")
    def _symmetric_zero(self) -> Self:
        if self.symmetric and self.unvisited == "uniform":
            raise ValueError("symmetric goes with unvisited: zero only; uniform is over states of which it has no rows")
        return self

    @property
    def fills(self) -> bool:
        """Whether sweeps value what was never tried."""
        return self.unvisited == "uniform"

    def updates_a_step(self, setting: Setting, saved: Saved) -> float | None:
        """All pairs in a sweep, or those that were tried."""
        return self.swept_pairs(saved) / self.plan_every

    def swept_pairs(self, saved: Saved) -> float:
        """How many values a sweep changes."""
        return float(np.size(saved["visits"]) if self.fills else np.count_nonzero(saved["visits"]))
