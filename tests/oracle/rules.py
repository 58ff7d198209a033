"""The rules of TASK.md in plain Python: movement, geometry, the human, state numbers, rewards.

What is random is given as a distribution: a dict from each possible outcome to its exact probability.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

from visitlab_cli.world.enums import Action, Direction, Engagement, InteractionLevel

from .grid import Cell as Cell
from .grid import Grid as Grid
from .grid import is_move as is_move
from .grid import move_action as move_action
from .grid import move_parts as move_parts

Heading = int

DISTANCES = (1, 2, 4, 5)
APPROPRIATE = (1, 2, 3)
TOO_FAR = 4
GESTURES = (Action.HELLO, Action.COME, Action.POINT)
TELEPORT_SPEED = 2
TURN = 800  # a full turn in hundredths of 45 degrees, the unit of bearings here


# ---------------------------------------------------------------------------------------------- geometry


class Geometry(NamedTuple):
    """What lies between robot and human, as one moment shows it."""

    distance: int  # category 0..4
    angle: int  # direction from robot to human, 0..7
    seen: bool  # the human sees the robot
    human_faces: bool
    robot_faces: bool

    @property
    def appropriate(self) -> bool:
        return self.distance in APPROPRIATE


def distance_category(cells: int, distances: tuple[int, ...] = DISTANCES) -> int:
    """0..4 from the Chebyshev distance: how many of the four thresholds it exceeds."""
    for category, threshold in enumerate(distances):
        if cells <= threshold:
            return category
    return len(distances)


def bearing(robot: Cell, human: Cell) -> int:
    """b, from robot to human, in hundredths of 45 degrees: 0..799; 0 where they share a cell."""
    north, east = robot[0] - human[0], human[1] - robot[1]
    if north == 0 and east == 0:
        return 0
    return round(math.degrees(math.atan2(north, east)) / 45 * 100) % TURN


def angle_of(b: int) -> int:
    """The nearest direction; a tie goes to the even one."""
    whole, rest = divmod(b, 100)
    if rest > 50 or (rest == 50 and whole % 2 == 1):
        whole += 1
    return whole % 8


def within(heading: Heading, b: int, eighths: int) -> bool:
    """Whether the heading is at most `eighths` times 45 degrees from the bearing, either way round."""
    difference = (heading * 100 - b) % TURN
    return min(difference, TURN - difference) <= eighths * 100


@cache
def _offset(down: int, right: int, distances: tuple[int, ...]) -> tuple[int, int, int]:
    """(distance category, bearing, angle) where the human is `down` rows and `right` columns of the robot."""
    b = bearing((0, 0), (down, right))
    return distance_category(max(abs(down), abs(right)), distances), b, angle_of(b)


@cache
def _geometry(distance: int, b: int, angle: int, robot_heading: Heading, human_heading: Heading) -> Geometry:
    back = (b + TURN // 2) % TURN
    return Geometry(
        distance=distance,
        angle=angle,
        seen=within(human_heading, back, 2),
        human_faces=within(human_heading, back, 1),
        robot_faces=within(robot_heading, b, 1),
    )


def geometry(
    robot: Cell,
    robot_heading: Heading,
    human: Cell,
    human_heading: Heading,
    distances: tuple[int, ...] = DISTANCES,
    in_sight: bool = True,
) -> Geometry:
    """`in_sight`: no wall is between them. Behind one nobody is seen, and to the robot the human is too far away."""
    distance, b, angle = _offset(human[0] - robot[0], human[1] - robot[1], distances)
    if not in_sight:
        return Geometry(TOO_FAR, angle, seen=False, human_faces=False, robot_faces=False)
    return _geometry(distance, b, angle, robot_heading, human_heading)


def geometry_in(
    grid: Grid,
    robot: Cell,
    robot_heading: Heading,
    human: Cell,
    human_heading: Heading,
    distances: tuple[int, ...] = DISTANCES,
) -> Geometry:
    """The same, sight being that of the grid."""
    return geometry(robot, robot_heading, human, human_heading, distances, grid.sees(robot, human))


def interaction_level(geo: Geometry, engagement: int = Engagement.NONE) -> int:
    if engagement == Engagement.GREETED:
        return InteractionLevel.GREETED
    if engagement == Engagement.CALLED:
        return InteractionLevel.CALLED
    if engagement == Engagement.FOLLOWING:
        return InteractionLevel.FOLLOWS
    if not geo.seen:
        return InteractionLevel.NOT_SEEN
    if geo.robot_faces:
        return InteractionLevel.BOTH_FACE if geo.human_faces else InteractionLevel.ROBOT_FACES
    return InteractionLevel.HUMAN_FACES if geo.human_faces else InteractionLevel.SEEN


def engagement_of(level: int) -> int:
    """The engagement that an interaction level tells: 0..4 mean none."""
    return {5: Engagement.GREETED, 6: Engagement.CALLED, 7: Engagement.FOLLOWING}.get(level, Engagement.NONE)


# ------------------------------------------------------------------------------------- the robot's action


def robot_after(grid: Grid, cell: Cell, heading: Heading, action: int, angle: int) -> tuple[Cell, Heading]:
    """The robot after an action that it can do itself (0..28); `angle` as the step began."""
    if is_move(action):
        return grid.after(cell, action), move_parts(action)[1]
    if action == Action.LOOK:
        return cell, angle
    if Action.STAY <= action <= Action.POINT:
        return cell, heading
    raise ValueError(f"the robot cannot do action {action}")


def teleport_target(grid: Grid, human: Cell, human_heading: Heading) -> Cell:
    """Where go_to_human_vision puts the robot in the social task, the human's engagement being none."""
    return grid.move(human, TELEPORT_SPEED, human_heading)


# ---------------------------------------------------------------------------------------- the human's step


@dataclass(frozen=True)
class Human:
    """The six parameters of the paper's Table 1."""

    p_S: tuple[float, float, float]
    p_H: float
    p_M: float
    p_O: float
    p_A: float
    p_P: float

    @classmethod
    def of(cls, parameters: "Mapping[str, Any] | Human") -> "Human":
        if isinstance(parameters, Human):
            return parameters
        values = {name: parameters[name] for name in ("p_H", "p_M", "p_O", "p_A", "p_P")}
        one, two, three = (float(p) for p in parameters["p_S"])
        return cls(p_S=(one, two, three), **{name: float(p) for name, p in values.items()})


class Reaction(NamedTuple):
    """One outcome of a human's step; its cell follows from the cell before and its action."""

    engagement: int
    action: int  # one of the 24 moves, or stay
    heading: Heading


class Outcome(NamedTuple):
    engagement: int
    action: int
    cell: Cell
    heading: Heading


def _add(distribution: dict[Any, float], outcome: Any, probability: float) -> None:
    if probability > 0:
        distribution[outcome] = distribution.get(outcome, 0.0) + probability


@cache
def hello_success(geo: Geometry, human: Human) -> float:
    if not (geo.appropriate and geo.seen and geo.robot_faces):
        return 0.0
    return 1.0 if geo.human_faces else 1.0 - human.p_H


@cache
def engagement_outcomes(engagement: int, geo: Geometry, gesture: int, human: Human) -> dict[int, float]:
    """Engagement after the step; `geo` is what was perceived when the step began."""
    lost = human.p_A if geo.appropriate else 1.0
    kept: dict[int, float] = {}
    _add(kept, int(Engagement.NONE), lost)
    _add(kept, int(engagement), 1.0 - lost)
    after: dict[int, float] = {}
    for e, p in kept.items():
        if gesture == Action.HELLO:
            success = hello_success(geo, human)
            _add(after, max(e, int(Engagement.GREETED)), p * success)
            _add(after, e, p * (1.0 - success))
        elif gesture == Action.COME and e == Engagement.GREETED:
            _add(after, int(Engagement.FOLLOWING), p * (1.0 - human.p_P))
            _add(after, int(Engagement.CALLED), p * human.p_P)
        elif gesture == Action.POINT and e in (Engagement.CALLED, Engagement.FOLLOWING):
            _add(after, int(Engagement.FOLLOWING), p)
        else:
            _add(after, e, p)
    return after


@cache
def movement_outcomes(engagement: int, angle: int, gesture: int, human: Human) -> dict[int, float]:
    """The human's action, `engagement` being the new one and `angle` the one perceived."""
    actions: dict[int, float] = {}
    if engagement == Engagement.NONE:
        for speed, p in enumerate(human.p_S, start=1):
            for direction in Direction:
                _add(actions, move_action(speed, direction), human.p_M * p / len(Direction))
        _add(actions, int(Action.STAY), 1.0 - human.p_M)
    elif engagement == Engagement.FOLLOWING and gesture not in GESTURES:
        for speed, p in enumerate(human.p_S, start=1):
            _add(actions, move_action(speed, (angle + 4) % 8), p)
    else:
        _add(actions, int(Action.STAY), 1.0)
    return actions


@cache
def gaze_outcomes(engagement: int, angle: int, heading: Heading, human: Human) -> dict[Heading, float]:
    """The human's heading after the step; `heading` is the one after its movement."""
    headings: dict[Heading, float] = {}
    if engagement == Engagement.NONE:
        for direction in Direction:
            _add(headings, int(direction), human.p_O / len(Direction))
        _add(headings, heading, 1.0 - human.p_O)
    else:
        _add(headings, (angle + 4) % 8, 1.0)
    return headings


def gesture_of(action: int) -> int:
    """The gesture that the human perceives; every other action is the same to it."""
    return int(action) if action in GESTURES else int(Action.STAY)


def heading_after(heading: Heading, action: int) -> Heading:
    """The human's heading after its movement, before its gaze."""
    return move_parts(action)[1] if is_move(action) else heading


def reactions(
    engagement: int, geo: Geometry, human_heading: Heading, gesture: int, human: Human
) -> dict[Reaction, float]:
    """Each possible (engagement, action, heading) of the human's step, with its probability."""
    result: dict[Reaction, float] = {}
    for e, p_engagement in engagement_outcomes(engagement, geo, gesture, human).items():
        for action, p_action in movement_outcomes(e, geo.angle, gesture, human).items():
            moved = heading_after(human_heading, action)
            for heading, p_heading in gaze_outcomes(e, geo.angle, moved, human).items():
                _add(result, Reaction(e, action, heading), p_engagement * p_action * p_heading)
    return result


def human_step(
    grid: Grid,
    robot: Cell,
    robot_heading: Heading,
    human_cell: Cell,
    human_heading: Heading,
    engagement: int,
    action: int,
    human: Human,
    distances: tuple[int, ...] = DISTANCES,
) -> dict[Outcome, float]:
    """The distribution of the human's step, from where both stood when the step began."""
    geo = geometry_in(grid, robot, robot_heading, human_cell, human_heading, distances)
    outcomes: dict[Outcome, float] = {}
    for reaction, p in reactions(engagement, geo, human_heading, gesture_of(action), human).items():
        cell = grid.after(human_cell, reaction.action)
        _add(outcomes, Outcome(reaction.engagement, reaction.action, cell, reaction.heading), p)
    return outcomes


# --------------------------------------------------------------------------------- state numbers, rewards


def navigation_state(grid: Grid, goal_room: int, cell: Cell) -> int:
    return goal_room * grid.n_cells + grid.cell_number(cell)


def go_to_human_state(angle: int, human_heading: Heading, distance: int) -> int:
    return angle + 8 * (human_heading + 8 * distance)


def social_state(level: int, distance: int, desired_direction: int, angle: int) -> int:
    return level + 8 * (distance + 5 * (desired_direction + 8 * angle))


def navigation_reward(grid: Grid, goal_room: int, robot: Cell) -> int:
    return int(grid.room(robot) == goal_room)


def go_to_human_reward(geo: Geometry, success: str = "facing") -> int:
    """`geo` as the step ended; `success` is `facing` or `seen`."""
    won = {"facing": geo.human_faces, "seen": geo.seen}[success]
    return int(geo.appropriate and won)


def social_reward(engagement: int, human_action: int, desired_direction: int) -> int:
    """`engagement` after the step; `desired_direction` before it is redrawn."""
    if engagement != Engagement.FOLLOWING or not is_move(human_action):
        return 0
    return int(move_parts(human_action)[1] == desired_direction)


def visit_reward(grid: Grid, goal_room: int, human_cell: Cell) -> int:
    """`goal_room` before a new one is drawn; `human_cell` after the step."""
    return int(grid.room(human_cell) == goal_room)
