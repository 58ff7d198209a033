"""Prioritized sweeping: after each step the states are backed up whose values should change the most (Moore, Atkeson 1993).

A backup of a state sets all its actions to their expected values by the learned model. When its value changes by d, each
pair that was seen to lead there with probability T has its state queued with gamma |d| T, where that is above `theta`.
"""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, CHOOSE_AS, EPSILON, GAMMA, LEARN, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, floats
from visitlab_cli.agents.exploration import Table, epsilon_greedy, epsilon_greedy_as
from visitlab_cli.agents.known_values import Known, expected, known_values, revalue, saved_known, untried
from visitlab_cli.agents.one_model import OneModelParameters
from visitlab_cli.agents.sparse_model import Counts, Ints, SparseModel, count, empty_model, restored_model
from visitlab_cli.compiled import kernel, long_kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT

FIRST = 1e300
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
    before: Ints
    end: Ints


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


class PrioritizedSweepingParameters(OneModelParameters):
    """Epsilon-greedy, with `backups` states a step backed up in the order of their priority."""

    plans: ClassVar[bool] = False
    takes_masks: ClassVar[bool] = True
    kind: Literal["prioritized_sweeping"]
    gamma: float = GAMMA
    epsilon: float = EPSILON
    backups: int = Field(default=5, ge=1, le=10**6, description="states that are backed up at each step, at most")
    theta: float = Field(default=1e-3, ge=0, description="the change of a value below which nothing is queued for it")
