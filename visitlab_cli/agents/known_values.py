"""What the planners share that value one state at a time: V of the states known so far, and of what was never tried.

A pair never tried has R = 0 and any state next. Its value u is that of the fixed point: u = gamma (sum of V over the
known states + u times the number of the others) / S, where a state is known once it was valued, and others are worth u.
"""

from collections.abc import Mapping
from typing import Any, ClassVar, NamedTuple

import numpy as np

from visitlab_cli.agents.base import EPSILON, GAMMA, Saved, Setting
from visitlab_cli.agents.declared import Declared, counts, floats
from visitlab_cli.agents.exploration import Table
from visitlab_cli.agents.one_model import OneModelParameters
from visitlab_cli.agents.sparse_model import Ints, SparseModel
from visitlab_cli.compiled import kernel


class Known(NamedTuple):
    """`values` (states,), 0 of what is not known; `is_known` (states,); `total` of the values and `number`, (1,)."""

    values: Table
    is_known: Ints
    total: Table
    number: Ints


class KnownValuesParameters(OneModelParameters):
    """Its records have `known`, too."""

    plans: ClassVar[bool] = False
    takes_masks: ClassVar[bool] = True
    gamma: float = GAMMA
    epsilon: float = EPSILON

    symmetric: ClassVar[bool] = False  # type: ignore[misc]
    never: ClassVar[Mapping[str, str]] = {
        "symmetric": "what was never tried leads to any state, of which it would have no rows"
    }

    def _save(self, record: Any) -> Saved:
        """Also the values of the states, and which are known."""
        known = record.known
        return {**super()._save(record), "values": known.values, "known": known.is_known, "known_total": known.total}

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """The table, the model and the values."""
        states = setting.n_states
        own = {"values": floats(states), "known": counts(states, high=1, dtype="<i8"), "known_total": floats(1)}
        return {**super().arrays(setting), **own}


def no_values(setting: Setting) -> Known:
    """No state is known."""
    return _known(np.zeros(setting.n_states), np.zeros(setting.n_states, np.int64), np.zeros(1))


def saved_values(saved: Saved) -> Known:
    """Those that were saved."""
    return _known(saved["values"].copy(), saved["known"].copy(), saved["known_total"].copy())


def _known(values: Table, is_known: Ints, total: Table) -> Known:
    return Known(values, is_known, total, np.array([is_known.sum()], np.int64))


@kernel
def untried(known: Known, gamma: float) -> float:
    """What a pair never tried is worth."""
    states = len(known.values)
    return float(gamma * known.total[0] / (states - (states - known.number[0]) * gamma))


@kernel
def expected(model: SparseModel, known: Known, pair: int, u: float, gamma: float) -> float:
    """What `pair` is worth by its successors, each at least `u`."""
    first, following = model.first[pair], 0.0
    for place in range(first, first + model.length[pair]):
        following += model.pool_counts[place] * max(known.values[model.pool_states[place]], u)
    return float(model.mean_rewards[pair] + gamma * following / model.visits[pair])


@kernel
def fill_untried(q: Table, model: SparseModel, state: int, u: float) -> None:
    """Let the pairs of a state that were never tried be worth `u`."""
    n_actions = q.shape[1]
    for action in range(n_actions):
        if model.visits[state * n_actions + action] == 0:
            q[state, action] = u


@kernel
def revalue(known: Known, state: int, value: float) -> float:
    """A state's value is now this: by how much it changed, not less than 0."""
    change = value - known.values[state]
    known.values[state] = value
    known.total[0] += change
    if known.is_known[state] == 0:
        known.is_known[state] = 1
        known.number[0] += 1
    return float(abs(change))
