"""What a task is to the loops: a record with `trial_steps`, and four operations."""

from typing import Any

from visitlab_cli.compiled import Operation
from visitlab_cli.world.enums import N_PHYSICAL_ACTIONS

TRAINING_TRIAL_STEPS = 20
VISIT_TRIAL_STEPS = 100


def _begin_trial(task, last, random):  # type: ignore[no-untyped-def]
    """The scene that a trial starts in; `last` is the scene the previous one ended in, or `NOWHERE`."""


def _step(task, scene, action, random):  # type: ignore[no-untyped-def]
    """One step: `(scene after, reward, the reward that the deciding module learns from)`."""


def _observe(task, scene):  # type: ignore[no-untyped-def]
    """The index of the state in which the deciding module chooses its next action."""


def _count_actions(task):  # type: ignore[no-untyped-def]
    """How many actions the deciding module has."""


def _physical_actions(task: Any) -> int:
    return N_PHYSICAL_ACTIONS


BEGIN_TRIAL = Operation(_begin_trial)
STEP = Operation(_step)
OBSERVE = Operation(_observe)
COUNT_ACTIONS = Operation(_count_actions, otherwise=_physical_actions)
"""All the physical ones, unless a task has more."""
begin_trial = BEGIN_TRIAL.function
step = STEP.function
observe = OBSERVE.function
count_actions = COUNT_ACTIONS.function
