"""The global task `visit`: lead the human from goal room to goal room (paper, section 3.1).

These are the world's rules only; where the desired direction and the executed action come from is the matter of
the three modules (`simulation/visit.py`).
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.geometry import DISTANCES, Geometry, make_geometry
from visitlab_cli.world.human import react
from visitlab_cli.world.lab import Lab, goals_of, paper_lab
from visitlab_cli.world.perception import Levels, Perception, begun, perceived
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import (
    Scene,
    before_trial,
    first_scene,
    next_scene,
    random_body,
    random_direction,
    with_aims,
)


class VisitWorld(NamedTuple):
    """The lab, the human in it, the rooms that goals are drawn from, shape (at least 2,), what is perceived."""

    lab: Lab
    geometry: Geometry
    human: Any  # of a kind that reacts
    goal_rooms: npt.NDArray[np.int64]
    perception: Any = Levels()


def make_visit_world(
    human: Any,
    goal_rooms: Sequence[int] | None = None,
    distances: Sequence[int] = DISTANCES,
    lab: Lab | None = None,
    perception: Perception | None = None,
) -> VisitWorld:
    """A human in `lab`, the paper's unless given, with goals among `goal_rooms`, all that the lab has unless given."""
    lab = lab or paper_lab()
    goals = np.array(goals_of(lab) if goal_rooms is None else goal_rooms, np.int64)
    return VisitWorld(lab, make_geometry(lab.rows, lab.cols, distances), human, goals, perception or Levels())


@kernel
def begin_visit(world: VisitWorld, last: Scene, random: RandomState) -> Scene:
    """All cells and headings random; goal room and desired direction carry over from `last`, or are random.

    A goal room that is none any more gives way to another.
    """
    last = before_trial(world.lab, last, random)
    robot = random_body(world.lab, random)
    human = random_body(world.lab, random)
    desired, goal_room = last.desired_direction, last.goal_room
    if goal_room < 0:
        desired = random_direction(random)
        goal_room = world.goal_rooms[random_below(random, len(world.goal_rooms))]
    elif not is_goal(world, goal_room):
        goal_room = another_goal(world, goal_room, random)
    first = with_aims(first_scene(world.lab, world.geometry, last, robot, human), desired, goal_room)
    return begun(world.perception, world.lab, world.geometry, first)  # type: ignore[no-any-return]


@kernel
def is_goal(world: VisitWorld, room: int) -> bool:
    """Whether goals may be drawn from a room."""
    found = False
    for goal_room in world.goal_rooms:
        found = found or goal_room == room
    return found


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
    robot = acted(world.lab, scene, action)
    reaction = react(world.human, world.lab, world.geometry, scene, action, random)
    after = next_scene(world.lab, world.geometry, scene, robot, action, reaction)
    after = perceived(world.perception, world.lab, world.geometry, scene, after)
    if world.lab.rooms[after.human_row, after.human_col] != scene.goal_room:
        return after, 0.0
    return with_aims(after, scene.desired_direction, another_goal(world, scene.goal_room, random)), 1.0
