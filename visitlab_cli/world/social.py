"""The task `social`: win the human's attention and make it move in the desired direction (paper, section 3.3)."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

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
from visitlab_cli.world.human import follows_in_direction, react
from visitlab_cli.world.lab import Lab, arena_of, move
from visitlab_cli.world.perception import Levels, Perception, begun, perceived
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import (
    Body,
    Scene,
    first_scene,
    next_scene,
    random_body,
    random_direction,
    with_aims,
)
from visitlab_cli.world.task import BEGIN_TRIAL, COUNT_ACTIONS, OBSERVE, STEP, TRAINING_TRIAL_STEPS

ARENA = 120
DIRECTION_CHANGE = 0.2
VISION_SPEED = 2

Ints = npt.NDArray[np.int64]


class Social(NamedTuple):
    """A square arena, a human, the probability `direction_change` of a new desired direction a step.

    `perception` is what the robot perceives of engagement.
    """

    lab: Lab
    geometry: Geometry
    human: Any  # of a kind that reacts
    trial_steps: int
    direction_change: float
    perception: Any = Levels()


def make_social(
    human: Any,
    trial_steps: int = TRAINING_TRIAL_STEPS,
    arena: int = ARENA,
    direction_change: float = DIRECTION_CHANGE,
    distances: Sequence[int] = DISTANCES,
    perception: Perception | None = None,
) -> Social:
    """The task in an arena of `arena` x `arena` cells, so wide that the human does not reach its borders."""
    lab, geometry = arena_of(arena), make_geometry(arena, arena, distances)
    return Social(lab, geometry, human, trial_steps, direction_change, perception or Levels())


class SocialStates(NamedTuple):
    """The parts of social state numbers, arrays of the same shape."""

    level: Ints
    distance: Ints
    desired_direction: Ints
    angle: Ints


def parts_of(states: npt.ArrayLike) -> SocialStates:
    """The parts of social states, the inverse of `social_state`."""
    rest, level = np.divmod(np.asarray(states, np.int64), N_LEVELS)
    rest, distance = np.divmod(rest, N_DISTANCES)
    angle, desired = np.divmod(rest, N_DIRECTIONS)
    return SocialStates(level, distance, desired, angle)


@kernel
def social_state(scene: Scene) -> int:
    """State index: level + 8 (distance + 5 (desired_direction + 8 angle))."""
    direction = scene.desired_direction + N_DIRECTIONS * scene.angle
    return scene.perceived_level + N_LEVELS * (scene.distance + N_DISTANCES * direction)


@kernel
def teleported(lab: Lab, scene: Scene, random: RandomState) -> Body:
    """The robot in the human's sight: where a move of speed 2 along the human's heading would end."""
    row, col = move(lab, scene.human_row, scene.human_col, scene.human_heading, VISION_SPEED, scene.open_doors)
    return Body(row, col, random_direction(random))


@BEGIN_TRIAL.of(Social)
def begin_trial(task: Social, last: Scene, random: RandomState) -> Scene:
    """The human in the middle; the robot's cell, both headings and the desired direction random."""
    robot = random_body(task.lab, random)
    human = Body(task.lab.rows // 2, task.lab.cols // 2, random_direction(random))
    desired = random_direction(random)
    first = with_aims(first_scene(task.lab, task.geometry, last, robot, human), desired, 0)
    return begun(task.perception, task.lab, task.geometry, first)  # type: ignore[no-any-return]


@STEP.of(Social)
def step(task: Social, scene: Scene, action: int, random: RandomState) -> tuple[Scene, float, float]:
    """A reward of 1 where the following human moved in the desired direction; then that may be redrawn."""
    if action == Action.GO_TO_HUMAN_VISION and scene.engagement == Engagement.NONE:
        robot = teleported(task.lab, scene, random)
    else:
        robot = acted(task.lab, scene, action)
    reaction = react(task.human, task.lab, task.geometry, scene, action, random)
    after = next_scene(task.lab, task.geometry, scene, robot, action, reaction)
    after = perceived(task.perception, task.lab, task.geometry, scene, after)
    reward = 1.0 if follows_in_direction(after, scene.desired_direction) else 0.0
    if happens(random, task.direction_change):
        after = with_aims(after, random_direction(random), 0)
    return after, reward, reward


@OBSERVE.of(Social)
def observe(task: Social, scene: Scene) -> int:
    """`social_state`, with the desired direction that holds next."""
    return social_state(scene)


@COUNT_ACTIONS.of(Social)
def count_actions(task: Social) -> int:
    """All that the robot can do."""
    return N_SOCIAL_ACTIONS
