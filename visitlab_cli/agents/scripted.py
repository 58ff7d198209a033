"""A bar that needs no learning: approach, say hello, ask to come, point if asked to, then lead.

The whole script is one table over the social module's states, so that it plays as any greedy agent does. It
leads by looking one step ahead: of all moves it takes the one after which it would stand nearest to where the
human, coming towards it, walks in the desired direction, at a distance that keeps the human's attention.
"""

from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from visitlab_cli.agents.base import AgentParameters, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, floats
from visitlab_cli.agents.greedy_table import GreedyTable
from visitlab_cli.world.enums import (
    N_DIRECTIONS,
    N_DISTANCES,
    N_LEVELS,
    N_PHYSICAL_ACTIONS,
    Action,
    InteractionLevel,
)
from visitlab_cli.world.geometry import CLOSEST_APPROPRIATE, DISTANCES, FARTHEST_APPROPRIATE
from visitlab_cli.world.lab import COL_STEPS, ROW_STEPS
from visitlab_cli.world.tasks import SOCIAL, VISIT

CELLS_OF_DISTANCE = (0, 2, 3, 5, 7)  # what a category stands for when looking ahead
LEADING_DISTANCE = 3  # cells
EXPECTED_SPEED = 2  # cells a step of a following human
TURN_COST = 1.5  # of 45 degrees off the desired direction, in cells off the leading distance
OUT_OF_REACH = 100.0

GESTURES = {
    InteractionLevel.NOT_SEEN: Action.GO_TO_HUMAN_VISION,
    InteractionLevel.SEEN: Action.LOOK,
    InteractionLevel.HUMAN_FACES: Action.LOOK,
    InteractionLevel.ROBOT_FACES: Action.HELLO,
    InteractionLevel.BOTH_FACE: Action.HELLO,
    InteractionLevel.GREETED: Action.COME,
    InteractionLevel.CALLED: Action.POINT,
}


class ScriptedParameters(AgentParameters):
    """Approach, hello, come, point if needed, lead; for the social task and the visit."""

    tasks: ClassVar[tuple[str, ...]] = (SOCIAL, VISIT)
    learns: ClassVar[bool] = False
    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {SOCIAL: 0.34, VISIT: 0.37}
    kind: Literal["scripted"]

    def create(self, setting: Setting) -> GreedyTable:
        """The script as a table: 1 for the action to take in a state, 0 for every other."""
        q = zeros(setting)
        states = np.arange(setting.n_states)
        level, rest = states % N_LEVELS, states // N_LEVELS
        distance, rest = rest % N_DISTANCES, rest // N_DISTANCES
        desired, angle = rest % N_DIRECTIONS, rest // N_DIRECTIONS
        for state in states:
            q[state, scripted_action(level[state], distance[state], desired[state], angle[state])] = 1
        return GreedyTable(q)

    def restore(self, setting: Setting, saved: Saved) -> GreedyTable:
        """The script does not change."""
        return self.create(setting)

    def save(self, record: GreedyTable) -> Saved:
        """The table."""
        return {"q": record.q}

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """The table."""
        return {"q": floats(setting.n_states, setting.n_actions)}


def scripted_action(level: int, distance: int, desired: int, angle: int) -> int:
    """The script's action at an interaction level, distance category, desired direction and angle."""
    appropriate = CLOSEST_APPROPRIATE <= distance <= FARTHEST_APPROPRIATE
    if level < InteractionLevel.GREETED and not appropriate:
        return Action.GO_TO_HUMAN_VISION
    if level == InteractionLevel.FOLLOWS:
        return lead(distance, desired, angle)
    return GESTURES[InteractionLevel(level)]


def lead(distance: int, desired: int, angle: int) -> int:
    """The move (or stay) that best keeps a following human walking in the `desired` direction."""
    towards_robot = (angle + N_DIRECTIONS // 2) % N_DIRECTIONS
    gap = CELLS_OF_DISTANCE[distance] - EXPECTED_SPEED  # what is left once the human has come closer
    costs = []
    for action in range(N_PHYSICAL_ACTIONS):
        cells = 0 if action == Action.STAY else action // N_DIRECTIONS + 1
        direction = action % N_DIRECTIONS
        rows = ROW_STEPS[towards_robot] * gap + ROW_STEPS[direction] * cells
        cols = COL_STEPS[towards_robot] * gap + COL_STEPS[direction] * cells
        bearing = np.arctan2(-rows, cols) / (np.pi / 4)
        turn = abs((bearing - desired + N_DIRECTIONS / 2) % N_DIRECTIONS - N_DIRECTIONS / 2)
        away = max(abs(rows), abs(cols))
        reachable = DISTANCES[0] < away <= DISTANCES[-1]
        costs.append(TURN_COST * turn + abs(away - LEADING_DISTANCE) + (0.0 if reachable else OUT_OF_REACH))
    return int(np.argmin(costs))
