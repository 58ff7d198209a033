"""Leading: where should the robot go, so that the human that follows it reaches goal after goal?

Value iteration over goal g, the human's cell h and the robot's offset o from it, with what is known of moving (T) and
of the human (its speeds p_S, its loss of attention p_A):

    W(g, h, o) = max_a sum_k p_S(k) [1{h' in g} + gamma C],  h' = T(h, k cells towards the robot),  r' = T(r, a)
    C = (1 - p_A) X + p_A L  where robot and human are in sight and at an appropriate distance afterwards, else L
    X = W(g, h', o'), or where h' is in g its mean over the other goals;  L = 0.6 x the mean of the positive W

L stands for all that it takes to win a human back. Only pairs in sight at an appropriate distance have a value.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.exploration import Table
from visitlab_cli.compiled import array_kernel, kernel, long_kernel
from visitlab_cli.simulation.successors import Cells, Successors
from visitlab_cli.simulation.vehicle import DISCOUNT
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS, N_PHYSICAL_ACTIONS
from visitlab_cli.world.geometry import Geometry, is_appropriate

LOST_SHARE = 0.6
"""What losing the human leaves of an average value."""
NO_GOAL = -1
SPEED_2, SPEED_3 = N_DIRECTIONS, 2 * N_DIRECTIONS
"""What a move at a speed has more than one at speed 1."""


class Lead(NamedTuple):
    """A plan; an offset is (rows + reach) * side + cols + reach of the robot from the human, side = 2 reach + 1.

    `values` (cells, offsets, goals) is W. `outcomes` (cells, offsets + 1, goals) is what follows from it: what it is
    worth that the human gets to a cell while the robot gets to an offset of it, the last one for any from which it is
    lost. `direction` (offsets,) is where the human goes, -1 where the distance is not appropriate. `goal_in` (cells,)
    is which of the `goals` a cell's room is. `speeds` (3,) and `loss` (1,) are what it was planned with.
    """

    values: Table
    outcomes: Table
    reach: int
    direction: Cells
    goals: Cells
    goal_in: Cells
    speeds: Table
    loss: Table


def make_lead(geometry: Geometry, reach: int, rooms: Cells, goals: Cells) -> Lead:
    """An empty plan.

    Args:
        geometry: of the lab.
        reach: the largest appropriate distance, in cells.
        rooms: the room of each cell, shape (cells,).
        goals: the rooms that goals are drawn from, shape (goals,).
    """
    cells, offsets = len(rooms), (2 * reach + 1) ** 2
    goal_in = np.full(cells, NO_GOAL)
    for index, room in enumerate(goals):
        goal_in[rooms == room] = index
    values, outcomes = np.zeros((cells, offsets, len(goals))), np.zeros((cells, offsets + 1, len(goals)))
    speeds, loss = np.zeros(MAX_SPEED), np.zeros(1)
    return Lead(values, outcomes, reach, directions_of(geometry, reach), goals, goal_in, speeds, loss)


def directions_of(geometry: Geometry, reach: int) -> Cells:
    """Where a human goes whose robot stands at each offset, -1 where it would not follow: shape (offsets,)."""
    directions = []
    for rows in range(-reach, reach + 1):
        for cols in range(-reach, reach + 1):
            # tables go by robot_row - human_row and human_col - robot_col
            north, east = rows + geometry.reach, geometry.reach - cols
            inside = max(abs(rows), abs(cols)) <= geometry.reach
            follows = inside and is_appropriate(int(geometry.distance[north, east]))
            directions.append((int(geometry.angle[north, east]) + N_DIRECTIONS // 2) % N_DIRECTIONS if follows else -1)
    return np.array(directions)


@kernel
def offset_of(lead: Lead, known: Successors, robot: int, human: int) -> int:
    """The robot's offset from the human, -1 where it is not in sight at an appropriate distance."""
    offset: int = _outcome(known.place, known.sees, lead.direction, lead.reach, robot, human)
    return offset if offset < len(lead.direction) else -1


@kernel
def _outcome(place: Cells, sees: npt.NDArray[np.bool_], direction: Cells, reach: int, robot: int, human: int) -> int:
    """Which outcome of the human's cell it is that the robot is in a cell: its offset, or the last.

    It takes the arrays by themselves: each that is taken from a record costs more than all the rest.
    """
    rows, cols = place[robot, 0] - place[human, 0], place[robot, 1] - place[human, 1]
    if abs(rows) > reach or abs(cols) > reach or not sees[robot, human]:
        return len(direction)
    offset = (rows + reach) * (2 * reach + 1) + cols + reach
    return int(offset) if direction[offset] >= 0 else len(direction)


@array_kernel
def sweep_lead(lead: Lead, known: Successors) -> None:
    """One synchronous sweep over all pairs of cells, then what follows from its result."""
    after, meant, place, sees = known.after, known.meant, known.place, known.sees
    values, outcomes, directions, reach = lead.values, lead.outcomes, lead.direction, lead.reach
    slow, middle, fast = lead.speeds[0], lead.speeds[1], lead.speeds[2]
    cells, offsets, goals = values.shape
    best = np.zeros(goals)
    for human in range(cells):
        for robot in range(cells):
            offset = _outcome(place, sees, directions, reach, robot, human)
            if offset == offsets:
                continue
            move = directions[offset]
            first, second, third = after[human, move], after[human, move + SPEED_2], after[human, move + SPEED_3]
            best[:] = 0.0
            for action in range(N_PHYSICAL_ACTIONS):
                if meant[robot, action] != action:
                    continue  # what comes to another action is that one
                to = after[robot, action]
                near = _outcome(place, sees, directions, reach, to, first)
                halfway = _outcome(place, sees, directions, reach, to, second)
                far = _outcome(place, sees, directions, reach, to, third)
                for goal in range(goals):
                    worth = slow * outcomes[first, near, goal] + middle * outcomes[second, halfway, goal]
                    worth += fast * outcomes[third, far, goal]
                    best[goal] = worth if worth > best[goal] else best[goal]
            for goal in range(goals):
                values[human, offset, goal] = best[goal]
    settle(lead)


@long_kernel
def settle(lead: Lead) -> None:
    """Make the outcomes from the values, with L."""
    values, outcomes = lead.values, lead.outcomes
    total, positive = 0.0, 0
    for value in values.flat:
        total += value
        positive += 1 if value > 0.0 else 0
    lost = LOST_SHARE * total / positive if positive > 0 else 0.0
    cells, offsets, goals = values.shape
    keeps, loses = DISCOUNT * (1.0 - lead.loss[0]), DISCOUNT * lead.loss[0] * lost
    for human in range(cells):
        reached = lead.goal_in[human]
        for offset in range(offsets):
            of_all = 0.0
            for goal in range(goals):
                of_all += values[human, offset, goal]
                outcomes[human, offset, goal] = keeps * values[human, offset, goal] + loses
            if reached != NO_GOAL:
                of_others = (of_all - values[human, offset, reached]) / (goals - 1)
                outcomes[human, offset, reached] = 1.0 + keeps * of_others + loses
        for goal in range(goals):
            outcomes[human, offsets, goal] = DISCOUNT * lost
        if reached != NO_GOAL:
            outcomes[human, offsets, reached] += 1.0


@long_kernel
def start_lead(lead: Lead, known: Successors, directions: Table) -> None:
    """Begin a plan with what the human's direction would be worth to it as a vehicle, (rooms, cells, 8)."""
    for human in range(len(known.after)):
        for robot in range(len(known.after)):
            offset = offset_of(lead, known, robot, human)
            if offset >= 0:
                for goal in range(len(lead.goals)):
                    lead.values[human, offset, goal] = directions[lead.goals[goal], human, lead.direction[offset]]
    settle(lead)


@long_kernel
def leading_action(lead: Lead, known: Successors, goal_room: int, human: int, robot: int, offset: int) -> int:
    """The first of the best actions for the robot at an `offset` of the human; one that comes to itself."""
    goal = 0
    for index in range(len(lead.goals)):
        if lead.goals[index] == goal_room:
            goal = index
    chosen, best = 0, -1.0
    for action in range(N_PHYSICAL_ACTIONS):
        if known.meant[robot, action] == action:
            worth = 0.0
            for slower in range(MAX_SPEED):
                ahead = known.after[human, N_DIRECTIONS * slower + lead.direction[offset]]
                to = known.after[robot, action]
                place = _outcome(known.place, known.sees, lead.direction, lead.reach, to, ahead)
                worth += lead.speeds[slower] * lead.outcomes[ahead, place, goal]
            if worth > best:
                chosen, best = action, worth
    return chosen
