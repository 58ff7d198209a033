"""The three modules as one (paper, section 4.1 and Fig. 5): a visit as the task that the social module plays.

Navigation gives the desired direction, the social module decides, and where it picks 'go to human vision' the
third module picks the move. Navigation and go_to_human act greedily and do not learn. A controller may do some of
this otherwise (`controller.py`).
"""

from typing import Any, NamedTuple

import numpy as np

from visitlab_cli.agents.exploration import Table, greedy
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.simulation.controller import Paper, Planned, approach, decide, observed, prepare, wanted
from visitlab_cli.simulation.loop import DECIDE
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS, N_MOVES, N_SOCIAL_ACTIONS, Action
from visitlab_cli.world.human import follows_in_direction
from visitlab_cli.world.lab import Lab, sees
from visitlab_cli.world.scene import Scene, with_aims
from visitlab_cli.world.social import social_state
from visitlab_cli.world.task import BEGIN_TRIAL, COUNT_ACTIONS, OBSERVE, STEP, VISIT_TRIAL_STEPS
from visitlab_cli.world.visit import VisitWorld, begin_visit, step_visit


class Visit(NamedTuple):
    """`direction_values` (goal rooms, rows, cols, 8) and `go_to_human` (states, actions) stand for two modules."""

    world: VisitWorld
    direction_values: Table
    go_to_human: Table
    trial_steps: int
    pays_social_reward: bool
    controller: Paper | Planned = Paper()


def make_visit(
    world: VisitWorld,
    navigation_q: Table,
    go_to_human_q: Table,
    trial_steps: int = VISIT_TRIAL_STEPS,
    social_reward: str = "social",
    controller: Paper | Planned | None = None,
) -> Visit:
    """A visit with the Q of the two modules, shapes (goal rooms * cells, 25) and (320, 25).

    `social_reward` is `social` or `none`; the `controller` is the paper's unless given.
    """
    direction_values = direction_values_of(navigation_q, world.lab)
    pays = social_reward == "social"
    return Visit(world, direction_values, go_to_human_q, trial_steps, pays, controller or Paper())


def direction_values_of(navigation_q: Table, lab: Lab) -> Table:
    """Navigation's Q averaged over the three speeds: shape (goal rooms, rows, cols, 8)."""
    moves = navigation_q[:, :N_MOVES].reshape(-1, MAX_SPEED, N_DIRECTIONS)
    total = moves[:, 0]
    for speed in range(1, MAX_SPEED):  # in this order: equal directions must come out exactly equal
        total = total + moves[:, speed]
    return np.ascontiguousarray(total / MAX_SPEED).reshape(lab.n_rooms, lab.rows, lab.cols, N_DIRECTIONS)


@kernel
def directed(task: Visit, scene: Scene, random: RandomState) -> Scene:
    """The scene with navigation's desired direction: the current one if it is among the best, else one of those."""
    values = task.direction_values[scene.goal_room, scene.human_row, scene.human_col]
    best = greedy(values, random)
    if values[scene.desired_direction] == values[best]:
        best = scene.desired_direction
    return with_aims(scene, best, scene.goal_room)


@BEGIN_TRIAL.of(Visit)
def begin_trial(task: Visit, last: Scene, random: RandomState) -> Scene:
    """The world's start, with a direction from navigation."""
    prepare(task.controller, task.direction_values)
    begun = directed(task, begin_visit(task.world, last, random), random)
    return wanted(task.controller, begun)  # type: ignore[no-any-return]


@STEP.of(Visit)
def step(task: Visit, scene: Scene, action: int, random: RandomState) -> tuple[Scene, float, float]:
    """One step: the reward of the visit, and the social one, which the social module learns from."""
    executed = action
    if action == Action.GO_TO_HUMAN_VISION:
        lab = task.world.lab
        seen = sees(lab, scene.robot_row, scene.robot_col, scene.human_row, scene.human_col, scene.open_doors)
        executed = approach(task.controller, task.go_to_human, scene, seen, random)
    after, reward = step_visit(task.world, scene, executed, random)
    social = 0.0
    if task.pays_social_reward and follows_in_direction(after, scene.desired_direction):
        social = 1.0
    observed(task.controller, scene, after)
    return wanted(task.controller, directed(task, after, random)), reward, social


@DECIDE.of(Visit)
def chosen(task: Visit, agent: Any, scene: Scene, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """As the controller decides."""
    return decide(task.controller, agent, scene, state, step, random)  # type: ignore[no-any-return]


@OBSERVE.of(Visit)
def observe(task: Visit, scene: Scene) -> int:
    """The social module's state."""
    return social_state(scene)


@COUNT_ACTIONS.of(Visit)
def count_actions(task: Visit) -> int:
    """Those of the social module."""
    return N_SOCIAL_ACTIONS
