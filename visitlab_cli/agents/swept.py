"""What the planners share that sweep one learned model every `plan_every` steps, as the paper's model-based agent."""

from collections.abc import Sequence
from typing import Literal, Self

import numpy as np
from pydantic import Field, PrivateAttr, model_validator

from visitlab_cli.agents.base import EPSILON, GAMMA, PLAN_EVERY, Saved, Setting
from visitlab_cli.agents.exploration import Table
from visitlab_cli.agents.one_model import OneModelParameters
from visitlab_cli.agents.sparse_model import SparseModel, pooled_models, restored_model, saved_model, sweep
from visitlab_cli.agents.symmetry import folded, unfolded

SWEEPS_OF_A_POOL = 40
"""That many sweeps of a model that was put together make its values."""


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
        if self.symmetric and self.fills:
            raise ValueError("symmetric goes with unvisited: zero only; uniform is over states of which it has no rows")
        return self

    _from_a_pool: bool = PrivateAttr(default=False)

    @property
    def weighted(self) -> bool:
        """Where its model was put together of several."""
        return self._from_a_pool

    def taking_in_a_pool(self) -> Self:
        """Its counts will be weighted."""
        taking = self.model_copy()
        taking._from_a_pool = True
        return taking

    def pooled(self, setting: Setting, several: Sequence[Saved], strength: float) -> Saved:
        """Their models as one, the mean of their values, swept until they fit the model."""
        q: Table = np.mean([each["q"] for each in several], axis=0)
        arrays = pooled_models(several, strength)
        if self.symmetric:
            q, arrays = folded({"q": q})["q"], folded(arrays)
        q, model = self._learned(setting._replace(n_states=len(q), steps=0), {"q": q, **arrays})
        values = np.zeros(len(q))
        for _ in range(SWEEPS_OF_A_POOL):
            sweep(model, q, values, float(self.gamma), 1, self.fills)
        whole = {"q": q, **saved_model(model, q.shape[1])}
        return unfolded(whole) if self.symmetric else whole

    def _learned(self, setting: Setting, saved: Saved) -> tuple[Table, SparseModel]:
        """The table and the model to go on with."""
        return saved["q"].copy(), restored_model(setting, saved)

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
