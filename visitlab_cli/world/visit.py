"""The global task `visit`: lead the human from goal room to goal room (paper, section 3.1).

These are the world's rules only; where the desired direction and the executed action come from is the matter of
the three modules (`simulation/visit.py`).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.enums import Action, Engagement
from visitlab_cli.world.geometry import DISTANCES, Geometry, make_geometry
from visitlab_cli.world.grid import LAB_SIZE, N_ROOMS, Grid, make_grid, room_of
from visitlab_cli.world.human import Human, react
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import Scene, random_body, random_direction, robot_of, scene_of, with_aims


class VisitWorld(NamedTuple):
    """The lab, the human in it, and the rooms that goals are drawn from, shape (at least 2,)."""

    grid: Grid
    geometry: Geometry
    human: Human
    goal_rooms: npt.NDArray[np.int64]


def make_visit_world(
    human: Human, goal_rooms: Sequence[int] = tuple(range(N_ROOMS)), distances: Sequence[int] = DISTANCES
) -> VisitWorld:
    """The lab of 24 x 24 cells with goals among `goal_rooms`."""
    geometry = make_geometry(LAB_SIZE, distances)
    return VisitWorld(make_grid(LAB_SIZE, LAB_SIZE), geometry, human, np.array(goal_rooms, np.int64))


@kernel
def begin_visit(world: VisitWorld, last: Scene, random: RandomState) -> Scene:
    """All cells and headings random; goal room and desired direction carry over from `last`, or are random."""
    robot = random_body(world.grid, random)
    human = random_body(world.grid, random)
    desired, goal_room = last.desired_direction, last.goal_room
    if goal_room < 0:
        desired = random_direction(random)
        goal_room = world.goal_rooms[random_below(random, len(world.goal_rooms))]
    none, no_action = Engagement.NONE.value, Action.NO_ACTION.value
    return scene_of(world.geometry, robot, human, none, no_action, no_action, desired, goal_room)


@kernel
def another_goal(world: VisitWorld, goal_room: int, random: RandomState) -> int:
    """A goal room other than `goal_room`, uniform over the rest."""
    others = 0
    for room in world.goal_rooms:
        if room != goal_room:
            others += 1
    left = random_below(random, others)
    for room in world.goal_rooms:
        if room != goal_room:
            if left == 0:
                return room  # type: ignore[no-any-return]
            left -= 1
    return goal_room


@kernel
def step_visit(world: VisitWorld, scene: Scene, action: int, random: RandomState) -> tuple[Scene, float]:
    """The robot's executed `action`: the scene after it, and 1 where the human stands in the goal room.

    Then another goal room is drawn; the desired direction is left as it was.
    """
    robot = acted(world.grid, robot_of(scene), action, scene.angle)
    human, engagement, human_action = react(world.human, world.grid, world.geometry, scene, action, random)
    desired, goal_room = scene.desired_direction, scene.goal_room
    after = scene_of(world.geometry, robot, human, engagement, action, human_action, desired, goal_room)
    if room_of(human.row, human.col) != goal_room:
        return after, 0.0
    return with_aims(after, desired, another_goal(world, goal_room, random)), 1.0
