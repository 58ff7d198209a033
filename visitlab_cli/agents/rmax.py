"""R-max (Brafman and Tennenholtz, 2002): optimistic until a pair has been tried m times, then its frozen model."""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, GAMMA, LEARN, PLAN_EVERY, Saved, Setting
from visitlab_cli.agents.exploration import Table, epsilon_greedy_as, greedy
from visitlab_cli.agents.one_model import OneModelParameters
from visitlab_cli.agents.sparse_model import (
    SparseModel,
    count,
    empty_model,
    restored_model,
    sweep,
)
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT

M_IN_NAVIGATION, M_ELSEWHERE = 1, 5  # paper, section 4.2


class RMax(NamedTuple):
    """`q` has shape (states, actions), `values` (states,); a pair is known from its `m`-th visit on."""

    q: Table
    values: Table
    model: SparseModel
    gamma: float
    m: int
    plan_every: int


class RMaxParameters(OneModelParameters):
    """R-max (paper, section 4.2)."""

    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 0.77, GO_TO_HUMAN: 0.31, SOCIAL: 0.79, VISIT: 2.7}
    kind: Literal["rmax"]
    gamma: float = GAMMA
    r_max: float = Field(default=1.0, ge=0, le=1e6, description="the largest reward, assumed of what is unknown")
    m: int | None = Field(
        default=None,
        ge=1,
        le=10**6,
        description="visits that make a pair known; 1 in navigation, 5 elsewhere",
    )
    plan_every: int = PLAN_EVERY

    def _create(self, setting: Setting) -> RMax:
        """Q of r_max / (1 - gamma) and an empty model."""
        optimistic = np.full((setting.n_states, setting.n_actions), self.r_max / (1 - self.gamma))
        return self._record(setting, optimistic, empty_model(setting))

    def _restore(self, setting: Setting, saved: Saved) -> RMax:
        """Go on with a saved model."""
        return self._record(setting, saved["q"].copy(), restored_model(setting, saved))

    def updates_a_step(self, setting: Setting, saved: Saved) -> float:
        """Those pairs in a sweep that are known."""
        return float(np.count_nonzero(saved["visits"] >= self._m_in(setting))) / self.plan_every

    def _m_in(self, setting: Setting) -> int:
        return self.m or (M_IN_NAVIGATION if setting.task == "navigation" else M_ELSEWHERE)

    def _record(self, setting: Setting, q: Table, model: SparseModel) -> RMax:
        return RMax(q, np.zeros(len(q)), model, float(self.gamma), self._m_in(setting), self.plan_every)


@CHOOSE.of(RMax)
def choose(agent: RMax, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Greedy."""
    return greedy(agent.q[state], random), False


@CHOOSE_AS.of(RMax)
def choose_as(
    agent: RMax, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.q[state], meant, 0.0, random)


@LEARN.of(RMax)
def learn(
    agent: RMax,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Count the transition unless its pair is known; sweep the known pairs at every `plan_every`-th step."""
    pair = state * agent.q.shape[1] + action
    if agent.model.visits[pair] < agent.m:
        count(agent.model, pair, reward, next_state)
    if step % agent.plan_every == 0:
        sweep(agent.model, agent.q, agent.values, agent.gamma, agent.m, False)
