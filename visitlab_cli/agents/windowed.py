"""Model-based with a short memory: of each pair only the last `k` outcomes count, from the first step on."""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, counts, floats
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as
from visitlab_cli.agents.sparse_model import (
    Counts,
    SparseModel,
    count,
    empty_model,
    replace,
    restored_model,
    sweep,
    uncount,
)
from visitlab_cli.agents.swept import SweptParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class Windows(NamedTuple):
    """The last outcomes of each pair, in rings: `states` and `rewards` (pairs, k), `oldest` (pairs,) a place."""

    states: Counts
    rewards: Table
    oldest: Counts


class Windowed(NamedTuple):
    """`q` has shape (states, actions), `values` (states,); `model` counts what lies in the windows."""

    q: Table
    values: Table
    model: SparseModel
    windows: Windows
    gamma: float
    epsilon: float
    plan_every: int
    fill_unvisited: bool


class WindowedParameters(SweptParameters):
    """As model_based, but only the last `k` outcomes of each pair count."""

    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 0.77, GO_TO_HUMAN: 0.39, SOCIAL: 0.95, VISIT: 2.7}
    kind: Literal["windowed"]
    k: int = Field(default=50, ge=1, le=1000, description="outcomes of each pair that count: the last so many")

    @property
    def forgets(self) -> bool:
        """What leaves a window is not counted any more."""
        return True

    def _create(self, setting: Setting) -> Windowed:
        """Q of zeros, an empty model and empty windows."""
        return self._record(zeros(setting), empty_model(setting))

    def _restore(self, setting: Setting, saved: Saved) -> Windowed:
        """Go on with what the last `k` of the saved outcomes say."""
        lengths = np.diff(saved["window_offsets"])
        record = self._record(saved["q"].copy(), restored_model(setting, saved))
        pairs = np.repeat(np.arange(len(lengths)), lengths)
        places = np.arange(len(pairs)) - np.repeat(saved["window_offsets"][:-1], lengths)
        if lengths.max(initial=0) > self.k:
            places -= np.maximum(lengths - self.k, 0)[pairs]
            for pair, state, reward in zip(
                *(array[places < 0] for array in (pairs, saved["window_states"], saved["window_rewards"])), strict=True
            ):
                uncount(record.model, pair, reward, state)
            visits = record.model.visits
            np.divide(record.model.reward_sums, visits, out=record.model.mean_rewards, where=visits > 0)
        kept = places >= 0
        record.windows.states[pairs[kept], places[kept]] = saved["window_states"][kept]
        record.windows.rewards[pairs[kept], places[kept]] = saved["window_rewards"][kept]
        return record

    def _save(self, record: Windowed) -> Saved:
        """Also the outcomes of each pair, the oldest first, in compressed rows."""
        visits, oldest = record.model.visits.astype(np.int64), record.windows.oldest
        offsets = np.concatenate([np.zeros(1, np.int64), np.cumsum(visits)])
        pairs = np.repeat(np.arange(len(visits)), visits)
        places = (np.arange(len(pairs)) - offsets[pairs] + oldest[pairs]) % self.k
        return {
            **super()._save(record),
            "window_offsets": offsets,
            "window_states": record.windows.states[pairs, places],
            "window_rewards": record.windows.rewards[pairs, places],
        }

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """The table, the model and the windows."""
        pairs = setting.n_states * setting.n_actions
        return {
            **super().arrays(setting),
            "window_offsets": counts(pairs + 1, high=2**40, dtype="<i8"),
            "window_states": counts(None, high=setting.n_states - 1),
            "window_rewards": floats(None),
        }

    def _fault(self, saved: Saved) -> str | None:
        """Also whether the windows hold what the model counts."""
        offsets, states = saved["window_offsets"], saved["window_states"]
        rows = np.concatenate([[0], np.cumsum(saved["visits"], dtype=np.int64)])
        if not np.array_equal(offsets, rows) or not len(states) == len(saved["window_rewards"]) == offsets[-1]:
            return "the windows do not hold as many outcomes as visits"
        return super()._fault(saved) or self._miscounted(saved)

    def _miscounted(self, saved: Saved) -> str | None:
        n = saved["q"].shape[0]
        held = _pairs(saved["window_offsets"]) * n + saved["window_states"]
        counted = _pairs(saved["successor_offsets"]) * n + saved["successor_states"]
        order = np.argsort(counted)
        there, times = np.unique(held, return_counts=True)
        same = np.array_equal(there, counted[order]) and np.array_equal(times, saved["successor_counts"][order])
        return None if same else "the windows do not hold the successors that are counted"

    def _record(self, q: Table, model: SparseModel) -> Windowed:
        pairs = q.size
        rings = np.zeros((pairs, self.k), np.int32), np.zeros((pairs, self.k)), np.zeros(pairs, np.int32)
        gamma, epsilon = float(self.gamma), float(self.epsilon)
        return Windowed(q, np.zeros(len(q)), model, Windows(*rings), gamma, epsilon, self.plan_every, self.fills)


def _pairs(offsets: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    return np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))


@kernel
def count_in_window(model: SparseModel, windows: Windows, pair: int, reward: float, next_state: int) -> None:
    """Add one transition of `pair`; where its window is full, the oldest goes."""
    k = windows.states.shape[1]
    place = model.visits[pair]
    if place < k:
        count(model, pair, reward, next_state)
    else:
        place = windows.oldest[pair]
        windows.oldest[pair] = place + 1 if place + 1 < k else 0
        replace(model, pair, windows.rewards[pair, place], windows.states[pair, place], reward, next_state)
    windows.states[pair, place] = next_state
    windows.rewards[pair, place] = reward


@CHOOSE.of(Windowed)
def choose(agent: Windowed, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy."""
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@CHOOSE_AS.of(Windowed)
def choose_as(
    agent: Windowed, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.q[state], meant, agent.epsilon, random)


@LEARN.of(Windowed)
def learn(
    agent: Windowed,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Count the transition for the oldest of its pair; sweep at every `plan_every`-th step."""
    count_in_window(agent.model, agent.windows, state * agent.q.shape[1] + action, reward, next_state)
    if step % agent.plan_every == 0:
        sweep(agent.model, agent.q, agent.values, agent.gamma, 1, agent.fill_unvisited)
