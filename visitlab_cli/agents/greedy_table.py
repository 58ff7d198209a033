"""An agent that follows a fixed table: greedy, never exploring, never learning. Frozen and scripted ones are this."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, AgentParameters, Saved, Setting
from visitlab_cli.agents.declared import Declared, floats
from visitlab_cli.agents.exploration import Table, epsilon_greedy_as, greedy
from visitlab_cli.random_numbers import RandomState


class GreedyTable(NamedTuple):
    """`q` has shape (states, actions)."""

    q: Table


@CHOOSE.of(GreedyTable)
def choose(agent: GreedyTable, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Uniform among the best."""
    return greedy(agent.q[state], random), False


@CHOOSE_AS.of(GreedyTable)
def choose_as(
    agent: GreedyTable, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.q[state], meant, 0.0, random)


@LEARN.of(GreedyTable)
def learn(
    agent: GreedyTable,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Learn nothing."""


class FrozenTable:
    """The parameters of an agent that is greedy and learns nothing: it saves the values that it goes by."""

    def __init__(self, parameters: AgentParameters) -> None:
        """Of these."""
        self._values = parameters.values

    def restore(self, setting: Setting, saved: Saved) -> GreedyTable:
        """By what it believed each action is worth."""
        return GreedyTable(np.ascontiguousarray(self._values(saved), np.float64))

    def save(self, record: GreedyTable) -> Saved:
        """The values."""
        return {"q": record.q}

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """The values."""
        return {"q": floats(setting.n_states, setting.n_actions)}

    def values(self, saved: Saved) -> Table:
        """The values."""
        return saved["q"]

    def models(self, saved: Saved) -> dict[str, Saved]:
        """None, as of whoever learns nothing."""
        return {}

    def fault(self, setting: Setting, saved: Saved) -> str | None:
        """Nothing is wrong with a table that is as it was declared."""
        return None
