"""A belief about the human's engagement: an exact filter over what can be seen of it, and its parameters by EM.

Seen is where both stand and look. After each step b'(e') is in proportion to sum_e b(e) P(e -> e' | action, distance
and level before) L(e'), P being how engagement comes and goes by the paper's six parameters, L how likely such a human
moves and looks as this one did. The parameters may be learned meanwhile: with each e are kept the expected numbers of
events in a past that ends in e, S'_j(e') = mean over e of S_j(e) + s_j(e, e'), as in the online EM of Cappe (2011).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import array_kernel, kernel
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS, Action, Engagement, InteractionLevel
from visitlab_cli.world.geometry import is_appropriate
from visitlab_cli.world.human import is_gesture
from visitlab_cli.world.lab import Lab, move
from visitlab_cli.world.scene import Scene

Floats = npt.NDArray[np.float64]

N_ENGAGEMENTS = len(Engagement)
NONE, GREETED, CALLED, FOLLOWING = (each.value for each in Engagement)
P_H, P_M, P_O, P_A, P_P = range(MAX_SPEED, MAX_SPEED + 5)
"""Where a probability stands in `Belief.parameters`; before them stands p_S."""
N_PARAMETERS = P_P + 1
PRIOR = (1 / 3, 1 / 3, 1 / 3, 0.3, 0.1, 0.2, 0.1, 0.3)
"""What is believed of anybody, as if seen in `STRENGTH` chances of each event."""
STRENGTH = 10.0
LEARN_EVERY = 200
"""Steps after which what was seen becomes the parameters."""
LOSSES, FAILURES, CALLS, MOVES, REDRAWS = 0, 2, 4, 6, 8
"""Events that are counted, each before its chances."""
EVENTS = 10
_EVENT_OF = ((P_A, LOSSES), (P_H, FAILURES), (P_P, CALLS), (P_M, MOVES), (P_O, REDRAWS))


class Belief(NamedTuple):
    """`now` (4,) by `Engagement`; `parameters` (8,) p_S, p_H, p_M, p_O, p_A, p_P, which it `learns` or not.

    `sums` (4, 10) are the expected numbers of events and their chances, `speeds` (3,) those of moves; `steps` (1,).
    """

    now: Floats
    parameters: Floats
    learns: bool
    sums: Floats
    speeds: Floats
    steps: npt.NDArray[np.int64]


def make_belief(given: Sequence[float] | None = None) -> Belief:
    """That nobody is engaged, with the eight parameters that are `given`, else to be learned from `PRIOR` on."""
    parameters = np.array(PRIOR if given is None else given, np.float64)
    sums, speeds = np.zeros((N_ENGAGEMENTS, EVENTS)), np.zeros(MAX_SPEED)
    return Belief(np.eye(N_ENGAGEMENTS)[NONE], parameters, given is None, sums, speeds, np.zeros(1, np.int64))


@kernel
def begin(belief: Belief) -> None:
    """A trial begins: nobody is engaged; what was counted is kept."""
    for event in range(EVENTS):
        total = 0.0
        for engagement in range(N_ENGAGEMENTS):
            total += belief.now[engagement] * belief.sums[engagement, event]
        belief.sums[:, event] = total
    belief.now[:] = 0.0
    belief.now[NONE] = 1.0


@array_kernel
def follow(belief: Belief, lab: Lab, before: Scene, after: Scene, level: int) -> None:
    """Take in one step in `lab`; `level` is what geometry alone said before it, 0 to 4."""
    action, appropriate = after.executed_action, is_appropriate(before.distance)
    likelihood, events = np.zeros(N_ENGAGEMENTS), np.zeros(2)
    _likelihoods(belief.parameters, lab, before, after, action, likelihood, events)
    now, sums = np.zeros(N_ENGAGEMENTS), np.zeros((N_ENGAGEMENTS, EVENTS))
    weights, step = np.zeros(N_ENGAGEMENTS), np.zeros(EVENTS)
    for to in range(N_ENGAGEMENTS):
        for came_from in range(N_ENGAGEMENTS):
            chance, lost = transition(belief.parameters, came_from, to, action, appropriate, level)
            weight = belief.now[came_from] * chance
            if weight <= 0.0:
                continue
            weights[to] += weight
            if not belief.learns:
                continue
            _expect(step, came_from, to, action, appropriate, level, lost / chance)
            for event in range(EVENTS):
                sums[to, event] += weight * (belief.sums[came_from, event] + step[event])
        now[to] = weights[to] * likelihood[to]
        if weights[to] > 0.0:
            sums[to] /= weights[to]
        if to == NONE:
            sums[to, MOVES] += events[0]
            sums[to, MOVES + 1] += 1.0
            sums[to, REDRAWS] += events[1]
            sums[to, REDRAWS + 1] += 1.0
    total = now.sum()
    if total <= 0.0:  # what such a human never does: only its engagement's coming and going is left
        now[:] = weights
        total = now.sum()
    belief.now[:] = now / total
    belief.steps[0] += 1
    if belief.learns:
        belief.sums[:] = sums
        _count_speed(belief, lab, before, after, action)
        if belief.steps[0] % LEARN_EVERY == 0:
            learn_parameters(belief)


@kernel
def transition(
    parameters: Floats, came_from: int, to: int, action: int, appropriate: bool, level: int
) -> tuple[float, float]:
    """P(e -> e'), and how much of it is by way of a loss of attention: first the loss, then the gesture."""
    if not appropriate:
        return (1.0 if to == NONE else 0.0), 0.0
    kept = _gestured(parameters, came_from, to, action, level)
    if came_from == NONE:
        return kept, 0.0
    lost = parameters[P_A] * _gestured(parameters, NONE, to, action, level)
    return (1.0 - parameters[P_A]) * kept + lost, lost


@kernel
def _gestured(parameters: Floats, engagement: int, to: int, action: int, level: int) -> float:
    """The probability that a gesture at an appropriate distance makes `to` of an engagement that was not lost."""
    if action == Action.HELLO and engagement == NONE:
        success = 0.0
        if level == InteractionLevel.BOTH_FACE:
            success = 1.0
        elif level == InteractionLevel.ROBOT_FACES:
            success = 1.0 - parameters[P_H]
        return success if to == GREETED else 1.0 - success if to == NONE else 0.0
    if action == Action.COME and engagement == GREETED:
        return parameters[P_P] if to == CALLED else 1.0 - parameters[P_P] if to == FOLLOWING else 0.0
    if action == Action.POINT and engagement == CALLED:
        return 1.0 if to == FOLLOWING else 0.0
    return 1.0 if to == engagement else 0.0


@kernel
def _expect(step: Floats, came_from: int, to: int, action: int, appropriate: bool, level: int, lost: float) -> None:
    """Fill in the events of a step from one engagement to another that follow from these two.

    `lost` is how likely attention was lost in between: a hello may win it back at once.
    """
    step[:] = 0.0
    if came_from != NONE and appropriate:
        step[LOSSES + 1] = 1.0
        step[LOSSES] = lost
    if action == Action.HELLO and came_from == NONE and appropriate and level == InteractionLevel.ROBOT_FACES:
        step[FAILURES + 1] = 1.0
        step[FAILURES] = 1.0 if to == NONE else 0.0
    if action == Action.COME and came_from == GREETED and to >= CALLED:
        step[CALLS + 1] = 1.0
        step[CALLS] = 1.0 if to == CALLED else 0.0


@kernel
def _likelihoods(
    parameters: Floats, lab: Lab, before: Scene, after: Scene, action: int, likelihood: Floats, events: Floats
) -> None:
    """L by the engagement after the step; `events`: the expected moves and redraws of gaze of one that is none."""
    stayed = before.human_row == after.human_row and before.human_col == after.human_col
    towards = (before.angle + N_DIRECTIONS // 2) % N_DIRECTIONS
    faces = 1.0 if after.human_heading == towards else 0.0
    likelihood[GREETED] = likelihood[CALLED] = faces if stayed else 0.0
    if is_gesture(action):
        likelihood[FOLLOWING] = likelihood[GREETED]
    else:
        likelihood[FOLLOWING] = faces * _ends_there(parameters, lab, before, after, towards)
    redrawn = parameters[P_O] / N_DIRECTIONS
    for direction in range(-1, N_DIRECTIONS):  # -1: it does not move
        if direction < 0:
            path, heading = (1.0 - parameters[P_M]) * (1.0 if stayed else 0.0), before.human_heading
        else:
            path = parameters[P_M] / N_DIRECTIONS * _ends_there(parameters, lab, before, after, direction)
            heading = direction
        gaze = redrawn + (1.0 - parameters[P_O] if after.human_heading == heading else 0.0)
        likelihood[NONE] += path * gaze
        events[1] += path * redrawn
        if direction >= 0:
            events[0] += path * gaze
    if likelihood[NONE] > 0.0:
        events /= likelihood[NONE]


@kernel
def _ends_there(parameters: Floats, lab: Lab, before: Scene, after: Scene, direction: int) -> float:
    """The probability that a move of the human in a direction ends where it stands after the step."""
    chance = 0.0
    for slower in range(MAX_SPEED):
        row, col = move(lab, before.human_row, before.human_col, direction, slower + 1, before.open_doors)
        if row == after.human_row and col == after.human_col:
            chance += parameters[slower]
    return chance


@kernel
def _count_speed(belief: Belief, lab: Lab, before: Scene, after: Scene, action: int) -> None:
    """Share a displacement out among the speeds at which it ends where it did."""
    rows, cols = after.human_row - before.human_row, after.human_col - before.human_col
    if rows == 0 and cols == 0:
        return
    for direction in range(N_DIRECTIONS):
        chance = _ends_there(belief.parameters, lab, before, after, direction)
        if chance > 0.0:
            for slower in range(MAX_SPEED):
                row, col = move(lab, before.human_row, before.human_col, direction, slower + 1, before.open_doors)
                if row == after.human_row and col == after.human_col:
                    belief.speeds[slower] += belief.parameters[slower] / chance
            return


@kernel
def learn_parameters(belief: Belief) -> None:
    """Make the parameters what was seen, with the prior: (10 x prior + events) / (10 + chances)."""
    for place, event in _EVENT_OF:
        happened, chances = 0.0, 0.0
        for engagement in range(N_ENGAGEMENTS):
            happened += belief.now[engagement] * belief.sums[engagement, event]
            chances += belief.now[engagement] * belief.sums[engagement, event + 1]
        belief.parameters[place] = (STRENGTH * PRIOR[place] + happened) / (STRENGTH + chances)
    total = belief.speeds.sum()
    for slower in range(MAX_SPEED):
        belief.parameters[slower] = (STRENGTH / MAX_SPEED + belief.speeds[slower]) / (STRENGTH + total)
