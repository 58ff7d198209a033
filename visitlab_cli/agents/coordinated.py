"""A model-based and a model-free expert: where they have agreed, the cheap one acts, and no sweep is made for it.

Of each state it keeps how much they agree, a(s) <- a(s) + rate (x - a(s)) at each visit, where x is 1 if both hold the
same action for the best and the model-free one has found it to be worth something, else 0. Both learn from every step.
"""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, counts, floats
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as, maximum
from visitlab_cli.agents.sparse_model import Ints, SparseModel, count, empty_model, restored_model, sweep
from visitlab_cli.agents.swept import SweptParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class Coordinated(NamedTuple):
    """`q` (of the model) and `q_free` have shape (states, actions), `agreement` and `values` (states,).

    `controlled`, the steps in which the model-based expert acted, and `sweeps` have shape (1,).
    """

    q: Table
    q_free: Table
    agreement: Table
    controlled: Ints
    sweeps: Ints
    values: Table
    model: SparseModel
    gamma: float
    epsilon: float
    alpha: float
    threshold: float
    rate: float
    plan_every: int
    fill_unvisited: bool


class CoordinatedParameters(SweptParameters):
    """Model-based, or model-free where both agree; sweeps at every `plan_every`-th step that the first controlled."""

    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 0.67, GO_TO_HUMAN: 0.38, SOCIAL: 0.87, VISIT: 1.9}
    kind: Literal["coordinated"]
    threshold: float = Field(
        default=0.9, gt=0, le=1, description="agreement from which on the model-free expert acts in a state"
    )
    rate: float = Field(default=0.1, gt=0, le=1, description="how fast agreement follows what is seen at a visit")
    learning_rate: float = Field(default=0.1, gt=0, le=1, description="learning rate of the model-free expert")

    def _create(self, setting: Setting) -> Coordinated:
        """Tables of zeros, no agreement and an empty model."""
        nothing = np.zeros(setting.n_states), np.zeros(1, np.int64), np.zeros(1, np.int64)
        return self._record(zeros(setting), zeros(setting), *nothing, empty_model(setting))

    def _restore(self, setting: Setting, saved: Saved) -> Coordinated:
        """Go on with saved tables, agreement and model."""
        tables = saved["q"].copy(), saved["q_free"].copy(), saved["agreement"].ravel().copy()
        return self._record(*tables, saved["controlled"].copy(), saved["sweeps"].copy(), restored_model(setting, saved))

    def _save(self, record: Coordinated) -> Saved:
        """Also the model-free table, the agreement (states, 1), and what it cost: `controlled` steps, `sweeps`."""
        return {
            **super()._save(record),
            "q_free": record.q_free,
            "agreement": record.agreement[:, None],
            "controlled": record.controlled,
            "sweeps": record.sweeps,
        }

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """The tables, the model, the agreement and the cost."""
        return {
            **super().arrays(setting),
            "q_free": floats(setting.n_states, setting.n_actions),
            "agreement": Declared("<f8", (setting.n_states, 1), 0, 1),
            "controlled": counts(1, high=2**62, dtype="<i8"),
            "sweeps": counts(1, high=2**62, dtype="<i8"),
        }

    def updates_a_step(self, setting: Setting, saved: Saved) -> float | None:
        """One of the model-free expert, and the sweeps that were made."""
        steps = max(1, int(saved["visits"].sum()))
        return 1.0 + self.swept_pairs(saved) * int(saved["sweeps"][0]) / steps

    def _record(self, *learned: Any) -> Coordinated:
        *tables, model = learned
        rates = float(self.learning_rate), float(self.threshold), float(self.rate)
        learner = float(self.gamma), float(self.epsilon), *rates, self.plan_every, self.fills
        return Coordinated._make((*tables, np.zeros(len(tables[0])), model, *learner))


@kernel
def agrees(q: Table, q_free: Table) -> bool:
    """Whether the first of the best actions is the same by both, shape (actions,), and worth something model-free."""
    best = np.argmax(q_free)
    return bool(q_free[best] > 0.0 and best == np.argmax(q))


@CHOOSE.of(Coordinated)
def choose(agent: Coordinated, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy by the expert that controls the state."""
    if agent.agreement[state] >= agent.threshold:
        return epsilon_greedy(agent.q_free[state], agent.epsilon, random)
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@CHOOSE_AS.of(Coordinated)
def choose_as(
    agent: Coordinated, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    if agent.agreement[state] >= agent.threshold:
        return epsilon_greedy_as(agent.q_free[state], meant, agent.epsilon, random)
    return epsilon_greedy_as(agent.q[state], meant, agent.epsilon, random)


@LEARN.of(Coordinated)
def learn(
    agent: Coordinated,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Both learn; a sweep at every `plan_every`-th step of a state that the model-based expert controls."""
    controlled = agent.agreement[state] < agent.threshold
    agreed = 1.0 if agrees(agent.q[state], agent.q_free[state]) else 0.0
    agent.agreement[state] += agent.rate * (agreed - agent.agreement[state])
    target = reward + agent.gamma * maximum(agent.q_free[next_state])
    agent.q_free[state, action] += agent.alpha * (target - agent.q_free[state, action])
    count(agent.model, state * agent.q.shape[1] + action, reward, next_state)
    if controlled:
        agent.controlled[0] += 1
        if agent.controlled[0] % agent.plan_every == 0:
            sweep(agent.model, agent.q, agent.values, agent.gamma, 1, agent.fill_unvisited)
            agent.sweeps[0] += 1
