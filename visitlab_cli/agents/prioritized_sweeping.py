"""Prioritized sweeping: at each step the states are backed up whose values should change the most.

Moore and Atkeson (1993). A backup of a state sets all its actions to their expected values by the learned model. When
its value changes by d, each pair that was seen to lead there with probability T has its state queued with gamma |d| T,
where that is above `theta`.
"""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, Saved, Setting, zeros
from visitlab_cli.agents.declared import LARGEST, Declared, counts
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as, maximum
from visitlab_cli.agents.known_values import (
    Known,
    KnownValuesParameters,
    expected,
    fill_untried,
    no_values,
    revalue,
    saved_values,
    untried,
)
from visitlab_cli.agents.sparse_model import Ints, SparseModel, count, empty_model, restored_model
from visitlab_cli.compiled import kernel, long_kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT

NONE = -1
"""Not queued; the end of a chain."""
FIRST = 1e29
"""The priority of the state that was just left."""


class Queue(NamedTuple):
    """A binary heap of states, the largest priority on top; arrays over states, `size` (1,)."""

    heap: Ints
    place: Ints  # of a state in the heap; -1 where it is not queued
    priority: Table
    size: Ints


class Sources(NamedTuple):
    """The pairs that were seen to lead to each state, in chains: `last` (states,), `pair`, `before` and `end` (1,)."""

    last: Ints
    pair: Ints
    state: Ints  # that the pair leads to
    before: Ints
    end: Ints

    def filled(self) -> dict[str, int]:
        """How much of the chains is in use, in a checkpoint."""
        return dict.fromkeys(("pair", "state", "before"), int(self.end[0]))


class PrioritizedSweeping(NamedTuple):
    """`q` has shape (states, actions)."""

    q: Table
    model: SparseModel
    known: Known
    queue: Queue
    sources: Sources
    gamma: float
    epsilon: float
    backups: int
    theta: float


class PrioritizedSweepingParameters(KnownValuesParameters):
    """Epsilon-greedy, with `backups` states a step backed up in the order of their priority."""

    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 1.5, GO_TO_HUMAN: 1.2, SOCIAL: 7.7, VISIT: 12.0}
    kind: Literal["prioritized_sweeping"]
    backups: int = Field(default=5, ge=1, le=10**6, description="states that are backed up at each step, at most")
    theta: float = Field(
        default=1e-3, ge=0, le=10**9, description="the change of a value below which nothing is queued for it"
    )

    def _create(self, setting: Setting) -> PrioritizedSweeping:
        """Q of zeros, an empty model and nothing queued."""
        return self._record(zeros(setting), empty_model(setting), no_values(setting), np.zeros(setting.n_states))

    def _restore(self, setting: Setting, saved: Saved) -> PrioritizedSweeping:
        """Go on with a saved model, its values and what was queued."""
        model, priorities = restored_model(setting, saved), saved["priorities"].copy()
        record = self._record(saved["q"].copy(), model, saved_values(saved), priorities)
        queued = saved["queue"]
        record.queue.heap[: len(queued)] = queued
        record.queue.place[queued] = np.arange(len(queued))
        record.queue.size[0] = len(queued)
        sources, states = record.sources, saved["lead_states"]
        sources.pair[: len(states)] = saved["lead_pairs"]
        sources.state[: len(states)] = states
        order = np.argsort(states, kind="stable")
        before = np.roll(order, 1)
        before[np.flatnonzero(np.diff(states[order], prepend=-1))] = NONE
        sources.before[order] = before
        sources.last[states[order]] = order
        sources.end[0] = len(states)
        return record

    def _save(self, record: PrioritizedSweeping) -> Saved:
        """Also the heap of states and their priorities, and which pairs lead to which, as they were met."""
        queue, sources, end = record.queue, record.sources, record.sources.end[0]
        return {
            **super()._save(record),
            "priorities": queue.priority,
            "queue": queue.heap[: queue.size[0]],
            "lead_pairs": sources.pair[:end],
            "lead_states": sources.state[:end],
        }

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """Also what is queued, and what leads where."""
        states, pairs = setting.n_states, setting.n_states * setting.n_actions
        return {
            **super().arrays(setting),
            "priorities": Declared("<f8", (states,), 0, LARGEST),
            "queue": counts(None, high=states - 1, dtype="<i8"),
            "lead_pairs": counts(None, high=pairs - 1, dtype="<i8"),
            "lead_states": counts(None, high=states - 1, dtype="<i8"),
        }

    def _fault(self, saved: Saved) -> str | None:
        """Also whether a state is queued once, and what leads where is what was counted."""
        queue, n = saved["queue"], len(saved["q"])
        if len(np.unique(queue)) != len(queue):
            return "queue has a state twice"
        pairs = np.repeat(np.arange(saved["visits"].size), np.diff(saved["successor_offsets"]))
        counted = np.sort(pairs * n + saved["successor_states"])
        if len(saved["lead_pairs"]) != len(saved["lead_states"]) or not np.array_equal(
            np.sort(saved["lead_pairs"] * n + saved["lead_states"]), counted
        ):
            return "what leads where is not what was counted"
        return super()._fault(saved)

    def updates_a_step(self, setting: Setting, saved: Saved) -> float:
        """All actions of the states that are backed up, where so many are queued."""
        return float(self.backups * setting.n_actions)

    def _record(self, q: Table, model: SparseModel, known: Known, priorities: Table) -> PrioritizedSweeping:
        states, links = len(q), len(model.pool_states)
        queue = Queue(np.zeros(states, np.int64), np.full(states, NONE), priorities, np.zeros(1, np.int64))
        pair, to, before = (np.empty(links, np.int64) for _ in range(3))
        sources = Sources(np.full(states, NONE), pair, to, before, np.zeros(1, np.int64))
        numbers = float(self.gamma), float(self.epsilon), self.backups, float(self.theta)
        return PrioritizedSweeping(q, model, known, queue, sources, *numbers)


@kernel
def rise(queue: Queue, place: int) -> None:
    """Move what lies at a place of the heap up to where it belongs."""
    heap, priority = queue.heap, queue.priority
    state = heap[place]
    while place > 0 and priority[heap[(place - 1) // 2]] < priority[state]:
        heap[place] = heap[(place - 1) // 2]
        queue.place[heap[place]] = place
        place = (place - 1) // 2
    heap[place] = state
    queue.place[state] = place


@kernel
def push(queue: Queue, state: int, priority: float) -> None:
    """Queue a state, or raise its priority; never lower it."""
    if queue.place[state] < 0:
        queue.place[state] = queue.size[0]
        queue.heap[queue.size[0]] = state
        queue.size[0] += 1
    elif priority <= queue.priority[state]:
        return
    queue.priority[state] = priority
    rise(queue, queue.place[state])


@kernel
def pop(queue: Queue) -> int:
    """The state with the largest priority, which leaves the queue."""
    heap, priority = queue.heap, queue.priority
    top = heap[0]
    queue.size[0] -= 1
    size, moved = queue.size[0], heap[queue.size[0]]
    queue.place[top] = -1
    priority[top] = 0.0
    if size > 0:
        place = 0
        while 2 * place + 1 < size:
            child = 2 * place + 1
            if child + 1 < size and priority[heap[child + 1]] > priority[heap[child]]:
                child += 1
            if priority[heap[child]] <= priority[moved]:
                break
            heap[place] = heap[child]
            queue.place[heap[place]] = place
            place = child
        heap[place] = moved
        queue.place[moved] = place
    return int(top)


@kernel
def lead(sources: Sources, pair: int, state: int) -> None:
    """Note that `pair` leads to `state`."""
    end = sources.end[0]
    sources.pair[end] = pair
    sources.state[end] = state
    sources.before[end] = sources.last[state]
    sources.last[state] = end
    sources.end[0] = end + 1


@kernel
def probability(model: SparseModel, pair: int, state: int) -> float:
    """T(pair, state)."""
    first = model.first[pair]
    for place in range(first, first + model.length[pair]):
        if model.pool_states[place] == state:
            return float(model.pool_counts[place] / model.visits[pair])
    return 0.0


@long_kernel
def plan(agent: PrioritizedSweeping, backups: int) -> None:
    """Back up so many states from the top of the queue, and queue those from which one gets to what changed."""
    n_actions = agent.q.shape[1]
    for _ in range(backups):
        if agent.queue.size[0] == 0:
            return
        state = pop(agent.queue)
        u = untried(agent.known, agent.gamma)
        fill_untried(agent.q, agent.model, state, u)
        for action in range(n_actions):
            pair = state * n_actions + action
            if agent.model.visits[pair] > 0:
                agent.q[state, action] = expected(agent.model, agent.known, pair, u, agent.gamma)
        change = agent.gamma * revalue(agent.known, state, maximum(agent.q[state]))
        if change > agent.theta:
            link = agent.sources.last[state]
            while link >= 0:
                pair = agent.sources.pair[link]
                priority = change * probability(agent.model, pair, state)
                if priority > agent.theta:
                    push(agent.queue, pair // n_actions, priority)
                link = agent.sources.before[link]


@CHOOSE.of(PrioritizedSweeping)
def choose(agent: PrioritizedSweeping, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Epsilon-greedy."""
    return epsilon_greedy(agent.q[state], agent.epsilon, random)


@CHOOSE_AS.of(PrioritizedSweeping)
def choose_as(
    agent: PrioritizedSweeping, state: int, meant: npt.NDArray[np.int64], step: int, random: RandomState
) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    return epsilon_greedy_as(agent.q[state], meant, agent.epsilon, random)


@LEARN.of(PrioritizedSweeping)
def learn(
    agent: PrioritizedSweeping,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Count the transition, queue the state it came from before all others, and plan."""
    pair = state * agent.q.shape[1] + action
    successors = agent.model.length[pair]
    count(agent.model, pair, reward, next_state)
    if agent.model.length[pair] > successors:
        lead(agent.sources, pair, next_state)
    push(agent.queue, state, FIRST)
    plan(agent, agent.backups)
