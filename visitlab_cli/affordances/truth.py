"""The true Fig. 4: what follows a kind of action, computed from the human's parameters.

What the social module is shown (level, distance, and which gesture) decides the human's engagement, levels 5 to 7,
and whether there is none. Among the levels 0 to 4, which follow from where both stand and look, it decides nothing,
except that in training `go_to_human_vision` puts the robot in the middle of the human's sight. A truth is a range,
`low` to `high`, over all scenes that look the same to the module; mostly the two are equal. They are not for a hello
to a human already engaged that loses attention in that very step: whether it is won back depends on what it sees.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.affordances.counts import KINDS, Kind
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.enums import (
    MAX_SPEED,
    N_DIRECTIONS,
    N_DISTANCES,
    N_LEVELS,
    Action,
    Engagement,
    InteractionLevel,
)
from visitlab_cli.world.geometry import DISTANCES, is_appropriate, make_geometry
from visitlab_cli.world.lab import ALL_OPEN, arena_of
from visitlab_cli.world.robot import move_of, moved
from visitlab_cli.world.scene import NOWHERE, Body, next_scene, reaction
from visitlab_cli.world.social import teleported

Table = npt.NDArray[np.float64]
NOT_ENGAGED = N_LEVELS
"""Index of the outcome 'any of the levels 0 to 4'; the outcomes before it are the levels."""
N_OUTCOMES = N_LEVELS + 1
FIRST_ENGAGED = int(InteractionLevel.GREETED)
WIDE = 4 * MAX_SPEED
"""Cells a side of a floor in whose middle no move of one step meets a border."""


class Truth(NamedTuple):
    """Smallest and largest probability: shape (kinds, levels, distances, outcomes); nan where nothing is decided."""

    low: Table
    high: Table


def true_transitions(human: HumanParameters, teleports: bool, distances: Sequence[int] = DISTANCES) -> Truth:
    """The true Fig. 4 of a human; of one whose rules are not the paper's nothing is decided here.

    Args:
        human: its parameters.
        teleports: whether `go_to_human_vision` teleports (the social task) or is a walk (the visit).
        distances: the bounds of the distance categories, in cells.
    """
    truth = undecided()
    if type(human) is not SixParameters:
        return truth
    for index, kind in enumerate(KINDS):
        for level in range(N_LEVELS):
            for distance in range(N_DISTANCES):
                ends = [_engagement(human, kind, level, distance, hello) for hello in _hello_success(human, level)]
                place = index, level, distance, slice(FIRST_ENGAGED, None)
                truth.low[place], truth.high[place] = np.min(ends, axis=0), np.max(ends, axis=0)
    if teleports:
        seen = _levels_in_vision(human, distances)
        vision, unengaged = KINDS.index(Kind.GO_TO_HUMAN_VISION), slice(0, FIRST_ENGAGED)
        truth.low[vision, unengaged, :, unengaged] = seen.min(axis=0)
        truth.high[vision, unengaged, :, unengaged] = seen.max(axis=0)
    return truth


def undecided() -> Truth:
    """Of what the rules decide nothing of."""
    shape = len(KINDS), N_LEVELS, N_DISTANCES, N_OUTCOMES
    return Truth(np.full(shape, np.nan), np.full(shape, np.nan))


def _hello_success(human: SixParameters, level: int) -> tuple[float, ...]:
    """The chances that a hello may have at an appropriate distance, as far as the level tells."""
    if level == InteractionLevel.BOTH_FACE:
        return (1.0,)
    if level == InteractionLevel.ROBOT_FACES:
        return (1 - human.p_H,)
    return (0.0,) if level < FIRST_ENGAGED else (0.0, 1 - human.p_H, 1.0)


def _engagement(human: SixParameters, kind: Kind, level: int, distance: int, hello: float) -> Table:
    """Probabilities of the levels 5, 6, 7 and of no engagement after a kind of action: shape (4,).

    The distribution of `world.human.engage`, with the chance `hello` that a hello succeeds.
    """
    appropriate = is_appropriate(distance)
    engaged = level >= FIRST_ENGAGED
    after = np.zeros(N_OUTCOMES - FIRST_ENGAGED)
    kept = (1 - human.p_A) if engaged and appropriate else 0.0
    lost = 1 - kept
    if engaged:
        for next_level, chance in _kept(human, kind, level).items():
            after[next_level - FIRST_ENGAGED] += kept * chance
    won = hello if kind == Kind.HELLO and appropriate else 0.0
    after[InteractionLevel.GREETED - FIRST_ENGAGED] += lost * won
    after[-1] += lost * (1 - won)
    return after


def _kept(human: SixParameters, kind: Kind, level: int) -> dict[InteractionLevel, float]:
    """What a human does who is engaged and attentive."""
    if kind == Kind.COME and level == InteractionLevel.GREETED:
        return {InteractionLevel.CALLED: human.p_P, InteractionLevel.FOLLOWS: 1 - human.p_P}
    if kind == Kind.POINT and level == InteractionLevel.CALLED:
        return {InteractionLevel.FOLLOWS: 1.0}
    return {InteractionLevel(level): 1.0}


def _levels_in_vision(human: SixParameters, distances: Sequence[int]) -> Table:
    """Probabilities of the levels 0 to 4 after teleporting, for each heading of the human before: shape (8, 5).

    The human may move at random and look elsewhere in that step; the robot's heading is random. Far from borders.
    """
    lab = arena_of(WIDE)
    geometry, middle = make_geometry(lab.rows, lab.cols, distances), lab.rows // 2
    found = np.zeros((N_DIRECTIONS, FIRST_ENGAGED))
    nothing = Engagement.NONE.value, Action.STAY.value
    for before in range(N_DIRECTIONS):
        start = Body(middle, middle, before)
        scene = NOWHERE._replace(human_row=middle, human_col=middle, human_heading=before)
        robot = teleported(lab, scene, random_state(0))  # its cell is certain
        bodies = [(start, 1 - human.p_M)]
        for speed in range(1, MAX_SPEED + 1):
            chance = human.p_M * human.p_S[speed - 1] / N_DIRECTIONS
            bodies += [
                (moved(lab, start, move_of(direction, speed), ALL_OPEN), chance) for direction in range(N_DIRECTIONS)
            ]
        for body, chance in bodies:
            for human_heading in range(N_DIRECTIONS):
                gaze = human.p_O / N_DIRECTIONS + (1 - human.p_O) * (human_heading == body.heading)
                looking = reaction(body.row, body.col, human_heading, *nothing)
                for robot_heading in range(N_DIRECTIONS):
                    at = next_scene(
                        lab, geometry, scene, Body(robot.row, robot.col, robot_heading), Action.NO_ACTION.value, looking
                    )
                    found[before, at.interaction_level] += chance * gaze / N_DIRECTIONS
    return found
