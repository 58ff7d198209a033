"""The exact optimum of the social task for who sees all: both bodies, engagement, desired direction, steps left.

Where both stand matters only relative to one another, as long as nobody meets the arena's border. Offsets are
clipped one cell beyond where an engaged human may be found (12 cells in the paper): from there on teleporting is best,
and what it leads to depends on no offset. An agent on the task's 2,560 states knows less.
"""

from collections import deque
from collections.abc import Sequence
from functools import cache, lru_cache

import numpy as np

from visitlab_cli.exact.kept import kept
from visitlab_cli.exact.social_induction import Induction, direction_blind
from visitlab_cli.exact.social_model import Floats, SocialModel, social_model
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.world.enums import MAX_SPEED, Engagement
from visitlab_cli.world.geometry import DISTANCES, FARTHEST_APPROPRIATE
from visitlab_cli.world.social import ARENA, DIRECTION_CHANGE
from visitlab_cli.world.task import TRAINING_TRIAL_STEPS

MOST_STEPS, FARTHEST = 200, 12
"""Longer trials, or interaction from farther, in cells, would take more than minutes or memory is there for."""

OPTIMAL, RANDOM = "optimal", "random"


def optimum(
    human: HumanParameters,
    trial_steps: int = TRAINING_TRIAL_STEPS,
    arena: int = ARENA,
    direction_change: float = DIRECTION_CHANGE,
    distances: Sequence[int] = DISTANCES,
) -> float:
    """The largest expected sum of rewards in a social trial; the start is random as in training.

    Computed once, about ten seconds for a trial of 20 steps, and kept in the user's cache folder.

    Args:
        human: its parameters, of the paper's kind.
        trial_steps: steps in a trial, 1 to 200.
        arena: side of the square world, in cells, at least twice as large as the human walks in a trial.
        direction_change: probability that the desired direction is redrawn after a step.
        distances: the four thresholds of distance, in cells.

    Raises:
        ValueError: the optimum of these is not known; the message says why.
    """
    return _value(OPTIMAL, human, trial_steps, arena, direction_change, tuple(distances))


def random_reward(
    human: HumanParameters,
    trial_steps: int = TRAINING_TRIAL_STEPS,
    arena: int = ARENA,
    direction_change: float = DIRECTION_CHANGE,
    distances: Sequence[int] = DISTANCES,
) -> float:
    """The expected sum of rewards of uniformly random actions, within a thousandth: offsets are clipped for them, too.

    Arguments and errors are those of `optimum`.
    """
    return _value(RANDOM, human, trial_steps, arena, direction_change, tuple(distances))


def unknown(human: HumanParameters | None, trial_steps: int, arena: int, distances: Sequence[int]) -> str:
    """Why the exact values of a social task are not known; empty where they are."""
    if type(human) is not SixParameters:
        return "the human's rules are not the paper's"
    if not 1 <= trial_steps <= MOST_STEPS:
        return f"a trial has 1 to {MOST_STEPS} steps where the optimum is known, not {trial_steps}"
    fastest = max(speed for speed, chance in enumerate(human.p_S, 1) if chance > 0)
    if 2 * fastest * trial_steps > arena:
        return f"the human may meet the border of an arena of {arena} cells in {trial_steps} steps"
    if distances[FARTHEST_APPROPRIATE] > FARTHEST:
        return f"interaction is at up to {FARTHEST} cells where the optimum is known, not {distances[-1]}"
    return ""


@cache
def _value(
    which: str, human: HumanParameters, steps: int, arena: int, direction_change: float, distances: tuple[int, ...]
) -> float:
    """The mean over random starts."""
    if why := unknown(human, steps, arena, distances):
        raise ValueError(why)

    def compute() -> float:
        model = model_of(human, direction_change, distances)
        if which == RANDOM:
            return mean_over_starts(model, Induction(direction_blind(model)).random(steps), arena)
        (values, _) = deque(Induction(model).optimal(steps), maxlen=1).pop()
        return mean_over_starts(model, values, arena)

    numbers = tuple(human.create())
    return kept(compute, "social", which, numbers, int(steps), int(arena), float(direction_change), distances)


@lru_cache(maxsize=1)
def model_of(human: HumanParameters, direction_change: float, distances: tuple[int, ...]) -> SocialModel:
    """The tables of a human, as far out as an engaged one may be found, and a cell farther."""
    reach = distances[FARTHEST_APPROPRIATE] + 2 * MAX_SPEED + 1
    return social_model(human.create(), distances, reach, direction_change)


def mean_over_starts(model: SocialModel, values: Floats, arena: int) -> float:
    """The mean of values over the states in which trials start; what is farther than the tables' reach lies there.

    Args:
        model: of a human.
        values: as `Induction.nothing`.
        arena: side of the square world, in cells, in whose middle the human starts.
    """
    reach = model.reach
    offsets = np.clip(np.arange(arena) - arena // 2, -reach, reach) + reach
    weight = np.bincount(offsets, minlength=2 * reach + 1) / arena
    headings, _, side, _ = model.sees.shape
    starts = values.reshape(-1, headings, side, side, *values.shape[1:])[Engagement.NONE]
    return float(np.einsum("r,c,rc->", weight, weight, starts.mean(axis=(0, 3, 4))))
