"""What a task is to the loops: a record with `trial_steps`, and three operations."""

from visitlab_cli.compiled import Operation

TRAINING_TRIAL_STEPS = 20
VISIT_TRIAL_STEPS = 100


def _begin_trial(task, last, random):  # type: ignore[no-untyped-def]
    """The scene that a trial starts in; `last` is the scene the previous one ended in, or `NOWHERE`."""


def _step(task, scene, action, random):  # type: ignore[no-untyped-def]
    """One step: `(scene after, reward, the reward that the deciding module learns from)`."""


def _observe(task, scene):  # type: ignore[no-untyped-def]
    """The index of the state in which the deciding module chooses its next action."""


BEGIN_TRIAL = Operation(_begin_trial)
STEP = Operation(_step)
OBSERVE = Operation(_observe)
begin_trial = BEGIN_TRIAL.function
step = STEP.function
observe = OBSERVE.function
