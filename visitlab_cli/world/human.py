"""What a human is to the tasks: a record with one operation, and what they ask of its reaction.

The kinds of human live in `humans/`, as the kinds of agent in `agents/`: a file a kind, with its parameters (a
pydantic model, from the YAML), its record (a NamedTuple of numbers and arrays, all that kernels see) and its
rules, registered with `REACT` for that record.
"""

from visitlab_cli.compiled import Operation, array_kernel, kernel
from visitlab_cli.errors import AnswerError
from visitlab_cli.world.enums import N_DIRECTIONS, Action, Engagement
from visitlab_cli.world.lab import SOLID
from visitlab_cli.world.scene import Scene


def _react(human, lab, geometry, scene, action, random):  # type: ignore[no-untyped-def]
    """The human's `Reaction` to the robot's executed `action` in `scene`, changing `random`.

    Everything that it perceives is as it was when the step began: `scene` holds where both stood before it, and
    the human's memory.
    """


class NoReactionError(AnswerError):
    """A human answered what is no reaction."""

    def __init__(self, row: int, col: int, heading: int, engagement: int, human_action: int) -> None:
        """With what it answered."""
        words = f"the cell {row}, {col}, but nobody can be there"
        for name, value, last in (
            ("human_heading", heading, N_DIRECTIONS - 1),
            ("engagement", engagement, LAST_ENGAGEMENT),
            ("human_action", human_action, int(Action.STAY)),
        ):
            if not 0 <= value <= last:
                words = f"{name} {value}, but that goes from 0 to {last}"
        super().__init__(f"react answered {words}")


LAST_ENGAGEMENT = int(max(Engagement))


@array_kernel  # for what is raised with numbers takes memory
def _refuse(row: int, col: int, heading: int, engagement: int, human_action: int) -> None:
    raise NoReactionError(row, col, heading, engagement, human_action)


def _check(human, lab, geometry, scene, action, random, answer):  # type: ignore[no-untyped-def]
    """That a reaction is one: what follows takes it as an index."""
    row, col = answer.human_row, answer.human_col
    heading, engagement, human_action = answer.human_heading, answer.engagement, answer.human_action
    somewhere = 0 <= row < lab.rows and 0 <= col < lab.cols and lab.rooms[row, col] != SOLID
    known = 0 <= heading < N_DIRECTIONS and 0 <= engagement <= LAST_ENGAGEMENT
    if not (somewhere and known and 0 <= human_action <= Action.STAY):
        _refuse(row, col, heading, engagement, human_action)


REACT = Operation(_react, check=_check)
react = REACT.function

GESTURES = (Action.HELLO.value, Action.COME.value, Action.POINT.value)
"""What the robot does that moves nothing, and at which a following human stays."""


@kernel
def is_gesture(action: int) -> bool:
    """Whether the robot's action is a gesture, at which a following human stays."""
    return action in GESTURES


@kernel
def follows_in_direction(scene: Scene, direction: int) -> bool:
    """Whether the human followed in this step with a move in `direction`, at any speed, blocked or not."""
    return (
        scene.engagement == Engagement.FOLLOWING
        and scene.human_action != Action.STAY
        and scene.human_action % N_DIRECTIONS == direction
    )
