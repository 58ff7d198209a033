"""The table of what is known of a step: loop buffers, log descriptor, documentation and checks derive from it.

A simulation loop fills one `StepColumns` (a block of arrays, one row a message) and every other place asks
`COLUMNS` for names, log types, tasks and meanings.
"""

from enum import IntEnum
from typing import Annotated, NamedTuple, get_args, get_type_hints

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.enums import DISTANCE_NAMES, Action, Direction, InteractionLevel

ALWAYS, HUMAN, ENGAGEMENT, GOAL, MODULES = "always", "human", "engagement", "goal", "modules"
"""What there may be in a task, and so what its log has columns for."""
PHASES, PLAN, MEMORY, DOORS, BELIEF, MODELS = SOME_CELLS = ("phases", "plan", "memory", "doors", "belief", "models")
"""What a cell may have beside what its task has: phases, a controller that plans where to lead, a human who remembers,
doors that are opened and shut between trials, a robot to whom engagement is hidden and who believes something of it,
an agent of several models.

The log of a cell without them does not know of their columns.
"""

FIXED32, SFIXED64, FLOAT, BOOL, UINT32, ENUM = "fixed32", "sfixed64", "float", "bool", "uint32", "enum"
DTYPES = {
    FIXED32: np.uint32,
    SFIXED64: np.int64,
    FLOAT: np.float32,
    BOOL: np.bool_,
    UINT32: np.uint8,
    ENUM: np.uint8,
}

_DISTANCES = ", ".join(f"{number} {name}" for number, name in enumerate(DISTANCE_NAMES))

Uint32s = npt.NDArray[np.uint32]
Int64s = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float32]
Bools = npt.NDArray[np.bool_]
Bytes = npt.NDArray[np.uint8]


class Column(NamedTuple):
    """One field of the log: its protobuf type, the `part` of a task it tells of, meaning, the `enum` of its values."""

    kind: str
    part: str
    meaning: str
    enum: type[IntEnum] | None = None
    name: str = ""


class StepColumns(NamedTuple):
    """A block of steps as arrays of shape (rows,); a task leaves the columns that it lacks untouched."""

    trial: Annotated[Uint32s, Column(FIXED32, ALWAYS, "number of the trial, from 0")]
    step: Annotated[Uint32s, Column(FIXED32, ALWAYS, "step in the trial, from 1; 0 is the state it starts in")]
    state: Annotated[Uint32s, Column(FIXED32, ALWAYS, "index of the deciding module's state after the step")]
    action: Annotated[Bytes, Column(ENUM, ALWAYS, "what the deciding module chose", Action)]
    executed_action: Annotated[Bytes, Column(ENUM, MODULES, "what the robot did, never 29", Action)]
    explored: Annotated[Bools, Column(BOOL, ALWAYS, "the deciding module drew the action at random")]
    reward: Annotated[Floats, Column(FLOAT, ALWAYS, "the task's reward for this step")]
    social_reward: Annotated[Floats, Column(FLOAT, MODULES, "what the social module learned from")]
    robot_row: Annotated[Uint32s, Column(FIXED32, ALWAYS, "robot's row, 0 in the north")]
    robot_col: Annotated[Uint32s, Column(FIXED32, ALWAYS, "robot's column, 0 in the west")]
    robot_heading: Annotated[Bytes, Column(ENUM, ALWAYS, "where the robot faces", Direction)]
    human_row: Annotated[Uint32s, Column(FIXED32, HUMAN, "human's row")]
    human_col: Annotated[Uint32s, Column(FIXED32, HUMAN, "human's column")]
    human_heading: Annotated[Bytes, Column(ENUM, HUMAN, "where the human looks", Direction)]
    human_action: Annotated[
        Bytes,
        Column(ENUM, ENGAGEMENT, "human's move at the speed it drew, blocked or not, or STAY", Action),
    ]
    interaction_level: Annotated[
        Bytes, Column(ENUM, HUMAN, "0..4 who sees and faces whom, 5..7 engagement", InteractionLevel)
    ]
    distance: Annotated[Bytes, Column(UINT32, HUMAN, f"category of the distance: {_DISTANCES}")]
    angle: Annotated[Bytes, Column(ENUM, HUMAN, "direction from the robot to the human", Direction)]
    desired_direction: Annotated[Bytes, Column(ENUM, ENGAGEMENT, "where the human should go", Direction)]
    goal_room: Annotated[
        Bytes, Column(UINT32, GOAL, "number of the room, 0..8 in the paper's lab: row by row from the north-west")
    ]
    phase: Annotated[Bytes, Column(UINT32, PHASES, "number of the phase, from 0")]
    plan_leads: Annotated[Bools, Column(BOOL, PLAN, "the plan picks the next action; without it the next four are 0")]
    wanted_robot_row: Annotated[Uint32s, Column(FIXED32, PLAN, "row that the plan sends the robot to")]
    wanted_robot_col: Annotated[Uint32s, Column(FIXED32, PLAN, "column that the plan sends the robot to")]
    wanted_human_row: Annotated[
        Uint32s, Column(FIXED32, PLAN, "row that the human should follow it to, two steps from now")
    ]
    wanted_human_col: Annotated[Uint32s, Column(FIXED32, PLAN, "column that the human should follow it to")]
    human_memory: Annotated[Int64s, Column(SFIXED64, MEMORY, "what the human remembers, 0 at a trial's start")]
    open_doors: Annotated[
        Int64s,
        Column(
            SFIXED64,
            DOORS,
            "which of the phase's doors are open in the trial, bit i for the i-th from 0; -1 where it has none",
        ),
    ]
    belief_none: Annotated[Floats, Column(FLOAT, BELIEF, "how likely the human is not engaged, to the robot's belief")]
    belief_greeted: Annotated[Floats, Column(FLOAT, BELIEF, "how likely it is greeted")]
    belief_called: Annotated[Floats, Column(FLOAT, BELIEF, "how likely it is called, and waits to be shown the way")]
    belief_following: Annotated[Floats, Column(FLOAT, BELIEF, "how likely it follows")]
    active_model: Annotated[Bytes, Column(UINT32, MODELS, "number of the model that the agent acts by, from 0")]
    evidence: Annotated[
        Floats,
        Column(
            FLOAT,
            MODELS,
            "in nats, the most that speaks for another model, which takes over above 30, or for a new one, made above "
            "80; which of them is not said",
        ),
    ]


def _columns() -> tuple[Column, ...]:
    hints = get_type_hints(StepColumns, include_extras=True)
    return tuple(get_args(hint)[1]._replace(name=name) for name, hint in hints.items())


COLUMNS: tuple[Column, ...] = _columns()


def empty_columns(rows: int) -> StepColumns:
    """A block of `rows` steps, every array zero."""
    return StepColumns(*(np.zeros(rows, DTYPES[column.kind]) for column in COLUMNS))
