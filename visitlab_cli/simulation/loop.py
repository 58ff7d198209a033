"""The loop: an agent plays a task for a block of steps into preallocated columns.

Between blocks come recording, progress and interruption. A cursor, the agent's arrays and the random state are
all there is to a checkpoint: a block more or less never changes a result.
"""

from typing import Any, NamedTuple

from visitlab_cli.agents.base import choose, learn, tell
from visitlab_cli.agents.exploration import Table
from visitlab_cli.compiled import Operation, Precaution, array_kernel, kernel, written
from visitlab_cli.errors import AnswerError
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.columns import StepColumns
from visitlab_cli.world.enums import Action
from visitlab_cli.world.scene import NOWHERE, Scene
from visitlab_cli.world.task import begin_trial, count_actions, observe, step

BLOCK_ROWS = 8192


class Cursor(NamedTuple):
    """Where a cell's simulation stands."""

    scene: Scene
    state: int
    trial: int  # number of the current trial
    trial_step: int  # steps taken in it; -1 before its start
    steps: int  # steps taken in the cell


START = Cursor(NOWHERE, 0, 0, -1, 0)


def _decide(task, agent, scene, state, step, random):  # type: ignore[no-untyped-def]
    """The action of the agent's `step` (from 1) and whether it was drawn at random, for `state` of `scene`."""


def _agent_decides(task, agent, scene, state, step, random):  # type: ignore[no-untyped-def]
    return choose(agent, state, step, random)


DECIDE = Operation(_decide, otherwise=_agent_decides)
"""Of a task in which not the agent alone decides."""
decide = DECIDE.function


class NoActionError(AnswerError):
    """An agent chose an action that there is not."""

    def __init__(self, action: int, n_actions: int, trial: int, step: int) -> None:
        """At a step of a trial, counted as in the log."""
        answer = f"choose answered {action}, but actions go from 0 to {n_actions - 1}"
        super().__init__(answer, f"trial {trial}, step {step}")


@array_kernel  # for what is raised with numbers takes memory
def _refuse(action: int, n_actions: int, trial: int, step: int) -> None:
    raise NoActionError(action, n_actions, trial, step)


def _check_action(agent: Any, action: int, n_actions: int, trial: int, step: int) -> None:
    """That there is such an action: what follows takes it as an index."""
    if action < 0 or action >= n_actions:
        _refuse(action, n_actions, trial, step)


check_action = Precaution(_check_action).function


_write_scene = written(
    "write_scene",
    "columns, row, scene",
    [f"columns.{name}[row] = scene.{name}" for name in StepColumns._fields if name in Scene._fields],
)
"""What the log keeps of a scene: the columns that are called as its fields."""


@kernel
def write_row(
    columns: StepColumns, row: int, trial: int, trial_step: int, state: int, scene: Scene, action: int
) -> None:
    """Write what is known of a moment; rewards and `explored` are the loop's to add."""
    columns.trial[row] = trial
    columns.step[row] = trial_step
    columns.state[row] = state
    columns.action[row] = action
    _write_scene(columns, row, scene)


@kernel
def play(
    task: Any,
    agent: Any,
    cursor: Cursor,
    steps: int,
    random: RandomState,
    columns: StepColumns,
    trial_rewards: Table,
) -> tuple[Cursor, int]:
    """Play until the columns are full or `steps` steps of the cell are done.

    Args:
        task: the task's record.
        agent: the agent's record, changed in place.
        cursor: where to go on; `START` for a new cell.
        steps: the cell's length.
        random: the cell's stream, changed in place.
        columns: arrays of shape (rows,), filled from row 0: one row a step, and one for each trial's start.
        trial_rewards: shape (trials,), added to.

    Returns:
        The cursor after the last row, and the number of rows written.
    """
    scene, state, trial, trial_step, done = (
        cursor.scene,
        cursor.state,
        cursor.trial,
        cursor.trial_step,
        cursor.steps,
    )
    row, n_actions = 0, count_actions(task)
    while row < len(columns.trial) and done < steps:
        if trial_step == task.trial_steps:
            trial, trial_step = trial + 1, -1
        trial_step += 1
        if trial_step == 0:
            scene = begin_trial(task, scene, random)
            state = observe(task, scene)
            write_row(columns, row, trial, 0, state, scene, Action.NO_ACTION.value)
            columns.explored[row] = False
            columns.reward[row] = 0.0
            columns.social_reward[row] = 0.0
        else:
            done += 1
            action, explored = decide(task, agent, scene, state, done, random)
            check_action(agent, action, n_actions, trial, trial_step)
            scene, reward, lesson = step(task, scene, action, random)
            next_state = observe(task, scene)
            learn(agent, state, action, lesson, next_state, trial_step == task.trial_steps, done, random)
            state = next_state
            write_row(columns, row, trial, trial_step, state, scene, action)
            columns.explored[row] = explored
            columns.reward[row] = reward
            columns.social_reward[row] = lesson
            trial_rewards[trial] += reward
        tell(agent, columns, row)
        row += 1
    return Cursor(scene, state, trial, trial_step, done), row
