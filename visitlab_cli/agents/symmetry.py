"""The square's eight symmetries in the social task: which states and actions are the same but for a turn of the lab.

A symmetry takes each direction d to d + 2j or to 2j - d (modulo 8, j from 0 to 3): the angle, the desired direction and
a move's direction; level, distance and gestures stay. Of the states that symmetries make of one, the one with the
smallest (angle, desired direction) stands for all: 400 of 2,560. Exact in the open arena, a guess near a border.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, LEARN, Saved
from visitlab_cli.agents.base import choose as choose_of
from visitlab_cli.agents.base import choose_as as choose_as_of
from visitlab_cli.agents.base import learn as learn_of
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.enums import N_DIRECTIONS, N_DISTANCES, N_LEVELS, N_MOVES, N_SOCIAL_ACTIONS
from visitlab_cli.world.social import Ints, parts_of

N_QUARTERS = 4
N_STATES = N_LEVELS * N_DISTANCES * N_DIRECTIONS**2


class Fold(NamedTuple):
    """What stands for what, the first of the symmetries where several do: j ascending, turns before reflections."""

    kept: Ints  # the states that stand for others, ascending, shape (kept,)
    state: Ints  # the place in `kept` of what stands for a state, shape (states,)
    action: Ints  # what an action in a state is there, shape (states, actions)
    back: Ints  # and the other way, shape (states, actions)


class Symmetric(NamedTuple):
    """An agent that plays and learns in the states that stand for others; its tables have a row for each of these."""

    inner: tuple  # type: ignore[type-arg]  # the record of another agent
    fold: Fold
    meant: Ints  # scratch space, shape (actions,)


def symmetric(inner: tuple) -> Symmetric:  # type: ignore[type-arg]
    """An agent of the social task's kept states as one of all states."""
    return Symmetric(inner, fold(), np.arange(N_SOCIAL_ACTIONS))


@cache
def fold() -> Fold:
    """That of the social task."""
    states = np.arange(N_STATES)
    parts = parts_of(states)
    number = np.empty([int(part.max()) + 1 for part in parts], np.int64)
    number[tuple(parts)] = states
    best, chosen = states.copy(), np.zeros(N_STATES, np.int64)
    turned = np.array([_turned(symmetry, np.arange(N_DIRECTIONS)) for symmetry in range(2 * N_QUARTERS)])
    for symmetry, to in enumerate(turned):
        there = number[parts.level, parts.distance, to[parts.desired_direction], to[parts.angle]]
        better = _rank(there) < _rank(best)
        best[better], chosen[better] = there[better], symmetry
    actions = np.tile(np.arange(N_SOCIAL_ACTIONS), (len(turned), 1))
    moves = np.arange(N_MOVES)
    actions[:, :N_MOVES] = moves - moves % N_DIRECTIONS + turned[:, moves % N_DIRECTIONS]
    kept = np.unique(best)
    return Fold(kept, np.searchsorted(kept, best), actions[chosen], np.argsort(actions, axis=1)[chosen])


def _rank(states: Ints) -> Ints:
    """Which of the same states stands for the others: the first by angle, then by desired direction."""
    parts = parts_of(states)
    return parts.angle * N_DIRECTIONS + parts.desired_direction


def _turned(symmetry: int, directions: Ints) -> Ints:
    quarter, reflected = divmod(symmetry, 2)
    turned: Ints = ((-directions if reflected else directions) + 2 * quarter) % N_DIRECTIONS
    return turned


@CHOOSE.of(Symmetric)
def choose(agent: Symmetric, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """What the inner agent chooses in the state that stands for this one."""
    action, explored = choose_of(agent.inner, agent.fold.state[state], step, random)
    return agent.fold.back[state, action], explored


@CHOOSE_AS.of(Symmetric)
def choose_as(agent: Symmetric, state: int, meant: Ints, step: int, random: RandomState) -> tuple[int, bool]:
    """The same where each action is valued as the one it comes to."""
    fold = agent.fold
    for action in range(len(agent.meant)):
        agent.meant[action] = fold.action[state, meant[fold.back[state, action]]]
    action, explored = choose_as_of(agent.inner, fold.state[state], agent.meant, step, random)
    return fold.back[state, action], explored


@LEARN.of(Symmetric)
def learn(
    agent: Symmetric,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """The inner agent learns of the states that stand for these."""
    fold = agent.fold
    here, there = fold.state[state], fold.state[next_state]
    learn_of(agent.inner, here, fold.action[state, action], reward, there, end, step, random)


def unfolded(inner: Saved) -> Saved:
    """An inner agent's arrays as those of all states: `q` of each; counts in the rows of those that stand for some."""
    now = fold()
    outer = dict(inner)
    for name, array in inner.items():
        if name == "q":
            outer[name] = array[now.state[:, None], now.action]
        elif array.ndim == 2:
            outer[name] = _spread(array, (N_STATES, *array.shape[1:]))
    for name in _rows(inner):
        offsets, states = inner[f"{name}_offsets"], inner[f"{name}_states"]
        outer[f"{name}_offsets"] = _offsets(
            _spread(np.diff(offsets).reshape(len(now.kept), -1), now.action.shape), offsets.dtype
        )
        outer[f"{name}_states"] = now.kept[states].astype(states.dtype)
    return outer


def _rows(saved: Saved) -> list[str]:
    """The names of the compressed rows of states that a pair was followed by."""
    return [name.removesuffix("_offsets") for name in saved if name.endswith("_offsets")]


def _spread(rows: npt.NDArray[np.generic], shape: tuple[int, ...]) -> npt.NDArray[np.generic]:
    spread = np.zeros(shape, rows.dtype)
    spread[fold().kept] = rows
    return spread


def _offsets(lengths: npt.NDArray[np.generic], dtype: np.dtype[np.generic]) -> npt.NDArray[np.generic]:
    return np.concatenate([[0], np.cumsum(lengths)]).astype(dtype)


def folded(outer: Saved) -> Saved:
    """The inner agent's arrays again, of what `unfolded` gave."""
    now = fold()
    inner = {name: array[now.kept] if array.ndim == 2 else array for name, array in outer.items()}
    for name in _rows(outer):
        offsets, states = outer[f"{name}_offsets"], outer[f"{name}_states"]
        inner[f"{name}_offsets"] = _offsets(np.diff(offsets).reshape(N_STATES, -1)[now.kept], offsets.dtype)
        inner[f"{name}_states"] = now.state[states].astype(states.dtype)
    return inner


def fault_in_fold(outer: Saved) -> str | None:
    """Why arrays are not those of a symmetric agent; None where they are."""
    again = unfolded(folded(outer))
    wrong = [name for name, array in outer.items() if not np.array_equal(again[name], array)]
    return f"{wrong[0]} is not symmetric" if wrong else None
