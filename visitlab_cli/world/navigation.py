"""The task `navigation`: reach the goal room and stay in it; no human (paper, sections 3.2 and 5)."""

from typing import NamedTuple

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.enums import N_PHYSICAL_ACTIONS, Action, Direction
from visitlab_cli.world.grid import LAB_SIZE, N_ROOMS, Grid, make_grid, room_of
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import Scene, robot_of
from visitlab_cli.world.task import BEGIN_TRIAL, OBSERVE, STEP, TRAINING_TRIAL_STEPS

N_STATES = N_ROOMS * LAB_SIZE * LAB_SIZE
N_ACTIONS = N_PHYSICAL_ACTIONS


class Navigation(NamedTuple):
    """The lab and how many steps a trial has."""

    grid: Grid
    trial_steps: int


def make_navigation(trial_steps: int = TRAINING_TRIAL_STEPS) -> Navigation:
    """Navigation in the lab of 24 x 24 cells."""
    return Navigation(make_grid(LAB_SIZE, LAB_SIZE), trial_steps)


@kernel
def navigation_state(goal_room: int, row: int, col: int) -> int:
    """State index: goal_room * cells + row * width + col."""
    return goal_room * (LAB_SIZE * LAB_SIZE) + row * LAB_SIZE + col


@kernel
def _scene(row: int, col: int, heading: int, action: int, goal_room: int) -> Scene:
    return Scene(row, col, heading, 0, 0, 0, 0, action, 0, 0, 0, 0, 0, goal_room)


@BEGIN_TRIAL.of(Navigation)
def begin_trial(task: Navigation, last: Scene, random: RandomState) -> Scene:
    """A random cell, heading east, and a random goal room."""
    row, col = random_below(random, task.grid.rows), random_below(random, task.grid.cols)
    return _scene(row, col, Direction.EAST.value, Action.NO_ACTION.value, random_below(random, N_ROOMS))


@STEP.of(Navigation)
def step(task: Navigation, scene: Scene, action: int, random: RandomState) -> tuple[Scene, float, float]:
    """A reward of 1 where the step ends in the goal room."""
    robot = acted(task.grid, robot_of(scene), action, 0)
    reward = 1.0 if room_of(robot.row, robot.col) == scene.goal_room else 0.0
    return _scene(robot.row, robot.col, robot.heading, action, scene.goal_room), reward, reward


@OBSERVE.of(Navigation)
def observe(task: Navigation, scene: Scene) -> int:
    """`navigation_state` of the robot's cell."""
    return navigation_state(scene.goal_room, scene.robot_row, scene.robot_col)
