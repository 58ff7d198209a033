"""A planner that believes what it saw last: one model of (cell, action), shared by all goals of navigation.

T(c, a) is the cell in which an action ended when it was last tried there, whatever the goal; the goal only decides
which cells pay, R(g, c'), as they last did. A sweep is synchronous, as the paper's (section 4.2):
Q(g, c, a) = R(g, T(c, a)) + gamma max_a' Q(g, T(c, a), a'). What was never tried is taken for a stay.
"""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import (
    CHOOSE,
    EPSILON,
    GAMMA,
    LEARN,
    PLAN_EVERY,
    AgentParameters,
    Saved,
    Setting,
    zeros,
)
from visitlab_cli.agents.declared import Declared, counts, floats
from visitlab_cli.agents.exploration import Table, epsilon_greedy, maximum
from visitlab_cli.compiled import long_kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import NAVIGATION

NEVER = -1
"""The end of an action that was not tried."""


class LastSeen(NamedTuple):
    """`q` (states, actions), `ends` (cells, actions) a cell or `NEVER`, `pays` (states,) for coming to a state."""

    q: Table
    ends: npt.NDArray[np.int64]
    pays: Table
    values: Table  # scratch space, shape (states,)
    gamma: float
    epsilon: float
    plan_every: int


class LastSeenParameters(AgentParameters):
    """Plans on where each action was last seen to end; states of different goals share what they know of moving."""

    plans: ClassVar[bool] = True
    tasks: ClassVar[tuple[str, ...]] = (NAVIGATION,)
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 0.38}
    kind: Literal["last_seen"]
    gamma: float = GAMMA
    epsilon: float = EPSILON
    plan_every: int = PLAN_EVERY

    def create(self, setting: Setting) -> LastSeen:
        """Nothing was seen."""
        cells = setting.n_states // setting.goals
        return self._record(zeros(setting), np.full((cells, setting.n_actions), NEVER), np.zeros(setting.n_states))

    def restore(self, setting: Setting, saved: Saved) -> LastSeen:
        """Go on with what was seen."""
        return self._record(saved["q"].copy(), saved["ends"].copy(), saved["pays"].copy())

    def _record(self, q: Table, ends: npt.NDArray[np.int64], pays: Table) -> LastSeen:
        return LastSeen(q, ends, pays, np.zeros(len(q)), float(self.gamma), float(self.epsilon), self.plan_every)

    def save(self, record: LastSeen) -> Saved:
        """The table, ends, and what states pay."""
        return {"q": record.q, "ends": record.ends, "pays": record.pays}

    def forget_rewards(self, record: LastSeen) -> None:
        """No state pays until it is next come to."""
        record.pays[:] = 0.0

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """As `save` has them."""
        cells = setting.n_states // setting.goals
        return {
            "q": floats(setting.n_states, setting.n_actions),
            "ends": counts(cells, setting.n_actions, low=NEVER, high=cells - 1, dtype="<i8"),
            "pays": floats(setting.n_states),
        }

    def updates_a_step(self, setting: Setting, saved: Saved) -> float:
        """All pairs in a sweep."""
        return float(np.size(saved["q"])) / self.plan_every

    def models(self, saved: Saved) -> dict[str, Saved]:
        """What was seen of moving, as if once, with the first goal."""
        ends, n_states = saved["ends"], len(saved["q"])
        tried = np.zeros((n_states, ends.shape[1]), np.int32)
        tried[: len(ends)] = ends != NEVER
        rewards = np.zeros(tried.shape)
        rewards[: len(ends)] = np.where(ends == NEVER, 0.0, saved["pays"][ends])
        seen = ends[ends != NEVER]
        return {
            "model": {
                "visits": tried,
                "reward_sums": rewards,
                "successor_offsets": np.concatenate([[0], np.cumsum(tried)]).astype(np.int64),
                "successor_states": seen.astype(np.int32),
                "successor_counts": np.ones(len(seen), np.int32),
            }
        }


@CHOOSE.of(LastSeen)
def choose(agent: LastSeen, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy."""
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@LEARN.of(LastSeen)
def learn(
    agent: LastSeen,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Remember the end and what it pays; plan when it is time."""
    cells = len(agent.ends)
    agent.ends[state % cells, action] = next_state % cells
    agent.pays[next_state] = reward
    if step % agent.plan_every == 0:
        sweep(agent.q, agent.ends, agent.pays, agent.values, agent.gamma)


@long_kernel
def sweep(q: Table, ends: npt.NDArray[np.int64], pays: Table, values: Table, gamma: float) -> None:
    """One synchronous sweep over all states and actions, changing `q`; `values` is scratch space."""
    cells, actions = ends.shape
    for state in range(len(q)):
        values[state] = maximum(q[state])
    for first in range(0, len(q), cells):
        for cell in range(cells):
            for action in range(actions):
                ahead = first + (cell if ends[cell, action] == NEVER else ends[cell, action])
                q[first + cell, action] = pays[ahead] + gamma * values[ahead]
