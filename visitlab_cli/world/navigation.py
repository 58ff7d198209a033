"""The task `navigation`: reach the goal room and stay in it; no human (paper, sections 3.2 and 5)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.enums import Action, Direction
from visitlab_cli.world.lab import Lab, goals_of, paper_lab, random_cell
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import Body, Scene, acted_scene, before_trial, with_aims
from visitlab_cli.world.task import BEGIN_TRIAL, OBSERVE, STEP, TRAINING_TRIAL_STEPS


class Navigation(NamedTuple):
    """The lab, how many steps a trial has, and the rooms that goals are drawn from, shape (goals,)."""

    lab: Lab
    trial_steps: int
    goal_rooms: npt.NDArray[np.int64]


def make_navigation(trial_steps: int = TRAINING_TRIAL_STEPS, lab: Lab | None = None) -> Navigation:
    """Navigation in `lab`, the paper's unless given."""
    lab = lab or paper_lab()
    return Navigation(lab, trial_steps, np.array(goals_of(lab)))


@kernel
def navigation_state(lab: Lab, goal_room: int, row: int, col: int) -> int:
    """State index: goal_room * cells + row * width + col."""
    return (goal_room * lab.rows + row) * lab.cols + col


@BEGIN_TRIAL.of(Navigation)
def begin_trial(task: Navigation, last: Scene, random: RandomState) -> Scene:
    """A random cell, heading east, and a random goal room."""
    last = before_trial(task.lab, last, random)
    row, col = random_cell(task.lab, random)
    robot = Body(row, col, Direction.EAST.value)
    goal_room = task.goal_rooms[random_below(random, len(task.goal_rooms))]
    return with_aims(acted_scene(last, robot, Action.NO_ACTION.value), 0, goal_room)


@STEP.of(Navigation)
def step(task: Navigation, scene: Scene, action: int, random: RandomState) -> tuple[Scene, float, float]:
    """A reward of 1 where the step ends in the goal room."""
    robot = acted(task.lab, scene, action)
    reward = 1.0 if task.lab.rooms[robot.row, robot.col] == scene.goal_room else 0.0
    return acted_scene(scene, robot, action), reward, reward


@OBSERVE.of(Navigation)
def observe(task: Navigation, scene: Scene) -> int:
    """`navigation_state` of the robot's cell."""
    return navigation_state(task.lab, scene.goal_room, scene.robot_row, scene.robot_col)
