"""Directions, actions and the human's states, with the numbers that logs, tables and configs use."""

from enum import IntEnum


class Direction(IntEnum):
    """A heading or direction, counter-clockwise from east in steps of 45 degrees; row 0 is north."""

    EAST = 0
    NORTH_EAST = 1
    NORTH = 2
    NORTH_WEST = 3
    WEST = 4
    SOUTH_WEST = 5
    SOUTH = 6
    SOUTH_EAST = 7


class Action(IntEnum):
    """What the robot can do; a move is `8 * (speed - 1) + direction`, speeds 1 to 3.

    `MOVE_<speed>_<direction>` (0..23) and `STAY` exist in every task, `LOOK` (0..24 is navigation and
    go_to_human) and the rest in the social task and the visit. `NO_ACTION` marks the state that a trial
    starts in and is never chosen.
    """

    MOVE_1_EAST = 0
    MOVE_1_NORTH_EAST = 1
    MOVE_1_NORTH = 2
    MOVE_1_NORTH_WEST = 3
    MOVE_1_WEST = 4
    MOVE_1_SOUTH_WEST = 5
    MOVE_1_SOUTH = 6
    MOVE_1_SOUTH_EAST = 7
    MOVE_2_EAST = 8
    MOVE_2_NORTH_EAST = 9
    MOVE_2_NORTH = 10
    MOVE_2_NORTH_WEST = 11
    MOVE_2_WEST = 12
    MOVE_2_SOUTH_WEST = 13
    MOVE_2_SOUTH = 14
    MOVE_2_SOUTH_EAST = 15
    MOVE_3_EAST = 16
    MOVE_3_NORTH_EAST = 17
    MOVE_3_NORTH = 18
    MOVE_3_NORTH_WEST = 19
    MOVE_3_WEST = 20
    MOVE_3_SOUTH_WEST = 21
    MOVE_3_SOUTH = 22
    MOVE_3_SOUTH_EAST = 23
    STAY = 24
    LOOK = 25
    HELLO = 26
    COME = 27
    POINT = 28
    GO_TO_HUMAN_VISION = 29
    NO_ACTION = 30


class Engagement(IntEnum):
    """How far the human is engaged in the interaction."""

    NONE = 0
    GREETED = 1
    CALLED = 2
    FOLLOWING = 3


class InteractionLevel(IntEnum):
    """The social module's view of the interaction (paper, Fig. 4): 0..4 geometry alone, 5..7 engagement."""

    NOT_SEEN = 0
    SEEN = 1
    HUMAN_FACES = 2
    ROBOT_FACES = 3
    BOTH_FACE = 4
    GREETED = 5
    CALLED = 6
    FOLLOWS = 7


N_DIRECTIONS = len(Direction)
N_MOVES = int(Action.STAY)
N_PHYSICAL_ACTIONS = int(Action.STAY) + 1
N_SOCIAL_ACTIONS = int(Action.GO_TO_HUMAN_VISION) + 1
N_LEVELS = len(InteractionLevel)
DISTANCE_NAMES = ("too close", "close", "right", "wide", "too far")
"""The words of the distance categories, in their order: log, viewer and pages have no others."""
N_DISTANCES = len(DISTANCE_NAMES)
MAX_SPEED = 3
