"""A scene: where robot and human are, what they just did and how they stand to each other. Immutable."""

from typing import NamedTuple

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.enums import N_DIRECTIONS, Engagement, InteractionLevel
from visitlab_cli.world.geometry import Geometry, sight
from visitlab_cli.world.grid import Grid


class Scene(NamedTuple):
    """One moment of a task, all integers; a task leaves what it lacks at 0."""

    robot_row: int
    robot_col: int
    robot_heading: int
    human_row: int
    human_col: int
    human_heading: int
    engagement: int
    executed_action: int  # of the robot in the step that led here
    human_action: int  # of the human in that step
    interaction_level: int
    distance: int
    angle: int
    desired_direction: int
    goal_room: int


class Body(NamedTuple):
    """A cell and a heading."""

    row: int
    col: int
    heading: int


NOWHERE = Scene(0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, -1)
"""What a task's first trial follows: no goal room and no desired direction to carry over."""


@kernel
def scene_of(
    geometry: Geometry,
    robot: Body,
    human: Body,
    engagement: int,
    executed_action: int,
    human_action: int,
    desired_direction: int,
    goal_room: int,
) -> Scene:
    """The scene of these bodies, with the distance, angle and interaction level that follow from them."""
    north, east = robot.row - human.row, human.col - robot.col
    place = north + geometry.reach, east + geometry.reach
    if engagement == Engagement.NONE:
        level = sight(geometry, north, east, robot.heading, human.heading)
    else:
        level = engagement + InteractionLevel.BOTH_FACE.value
    return Scene(
        robot.row,
        robot.col,
        robot.heading,
        human.row,
        human.col,
        human.heading,
        engagement,
        executed_action,
        human_action,
        level,
        int(geometry.distance[place]),
        int(geometry.angle[place]),
        desired_direction,
        goal_room,
    )


@kernel
def robot_of(scene: Scene) -> Body:
    """The robot's body."""
    return Body(scene.robot_row, scene.robot_col, scene.robot_heading)


@kernel
def human_of(scene: Scene) -> Body:
    """The human's body."""
    return Body(scene.human_row, scene.human_col, scene.human_heading)


@kernel
def random_direction(random: RandomState) -> int:
    """A direction, uniform over the eight."""
    return random_below(random, N_DIRECTIONS)


@kernel
def random_body(grid: Grid, random: RandomState) -> Body:
    """A cell and a heading, uniform over the grid."""
    return Body(random_below(random, grid.rows), random_below(random, grid.cols), random_direction(random))


@kernel
def with_aims(scene: Scene, desired_direction: int, goal_room: int) -> Scene:
    """The same scene with another desired direction and goal room."""
    return Scene(
        scene.robot_row,
        scene.robot_col,
        scene.robot_heading,
        scene.human_row,
        scene.human_col,
        scene.human_heading,
        scene.engagement,
        scene.executed_action,
        scene.human_action,
        scene.interaction_level,
        scene.distance,
        scene.angle,
        desired_direction,
        goal_room,
    )
