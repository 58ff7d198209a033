"""The task `social`: win the human's attention and make it move in the desired direction (paper, section 3.3)."""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, happens
from visitlab_cli.world.enums import (
    N_DIRECTIONS,
    N_DISTANCES,
    N_LEVELS,
    N_SOCIAL_ACTIONS,
    Action,
    Engagement,
)
from visitlab_cli.world.geometry import DISTANCES, Geometry, make_geometry
from visitlab_cli.world.grid import Grid, make_grid, move
from visitlab_cli.world.human import Human, follows_in_direction, react
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import Body, Scene, random_body, random_direction, robot_of, scene_of, with_aims
from visitlab_cli.world.task import BEGIN_TRIAL, OBSERVE, STEP, TRAINING_TRIAL_STEPS

N_STATES = N_LEVELS * N_DISTANCES * N_DIRECTIONS * N_DIRECTIONS
N_ACTIONS = N_SOCIAL_ACTIONS
ARENA = 120
DIRECTION_CHANGE = 0.2
VISION_SPEED = 2


class Social(NamedTuple):
    """A square arena, a human, and the probability `direction_change` of a new desired direction a step."""

    grid: Grid
    geometry: Geometry
    human: Human
    trial_steps: int
    direction_change: float


def make_social(
    human: Human,
    trial_steps: int = TRAINING_TRIAL_STEPS,
    arena: int = ARENA,
    direction_change: float = DIRECTION_CHANGE,
    distances: Sequence[int] = DISTANCES,
) -> Social:
    """The task in an arena of `arena` x `arena` cells, so wide that the human does not reach its borders."""
    return Social(make_grid(arena, arena), make_geometry(arena, distances), human, trial_steps, direction_change)


@kernel
def social_state(scene: Scene) -> int:
    """State index: level + 8 (distance + 5 (desired_direction + 8 angle))."""
    direction = scene.desired_direction + N_DIRECTIONS * scene.angle
    return scene.interaction_level + N_LEVELS * (scene.distance + N_DISTANCES * direction)


@kernel
def teleported(grid: Grid, scene: Scene, random: RandomState) -> Body:
    """The robot in the human's sight: where a move of speed 2 along the human's heading would end."""
    row, col = move(grid, scene.human_row, scene.human_col, scene.human_heading, VISION_SPEED)
    return Body(row, col, random_direction(random))


@BEGIN_TRIAL.of(Social)
def begin_trial(task: Social, last: Scene, random: RandomState) -> Scene:
    """The human in the middle; the robot's cell, both headings and the desired direction random."""
    robot = random_body(task.grid, random)
    human = Body(task.grid.rows // 2, task.grid.cols // 2, random_direction(random))
    desired = random_direction(random)
    none, no_action, stay = Engagement.NONE.value, Action.NO_ACTION.value, Action.NO_ACTION.value
    return scene_of(task.geometry, robot, human, none, no_action, stay, desired, 0)


@STEP.of(Social)
def step(task: Social, scene: Scene, action: int, random: RandomState) -> tuple[Scene, float, float]:
    """A reward of 1 where the following human moved in the desired direction; then that may be redrawn."""
    if action == Action.GO_TO_HUMAN_VISION and scene.engagement == Engagement.NONE:
        robot = teleported(task.grid, scene, random)
    else:
        robot = acted(task.grid, robot_of(scene), action, scene.angle)
    human, engagement, human_action = react(task.human, task.grid, task.geometry, scene, action, random)
    desired = scene.desired_direction
    after = scene_of(task.geometry, robot, human, engagement, action, human_action, desired, 0)
    reward = 1.0 if follows_in_direction(after, desired) else 0.0
    if happens(random, task.direction_change):
        after = with_aims(after, random_direction(random), 0)
    return after, reward, reward


@OBSERVE.of(Social)
def observe(task: Social, scene: Scene) -> int:
    """`social_state`, with the desired direction that holds next."""
    return social_state(scene)
