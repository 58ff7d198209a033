"""The paper's human: engagement, movement and gaze in one step, by six parameters (TASK.md, 'The human'; Table 1)."""

from typing import NamedTuple

from pydantic import Field

from visitlab_cli.compiled import kernel
from visitlab_cli.humans.base import HumanParameters, Probability, SpeedDistribution
from visitlab_cli.random_numbers import RandomState, happens, random_unit
from visitlab_cli.world.enums import N_DIRECTIONS, Action, Engagement, InteractionLevel
from visitlab_cli.world.geometry import Geometry, is_appropriate, sight
from visitlab_cli.world.human import REACT, is_gesture
from visitlab_cli.world.lab import Lab
from visitlab_cli.world.robot import move_of, moved
from visitlab_cli.world.scene import Reaction, Scene, human_of, random_direction, reaction


class Human(NamedTuple):
    """The six parameters of the paper's Table 1, probabilities a step; `p_S` as the chances of speeds 1 and 2."""

    p_speed_1: float
    p_speed_2: float
    p_H: float
    p_M: float
    p_O: float
    p_A: float
    p_P: float


class SixParameters(HumanParameters):
    """How a simulated human reacts to the robot (paper, section 3.4, Table 1); only `p_S` has no default."""

    p_S: SpeedDistribution = Field(description="probabilities of moving at speed 1, 2 and 3; they sum to 1")
    p_H: Probability = Field(default=0.0, description="failing hello: probability that a hello goes unnoticed")
    p_M: Probability = Field(default=0.0, description="random movement: probability of a move when not engaged")
    p_O: Probability = Field(
        default=0.0, description="random eye movement: probability of a new heading when not engaged"
    )
    p_A: Probability = Field(default=0.0, description="losing attention: probability of disengaging at each step")
    p_P: Probability = Field(
        default=0.0, description="pointing need: probability that 'come' must be followed by pointing"
    )

    def create(self) -> Human:
        """The numbers that the rules take."""
        p_speed_1, p_speed_2, _ = map(float, self.p_S)
        return Human(p_speed_1, p_speed_2, *(float(getattr(self, name)) for name in Human._fields[2:]))


@kernel
def random_speed(human: Human, random: RandomState) -> int:
    """A speed drawn from `p_S`: 1, 2 or 3."""
    chance = random_unit(random)
    if chance < human.p_speed_1:
        return 1
    return 2 if chance < human.p_speed_1 + human.p_speed_2 else 3


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
def behave(human: Human, lab: Lab, scene: Scene, engagement: int, action: int, random: RandomState) -> Reaction:
    """Movement, then gaze, of a human whose engagement after the robot's `action` in `scene` is decided."""
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
        body = moved(lab, body, human_action, scene.open_doors)
    heading = body.heading
    if engagement != Engagement.NONE:
        heading = towards_robot
    elif happens(random, human.p_O):
        heading = random_direction(random)
    return reaction(body.row, body.col, heading, engagement, human_action, scene.human_memory)


@REACT.of(Human)
def react(human: Human, lab: Lab, geometry: Geometry, scene: Scene, action: int, random: RandomState) -> Reaction:
    """Engagement, then movement, then gaze."""
    return behave(human, lab, scene, engage(human, geometry, scene, action, random), action, random)
