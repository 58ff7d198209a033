"""Affordances as intents: which actions bring about what a robot may want, as learned; planning with these alone.

A pair (state s, action a) affords an intent I with P(I | s, a) = n(s, a, s' in I(s)) / n(s, a), 0 where it was never
tried. AF_k is the pairs that afford some intent with at least k.
"""

from collections.abc import Callable
from enum import StrEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import Saved, Setting
from visitlab_cli.agents.sparse_model import restored_model, sweep
from visitlab_cli.agents.symmetry import folded, unfolded
from visitlab_cli.world.enums import N_DIRECTIONS, N_DISTANCES, InteractionLevel
from visitlab_cli.world.geometry import CLOSEST_APPROPRIATE, FARTHEST_APPROPRIATE
from visitlab_cli.world.social import SocialStates, parts_of

Table = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

SWEEPS = 60


class Intent(StrEnum):
    """What the robot may want of its next step; the order is that of every array over intents."""

    FACES = "faces"
    """The human, that did not face the robot, does, or is engaged."""
    NEARS = "nears"
    """The distance, that was not appropriate, is."""
    ADVANCES = "advances"
    """Not engaged, engaged; greeted, called or following; called, following."""
    LEADS = "leads"
    """The human follows on, at an appropriate distance, and its next step goes in the desired direction."""
    KEEPS = "keeps"
    """The human follows on, at an appropriate distance."""


INTENTS = tuple(Intent)

_FACED = np.isin(np.arange(len(InteractionLevel)), (2, 4, 5, 6, 7))
_APPROPRIATE = np.isin(np.arange(N_DISTANCES), range(CLOSEST_APPROPRIATE, FARTHEST_APPROPRIATE + 1))


def _faces(before: SocialStates, after: SocialStates) -> Mask:
    comes: Mask = ~_FACED[before.level] & _FACED[after.level]
    return comes


def _nears(before: SocialStates, after: SocialStates) -> Mask:
    comes: Mask = ~_APPROPRIATE[before.distance] & _APPROPRIATE[after.distance]
    return comes


def _advances(before: SocialStates, after: SocialStates) -> Mask:
    greeted = InteractionLevel.GREETED.value
    comes: Mask = (after.level >= greeted) & (after.level > before.level)
    return comes


def _keeps(before: SocialStates, after: SocialStates) -> Mask:
    follows = InteractionLevel.FOLLOWS.value
    comes: Mask = (before.level == follows) & (after.level == follows) & _APPROPRIATE[after.distance]
    return comes


def _leads(before: SocialStates, after: SocialStates) -> Mask:
    towards_robot = (after.angle + N_DIRECTIONS // 2) % N_DIRECTIONS
    comes: Mask = _keeps(before, after) & (towards_robot == before.desired_direction)
    return comes


COMES_ABOUT: dict[Intent, Callable[[SocialStates, SocialStates], Mask]] = {
    Intent.FACES: _faces,
    Intent.NEARS: _nears,
    Intent.ADVANCES: _advances,
    Intent.LEADS: _leads,
    Intent.KEEPS: _keeps,
}
"""Whether a step from one state to another is what is wanted; the robot sees the human at `angle`."""


def chances(model: Saved) -> Table:
    """P(I | s, a) of a learned model, shape (intents, states, actions)."""
    visits, n_actions = model["visits"], model["visits"].shape[1]
    pairs = np.repeat(np.arange(visits.size), np.diff(model["successor_offsets"]))
    before, after = parts_of(pairs // n_actions), parts_of(model["successor_states"])
    times = [model["successor_counts"] * COMES_ABOUT[intent](before, after) for intent in INTENTS]
    counts = np.array([np.bincount(pairs, each, visits.size) for each in times])
    return (counts / np.maximum(visits.ravel(), 1)).reshape(len(INTENTS), *visits.shape)


def affording(found: Table, tried: Mask, threshold: float) -> Mask:
    """The pairs left by AF_k: those that afford an intent, and of a state without any all that were tried.

    Args:
        found: the `chances`.
        tried: which pairs were ever tried, shape (states, actions).
        threshold: k, above 0.
    """
    affords: Mask = np.any(found >= threshold, axis=0)
    return np.where(affords.any(axis=1, keepdims=True), affords, tried)


def entries(model: Saved, allowed: Mask) -> Any:
    """How many (s, a, s') a sweep over these pairs goes through."""
    return int(np.diff(model["successor_offsets"])[allowed.ravel()].sum())


def planned(setting: Setting, model: Saved, allowed: Mask, gamma: float, *, symmetric: bool) -> Table:
    """Q of `SWEEPS` sweeps over some pairs alone, from 0; -inf at the other actions of a state that has any, else 0.

    Args:
        setting: where the agent learned.
        model: what it learned; its rewards are not negative.
        allowed: the pairs, all tried, shape (states, actions).
        gamma: discount factor.
        symmetric: whether the model has rows of those states alone that stand for others; Q is of all.
    """
    kept = restored_model(setting._replace(steps=0), model)
    kept.visits[~allowed.ravel()] = 0
    q, values = np.zeros(allowed.shape), np.zeros(len(allowed))
    for _ in range(SWEEPS):
        sweep(kept, q, values, gamma, 1, False)
    q[~allowed & allowed.any(axis=1, keepdims=True)] = -np.inf
    return unfolded(folded({"q": q}))["q"] if symmetric else q
