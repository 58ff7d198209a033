"""A learned model of the world, kept sparse: counts n(s, a, s'), mean rewards, and one sweep of value iteration.

Paper, section 4.2: T(s, a, s') = n(s, a, s') / n(s, a) and R(s, a) = (sum of rewards) / n(s, a). A sweep is
synchronous: V(s) = max_a Q(s, a) for all states, then Q(s, a) = R(s, a) + gamma sum_s' T(s, a, s') V(s').

The successors of a pair lie together in a pool, in the order of their first visit; a pair that outgrows its room
moves to the pool's end with twice the room. The pool is large enough for the steps that the agent may take, but
memory is only spent on what is touched.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import Saved, Setting
from visitlab_cli.agents.declared import Declared, counts, floats, weights
from visitlab_cli.agents.exploration import Table, maximum
from visitlab_cli.compiled import kernel, long_kernel

Ints = npt.NDArray[np.int64]
Counts = npt.NDArray[np.int32]
Weights = npt.NDArray[np.int32] | npt.NDArray[np.float64]
"""How often, as whole numbers, or as numbers that fade."""


ARRAYS = ("visits", "reward_sums", "successor_offsets", "successor_states", "successor_counts")
"""What a model is saved as."""

AT_ONCE = 2048
"""The pairs that a sweep goes over several times before it goes on: what it reads of them stays near."""

Index = np.uint64
"""Of what is known not to be negative: no kernel asks whether it counts from the end."""


class SparseModel(NamedTuple):
    """Counts and rewards of every (state, action) pair; arrays over pairs have shape (states * actions,)."""

    visits: Weights  # n(s, a)
    reward_sums: Table
    mean_rewards: Table  # the R that sweeps use
    first: Ints  # where a pair's successors begin in the pool
    room: Counts  # how many of them fit there
    length: Counts  # how many there are
    pool_states: Counts
    pool_counts: Weights
    pool_end: Ints  # shape (1,)
    left: Counts  # scratch space of sweeps

    def filled(self) -> dict[str, int]:
        """How much of the pool is in use, in a checkpoint."""
        return dict.fromkeys(("pool_states", "pool_counts"), int(self.pool_end[0]))


def empty_model(setting: Setting, kind: type[np.generic] = np.int32) -> SparseModel:
    """A model that has seen nothing, with room for `setting.steps` visits, which are counted in numbers of a kind."""
    pairs = setting.n_states * setting.n_actions
    # a pair with k successors has used rooms of 1 + 2 + ... up to less than 2k, fewer than 4k in all
    pool = 4 * min(setting.steps, pairs * setting.n_states) + 1
    return SparseModel(
        visits=np.zeros(pairs, kind),
        reward_sums=np.zeros(pairs),
        mean_rewards=np.zeros(pairs),
        first=np.zeros(pairs, np.int64),
        room=np.zeros(pairs, np.int32),
        length=np.zeros(pairs, np.int32),
        pool_states=np.empty(pool, np.int32),
        pool_counts=np.empty(pool, kind),
        pool_end=np.zeros(1, np.int64),
        left=np.zeros(AT_ONCE, np.int32),
    )


@kernel
def count(model: SparseModel, pair: int, reward: float, next_state: int) -> None:
    """Add one transition of `pair` (state * actions + action) to the model."""
    model.visits[pair] += 1
    model.reward_sums[pair] += reward
    model.mean_rewards[pair] = model.reward_sums[pair] / model.visits[pair]
    follow(model, pair, next_state, 1)


@kernel
def follow(model: SparseModel, pair: int, next_state: int, times: float) -> None:
    """Add to how often `pair` was followed by a state, and to nothing else."""
    first, length = model.first[pair], model.length[pair]
    for place in range(first, first + length):
        if model.pool_states[place] == next_state:
            model.pool_counts[place] += times
            return
    if length == model.room[pair]:
        room = max(1, 2 * length)
        moved = model.pool_end[0]
        for offset in range(length):
            model.pool_states[moved + offset] = model.pool_states[first + offset]
            model.pool_counts[moved + offset] = model.pool_counts[first + offset]
        model.pool_end[0] = moved + room
        model.first[pair] = first = moved
        model.room[pair] = room
    model.pool_states[first + length] = next_state
    model.pool_counts[first + length] = times
    model.length[pair] = length + 1


@kernel
def times(model: SparseModel, pair: int, next_state: int) -> float:
    """How often `pair` was followed by a state."""
    first = model.first[pair]
    for place in range(first, first + model.length[pair]):
        if model.pool_states[place] == next_state:
            return float(model.pool_counts[place])
    return 0.0


@kernel
def uncount(model: SparseModel, pair: int, reward: float, next_state: int) -> None:
    """Take one transition of `pair` that was counted from the model; a successor that is left with none leaves its row.

    R stays as it was until the pair is next counted.
    """
    model.visits[pair] -= 1
    model.reward_sums[pair] -= reward
    first, last = model.first[pair], model.first[pair] + model.length[pair] - 1
    for place in range(first, last + 1):
        if model.pool_states[place] == next_state:
            model.pool_counts[place] -= 1
            if model.pool_counts[place] == 0:
                model.pool_states[place] = model.pool_states[last]
                model.pool_counts[place] = model.pool_counts[last]
                model.length[pair] -= 1
            return


@kernel
def replace(model: SparseModel, pair: int, lost: float, gone: int, reward: float, next_state: int) -> None:
    """Take one transition of `pair`, to `gone` with the reward `lost`, from the model and add another.

    To the bit what `uncount` and then `count` do; as a rule one search of its row, and not two.
    """
    first = model.first[pair]
    end = first + model.length[pair]
    there, here = end, end
    for place in range(first, end):
        state = model.pool_states[place]
        if state == gone:
            there = place
        if state == next_state:
            here = place
    if here == end or model.pool_counts[there] == 1:
        uncount(model, pair, lost, gone)
        count(model, pair, reward, next_state)
        return
    model.reward_sums[pair] = model.reward_sums[pair] - lost + reward
    model.mean_rewards[pair] = model.reward_sums[pair] / model.visits[pair]
    model.pool_counts[there] -= 1
    model.pool_counts[here] += 1


@long_kernel
def sweep(model: SparseModel, q: Table, values: Table, gamma: float, known: int, fill_unvisited: bool) -> None:
    """One synchronous sweep over all pairs visited at least `known` times, changing `q`, shape (states, actions).

    `values`, shape (states,), is scratch space; `known` is at least 1. With `fill_unvisited` a pair never tried has
    R = 0 and a uniform T over all states; otherwise it keeps its value.

    Some pairs at a time have their first successor added, then those with two their second, and so on: no processor
    foretells where the row of one pair ends, but all of one such column it does. Each sum has its terms in the order of
    its row.
    """
    n_states = len(q)
    total = 0.0
    for state in range(n_states):
        values[state] = maximum(q[state])
        total += values[state]
    unvisited = gamma * (total / n_states)
    flat, left = q.reshape(q.size), model.left
    for begin in range(0, q.size, AT_ONCE):
        end = min(begin + AT_ONCE, q.size)
        new, visits, rewards = flat[begin:end], model.visits[begin:end], model.mean_rewards[begin:end]
        first, length = model.first[begin:end], model.length[begin:end]
        tried = 0
        for row in range(len(new)):
            left[tried] = row
            tried += visits[row] >= known
        n_left = 0
        for place in range(tried):
            pair = Index(left[place])
            new[pair] = 0.0
            left[n_left] = pair
            n_left += length[pair] > 0
        column = 0
        while n_left > 0:
            longer = 0
            for place in range(n_left):
                pair = Index(left[place])
                successor = Index(first[pair] + column)
                new[pair] += model.pool_counts[successor] * values[Index(model.pool_states[successor])]
                left[longer] = pair
                longer += length[pair] > column + 1
            n_left = longer
            column += 1
        for row in range(len(new)):
            known_value = rewards[row] + gamma * new[row] / max(float(visits[row]), 1.0)
            other_value = unvisited if fill_unvisited and visits[row] == 0 else new[row]
            new[row] = known_value if visits[row] >= known else other_value


def saved_model(model: SparseModel, n_actions: int, prefix: str = "") -> Saved:
    """The model as arrays: `visits` and `reward_sums` (states, actions), successors in compressed rows.

    An agent with several models gives each a `prefix` for the names of its arrays.
    """
    offsets = np.concatenate([[0], np.cumsum(model.length, dtype=np.int64)])
    places = _places(model)
    arrays = {
        "visits": model.visits.reshape(-1, n_actions),
        "reward_sums": model.reward_sums.reshape(-1, n_actions),
        "successor_offsets": offsets,
        "successor_states": model.pool_states[places],
        "successor_counts": model.pool_counts[places],
    }
    return {prefix + name: array for name, array in arrays.items()}


def _places(model: SparseModel) -> Ints:
    """Where in the pool the successors lie, those of one pair after those of another."""
    ends = np.cumsum(model.length, dtype=np.int64)
    places: Ints = np.arange(ends[-1]) + np.repeat(model.first - ends + model.length, model.length)
    return places


def cap(model: SparseModel, most: float) -> None:
    """Scale what is known of each pair tried more often than `most` to that: a prior of this strength."""
    share = np.minimum(1.0, most / np.maximum(model.visits, most))
    model.pool_counts[_places(model)] *= np.repeat(share, model.length)
    model.visits[:] = np.where(model.visits > most, most, model.visits)
    model.reward_sums[:] *= share


MOST_OF_ONE = 100
"""As how many visits those of a pair count at most, where several models become one."""


def pooled_models(several: Sequence[Saved], strength: float) -> Saved:
    """Saved models as one: n(s, a) visits count as min(n, 100), all together as `strength` at most.

    So that each has its say where all know much, whoever knows most where few do; weighted counts.
    """
    shares = [np.minimum(1.0, MOST_OF_ONE / np.maximum(each["visits"], 1)) for each in several]
    visits: Table = np.sum([each["visits"] * share for each, share in zip(several, shares, strict=True)], axis=0)
    scale = np.minimum(1.0, strength / np.maximum(visits, strength))
    shares = [share * scale for share in shares]
    rewards = [each["reward_sums"] * share for each, share in zip(several, shares, strict=True)]
    n_states = len(visits)
    keys, weight = [], []
    for each, share in zip(several, shares, strict=True):
        lengths = np.diff(each["successor_offsets"])
        keys.append(np.repeat(np.arange(len(lengths)), lengths) * n_states + each["successor_states"])
        weight.append(each["successor_counts"] * np.repeat(share.ravel(), lengths))
    found, place = np.unique(np.concatenate(keys), return_inverse=True)
    lengths = np.bincount(found // n_states, minlength=visits.size)
    return {
        "visits": np.minimum(visits, strength),
        "reward_sums": np.sum(rewards, axis=0),
        "successor_offsets": np.concatenate([[0], np.cumsum(lengths, dtype=np.int64)]),
        "successor_states": (found % n_states).astype(np.int32),
        "successor_counts": np.bincount(place, np.concatenate(weight), len(found)),
    }


def model_arrays(saved: Saved, prefix: str = "") -> Saved:
    """Those of an agent's arrays that are one model's, by their names without its `prefix`."""
    return {name: saved[prefix + name] for name in ARRAYS}


def declared_model(setting: Setting, prefix: str = "", *, weighted: bool = False) -> dict[str, Declared]:
    """What each array is that `saved_model` gives."""
    of_times = weights if weighted else counts
    states, actions = setting.n_states, setting.n_actions
    most = states * actions * states
    declared = {
        "visits": of_times(states, actions),
        "reward_sums": floats(states, actions),
        "successor_offsets": counts(states * actions + 1, high=most, dtype="<i8"),
        "successor_states": counts(None, high=states - 1),
        "successor_counts": weights(None) if weighted else counts(None, low=1),
    }
    return {prefix + name: array for name, array in declared.items()}


def restored_model(setting: Setting, saved: Saved, prefix: str = "") -> SparseModel:
    """The model that `saved_model` gave, with room for `setting.steps` further visits."""
    saved = model_arrays(saved, prefix)
    states, offsets = saved["successor_states"], saved["successor_offsets"]
    visits, reward_sums = saved["visits"].ravel(), saved["reward_sums"].ravel()
    lengths = np.diff(offsets).astype(np.int32)
    # each pair starts with just the room that it fills, and then doubles it as it would have
    model = empty_model(setting._replace(steps=setting.steps + 2 * len(states)), saved["visits"].dtype.type)
    model.visits[:] = visits
    model.reward_sums[:] = reward_sums
    np.divide(reward_sums, visits, out=model.mean_rewards, where=visits > 0)
    model.first[:] = offsets[:-1]
    model.room[:] = lengths
    model.length[:] = lengths
    model.pool_states[: len(states)] = states
    model.pool_counts[: len(states)] = saved["successor_counts"]
    model.pool_end[0] = len(states)
    return model
