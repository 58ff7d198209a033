"""What a human is to the tasks: a record with one operation, and what they ask of its reaction.

The kinds of human live in `humans/`, as the kinds of agent in `agents/`: a file a kind, with its parameters (a
pydantic model, from the YAML), its record (a NamedTuple of numbers and arrays, all that kernels see) and its
rules, registered with `REACT` for that record.
"""

from visitlab_cli.compiled import Operation, kernel
from visitlab_cli.world.enums import N_DIRECTIONS, Action, Engagement
from visitlab_cli.world.scene import Scene


def _react(human, lab, geometry, scene, action, random):  # type: ignore[no-untyped-def]
    """The human's `Reaction` to the robot's executed `action` in `scene`, changing `random`.

    Everything that it perceives is as it was when the step began: `scene` holds where both stood before it, and
    the human's memory.
    """


REACT = Operation(_react)
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
