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

from visitlab_cli.agents.exploration import Table
from visitlab_cli.compiled import kernel, long_kernel
from visitlab_cli.simulation.successors import Cells, Successors
from visitlab_cli.simulation.vehicle import DISCOUNT
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS, N_PHYSICAL_ACTIONS
from visitlab_cli.world.geometry import Geometry, is_appropriate

LOST_SHARE = 0.6
"""What losing the human leaves of an average value."""
NO_GOAL = -1


class Lead(NamedTuple):
    """A plan; an offset is (rows + reach) * side + cols + reach of the robot from the human, side = 2 reach + 1.

    `values` (cells, offsets, goals) is W, `others` its sum over goals (cells, offsets), `lost` (1,) L; `new` is room
    for the next W and `worth` (goals,) for one action's. `direction` (offsets,) is where the human goes,
    -1 where the distance is not appropriate. `goal_in` (cells,) is the goal that a cell's room is among `goals`.
    `speeds` (3,) and `loss` (1,) are what it was planned with.
    """

    values: Table
    others: Table
    new: Table
    worth: Table
    lost: Table
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
    cells, side = len(rooms), 2 * reach + 1
    goal_in = np.full(cells, NO_GOAL)
    for index, room in enumerate(goals):
        goal_in[rooms == room] = index
    shape = cells, side * side, len(goals)
    return Lead(
        np.zeros(shape),
        np.zeros(shape[:2]),
        np.zeros(shape),
        np.zeros(len(goals)),
        np.zeros(1),
        reach,
        directions_of(geometry, reach),
        goals,
        goal_in,
        np.zeros(MAX_SPEED),
        np.zeros(1),
    )


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
    rows = known.place[robot, 0] - known.place[human, 0]
    cols = known.place[robot, 1] - known.place[human, 1]
    if max(abs(rows), abs(cols)) > lead.reach or not known.sees[robot, human]:
        return -1
    offset = (rows + lead.reach) * (2 * lead.reach + 1) + cols + lead.reach
    return offset if lead.direction[offset] >= 0 else -1


@kernel
def weigh(lead: Lead, known: Successors, human: int, direction: int, robot: int) -> None:
    """Fill `worth`, for each goal: the robot goes to the cell `robot` while the human goes in `direction`."""
    goals = len(lead.worth)
    lead.worth[:] = 0.0
    for slower in range(MAX_SPEED):
        chance = lead.speeds[slower]
        if chance == 0.0:
            continue
        ahead = known.after[human, N_DIRECTIONS * slower + direction]
        offset = offset_of(lead, known, robot, ahead)
        kept = chance * DISCOUNT * (1.0 - lead.loss[0]) if offset >= 0 else 0.0
        lost = chance * DISCOUNT * lead.lost[0] - kept * lead.lost[0]
        reached = lead.goal_in[ahead]
        for goal in range(goals):
            lead.worth[goal] += lost
        if offset >= 0:
            for goal in range(goals):
                lead.worth[goal] += kept * lead.values[ahead, offset, goal]
        if reached != NO_GOAL:
            lead.worth[reached] += chance
            if offset >= 0:
                own = lead.values[ahead, offset, reached]
                lead.worth[reached] += kept * ((lead.others[ahead, offset] - own) / (goals - 1) - own)


@long_kernel
def sweep_lead(lead: Lead, known: Successors) -> None:
    """One synchronous sweep, then L from its result."""
    cells = len(known.after)
    for human in range(cells):
        for robot in range(cells):
            if abs(known.place[robot, 0] - known.place[human, 0]) > lead.reach:
                continue
            offset = offset_of(lead, known, robot, human)
            if offset < 0:
                continue
            direction, best = lead.direction[offset], lead.new[human, offset]
            best[:] = 0.0
            for action in range(N_PHYSICAL_ACTIONS):
                if known.meant[robot, action] == action:  # what comes to another action is that one
                    weigh(lead, known, human, direction, known.after[robot, action])
                    for goal in range(len(best)):
                        best[goal] = max(best[goal], lead.worth[goal])
    lead.values[:] = lead.new
    settle(lead)


@long_kernel
def settle(lead: Lead) -> None:
    """Make `others` and L from the values."""
    total, positive = 0.0, 0
    cells, offsets, goals = lead.values.shape
    for human in range(cells):
        for offset in range(offsets):
            of_all = 0.0
            for goal in range(goals):
                value = lead.values[human, offset, goal]
                of_all += value
                positive += value > 0.0
            lead.others[human, offset] = of_all
            total += of_all
    lead.lost[0] = LOST_SHARE * total / positive if positive > 0 else 0.0


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


@kernel
def leading_action(lead: Lead, known: Successors, goal_room: int, human: int, robot: int, offset: int) -> int:
    """The first of the best actions for the robot at an `offset` of the human; one that comes to itself."""
    goal = 0
    for index in range(len(lead.goals)):
        if lead.goals[index] == goal_room:
            goal = index
    chosen, best = 0, -1.0
    for action in range(N_PHYSICAL_ACTIONS):
        if known.meant[robot, action] == action:
            weigh(lead, known, human, lead.direction[offset], known.after[robot, action])
            if lead.worth[goal] > best:
                chosen, best = action, lead.worth[goal]
    return chosen
