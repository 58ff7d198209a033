"""What a social module has seen follow what: the learned Fig. 4 of the paper, from its transition counts.

The module's 30 actions are gathered into kinds: a move by its direction against that to the human (towards it,
within 45 degrees; away from it, within 45 degrees of straight away; sideways), each other action by itself.
"""

from collections.abc import Mapping
from enum import StrEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.enums import (
    N_DIRECTIONS,
    N_DISTANCES,
    N_LEVELS,
    N_MOVES,
    N_SOCIAL_ACTIONS,
    Action,
)
from visitlab_cli.world.social import Ints, parts_of

Levels = npt.NDArray[np.int64] | npt.NDArray[np.float64]
"""Counts by kind of action, level, distance and next level: whole ones, or such that fade."""


class Kind(StrEnum):
    """A kind of action; the order is that of every array over kinds."""

    TOWARDS = "towards"
    SIDEWAYS = "sideways"
    AWAY = "away"
    STAY = "stay"
    LOOK = "look"
    HELLO = "hello"
    COME = "come"
    POINT = "point"
    GO_TO_HUMAN_VISION = "go_to_human_vision"


KINDS = tuple(Kind)
KIND_OF_TURN = (0, 0, 1, 2, 2, 2, 1, 0)
"""Index of a move's kind by the eighths of a circle from the direction to the human to its own."""


def kind_of(actions: npt.ArrayLike, angle: npt.ArrayLike) -> Ints:
    """The index in `KINDS` of social actions, `angle` being the direction to the human; any shape."""
    chosen = np.asarray(actions, np.int64)
    turn = (chosen - np.asarray(angle, np.int64)) % N_DIRECTIONS
    others = chosen - Action.STAY + KINDS.index(Kind.STAY)
    return np.where(chosen < N_MOVES, np.array(KIND_OF_TURN)[turn], others)


def count_levels(
    states: npt.ArrayLike, actions: npt.ArrayLike, next_states: npt.ArrayLike, times: npt.ArrayLike = 1
) -> Levels:
    """How often each kind of action led from level to level, shape (kinds, levels, distances, next levels).

    Args:
        states: social states, shape (n,).
        actions: social actions, shape (n,).
        next_states: the states that followed, shape (n,).
        times: how often each happened, shape (n,), in parts where counts fade; once if not given.
    """
    before = parts_of(states)
    shape = len(KINDS), N_LEVELS, N_DISTANCES, N_LEVELS
    places = kind_of(actions, before.angle), before.level, before.distance, parts_of(next_states).level
    weights = np.asarray(times)
    counts: Levels = np.zeros(shape, np.int64)
    if weights.dtype.kind == "f":
        counts = np.zeros(shape)
    np.add.at(counts, places, weights)
    return counts


def learned_counts(model: Mapping[str, npt.NDArray[Any]]) -> Levels:
    """`count_levels` of the transitions in the arrays of a social module's learned model."""
    pairs = np.repeat(np.arange(len(model["successor_offsets"]) - 1), np.diff(model["successor_offsets"]))
    states, actions = np.divmod(pairs, N_SOCIAL_ACTIONS)
    return count_levels(states, actions, model["successor_states"], model["successor_counts"])
