"""The human: engagement, movement and gaze in one step (TASK.md, 'The human'; paper, sections 3.3 and 3.4).

Everything the human perceives is as it was when the step began: it reacts to what the robot does in this step
from where both stood before it.
"""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, happens, random_unit
from visitlab_cli.world.enums import N_DIRECTIONS, Action, Engagement, InteractionLevel
from visitlab_cli.world.geometry import Geometry, is_appropriate, sight
from visitlab_cli.world.grid import Grid
from visitlab_cli.world.robot import move_of, moved
from visitlab_cli.world.scene import Body, Scene, human_of, random_direction


class Human(NamedTuple):
    """The six parameters of the paper's Table 1, probabilities a step; `p_S` as the chances of speeds 1 and 2."""

    p_speed_1: float
    p_speed_2: float
    p_H: float  # failing hello
    p_M: float  # random movement
    p_O: float  # random eye movement
    p_A: float  # losing attention
    p_P: float  # pointing need


def make_human(p_S: Sequence[float], p_H: float, p_M: float, p_O: float, p_A: float, p_P: float) -> Human:
    """The human with the speed distribution `p_S` over 1, 2, 3 cells a step."""
    return Human(*(float(number) for number in (p_S[0], p_S[1], p_H, p_M, p_O, p_A, p_P)))


@kernel
def random_speed(human: Human, random: RandomState) -> int:
    """A speed drawn from `p_S`: 1, 2 or 3."""
    chance = random_unit(random)
    if chance < human.p_speed_1:
        return 1
    return 2 if chance < human.p_speed_1 + human.p_speed_2 else 3


@kernel
def is_gesture(action: int) -> bool:
    """Whether the robot's action is a gesture, at which a following human stays."""
    return action == Action.HELLO or action == Action.COME or action == Action.POINT


@kernel
def engage(human: Human, geometry: Geometry, scene: Scene, action: int, random: RandomState) -> int:
    """The human's engagement after the robot's `action` in `scene`."""
    engagement = scene.engagement
    appropriate = is_appropriate(scene.distance)
    if not appropriate or (engagement != Engagement.NONE and happens(random, human.p_A)):
        engagement = Engagement.NONE.value
    if action == Action.HELLO and appropriate:
        north, east = scene.robot_row - scene.human_row, scene.human_col - scene.robot_col
        level = sight(geometry, north, east, scene.robot_heading, scene.human_heading)
        if level == InteractionLevel.BOTH_FACE or (
            level == InteractionLevel.ROBOT_FACES and not happens(random, human.p_H)
        ):
            engagement = max(engagement, Engagement.GREETED.value)
    elif action == Action.COME and engagement == Engagement.GREETED:
        needs_pointing = happens(random, human.p_P)
        engagement = Engagement.CALLED.value if needs_pointing else Engagement.FOLLOWING.value
    elif action == Action.POINT and engagement == Engagement.CALLED:
        engagement = Engagement.FOLLOWING.value
    return engagement


@kernel
def react(
    human: Human, grid: Grid, geometry: Geometry, scene: Scene, action: int, random: RandomState
) -> tuple[Body, int, int]:
    """The human's `(body, engagement, move or STAY)` after the robot's executed `action` in `scene`."""
    engagement = engage(human, geometry, scene, action, random)
    towards_robot = (scene.angle + N_DIRECTIONS // 2) % N_DIRECTIONS
    direction = -1
    if engagement == Engagement.NONE:
        if happens(random, human.p_M):
            direction = random_direction(random)
    elif engagement == Engagement.FOLLOWING and not is_gesture(action):
        direction = towards_robot
    body = human_of(scene)
    human_action = Action.STAY.value
    if direction >= 0:
        human_action = move_of(direction, random_speed(human, random))
        body = moved(grid, body, human_action)
    if engagement != Engagement.NONE:
        body = Body(body.row, body.col, towards_robot)
    elif happens(random, human.p_O):
        body = Body(body.row, body.col, random_direction(random))
    return body, engagement, human_action


@kernel
def follows_in_direction(scene: Scene, direction: int) -> bool:
    """Whether the human followed in this step with a move in `direction`, at any speed, blocked or not."""
    return (
        scene.engagement == Engagement.FOLLOWING
        and scene.human_action != Action.STAY
        and scene.human_action % N_DIRECTIONS == direction
    )
