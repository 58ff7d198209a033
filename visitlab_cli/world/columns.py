"""The table of what is known of a step: loop buffers, log descriptor, documentation and checks derive from it.

A simulation loop fills one `StepColumns` (a block of arrays, one row a message) and every other place asks
`COLUMNS` for names, log types, tasks and meanings.
"""

from enum import IntEnum
from typing import Annotated, NamedTuple, get_args, get_type_hints

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.enums import Action, Direction, InteractionLevel

NAVIGATION, GO_TO_HUMAN, SOCIAL, VISIT = TASKS = ("navigation", "go_to_human", "social", "visit")
WITH_HUMAN = (GO_TO_HUMAN, SOCIAL, VISIT)
WITH_ENGAGEMENT = (SOCIAL, VISIT)
WITH_GOAL = (NAVIGATION, VISIT)

FIXED32, FLOAT, BOOL, UINT32, ENUM = "fixed32", "float", "bool", "uint32", "enum"
DTYPES = {FIXED32: np.uint32, FLOAT: np.float32, BOOL: np.bool_, UINT32: np.uint8, ENUM: np.uint8}

Uint32s = npt.NDArray[np.uint32]
Floats = npt.NDArray[np.float32]
Bools = npt.NDArray[np.bool_]
Bytes = npt.NDArray[np.uint8]


class Column(NamedTuple):
    """One field of the log: `name`, protobuf type, `tasks` that have it, meaning; `enum` names its values."""

    kind: str
    tasks: tuple[str, ...]
    meaning: str
    enum: type[IntEnum] | None = None
    name: str = ""


class StepColumns(NamedTuple):
    """A block of steps as arrays of shape (rows,); a task leaves the columns that it lacks untouched."""

    trial: Annotated[Uint32s, Column(FIXED32, TASKS, "number of the trial, from 0")]
    step: Annotated[Uint32s, Column(FIXED32, TASKS, "step in the trial, from 1; 0 is the state it starts in")]
    state: Annotated[Uint32s, Column(FIXED32, TASKS, "index of the deciding module's state after the step")]
    action: Annotated[Bytes, Column(ENUM, TASKS, "what the deciding module chose", Action)]
    executed_action: Annotated[Bytes, Column(ENUM, (VISIT,), "what the robot did, never 29", Action)]
    explored: Annotated[Bools, Column(BOOL, TASKS, "the deciding module drew the action at random")]
    reward: Annotated[Floats, Column(FLOAT, TASKS, "the task's reward for this step")]
    social_reward: Annotated[Floats, Column(FLOAT, (VISIT,), "what the social module learned from")]
    robot_row: Annotated[Uint32s, Column(FIXED32, TASKS, "robot's row, 0 in the north")]
    robot_col: Annotated[Uint32s, Column(FIXED32, TASKS, "robot's column, 0 in the west")]
    robot_heading: Annotated[Bytes, Column(ENUM, TASKS, "where the robot faces", Direction)]
    human_row: Annotated[Uint32s, Column(FIXED32, WITH_HUMAN, "human's row")]
    human_col: Annotated[Uint32s, Column(FIXED32, WITH_HUMAN, "human's column")]
    human_heading: Annotated[Bytes, Column(ENUM, WITH_HUMAN, "where the human looks", Direction)]
    human_action: Annotated[
        Bytes,
        Column(ENUM, WITH_ENGAGEMENT, "human's move at the speed it drew, blocked or not, or STAY", Action),
    ]
    interaction_level: Annotated[
        Bytes, Column(ENUM, WITH_HUMAN, "0..4 who sees and faces whom, 5..7 engagement", InteractionLevel)
    ]
    distance: Annotated[Bytes, Column(UINT32, WITH_HUMAN, "category of the distance, 0 (close) to 4 (far)")]
    angle: Annotated[Bytes, Column(ENUM, WITH_HUMAN, "direction from the robot to the human", Direction)]
    desired_direction: Annotated[Bytes, Column(ENUM, WITH_ENGAGEMENT, "where the human should go", Direction)]
    goal_room: Annotated[Bytes, Column(UINT32, WITH_GOAL, "0..8, row by row from the north-west")]


def _columns() -> tuple[Column, ...]:
    hints = get_type_hints(StepColumns, include_extras=True)
    return tuple(get_args(hint)[1]._replace(name=name) for name, hint in hints.items())


COLUMNS: tuple[Column, ...] = _columns()


def columns_of(task: str) -> tuple[Column, ...]:
    """The columns that a `task` has, in the order of the log."""
    return tuple(column for column in COLUMNS if task in column.tasks)


def empty_columns(rows: int) -> StepColumns:
    """A block of `rows` steps, every array zero."""
    return StepColumns(*(np.zeros(rows, DTYPES[column.kind]) for column in COLUMNS))
