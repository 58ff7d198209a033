"""The social task as tables for who sees all: what the robot's actions do, how the human reacts, by the world's rules.

All is relative: an offset is the robot's cell less the human's. Every table is made by running the world's own text
in all ways that its draws can fall (`draws.py`), so no rule stands here again. What is said here is only what each of
them depends on: a human's engagement on what it sees and how far the robot is, its behaviour on the angle and where
it looks; the robot's body on its heading and the angle, or, where it teleports, on where the human looks.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.exact.draws import outcomes
from visitlab_cli.humans.six_parameters import Human, behave, engage
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS, Action, Engagement
from visitlab_cli.world.human import GESTURES, follows_in_direction
from visitlab_cli.world.scene import NOWHERE, Body, Scene, first_scene, related
from visitlab_cli.world.social import Social, make_social, step

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
N_ENGAGEMENTS = len(Engagement)
KINDS = (*GESTURES, Action.STAY.value)
"""Actions of which each is another to the human; all but gestures are as staying."""
OTHER = len(KINDS) - 1
STILL = Human(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
"""A human that draws nothing at random, beside whom the robot's part of a step is seen."""


class Way(NamedTuple):
    """One way to behave: rows and columns gone, heading and engagement after it, reward by desired direction."""

    rows: int
    cols: int
    heading: int
    engagement: int
    reward: tuple[float, ...]


Manner = dict[Way, float]
"""The ways in which a human may behave, with their probabilities."""


class Put(NamedTuple):
    """Where teleporting puts the robot, as an offset from where the human was, with which probability."""

    row: int
    col: int
    heading: int
    probability: float


class SocialModel(NamedTuple):
    """The tables; offsets reach from -reach to reach and are clipped there, `sees` numbers what the human perceives.

    `engages` is the probability of each engagement after a step, shape (seen, engagements, kinds, engagements);
    `manner` the number of the manner that follows, shape (kinds, engagements, angles, headings).
    """

    reach: int
    angle: Ints  # (offsets, offsets)
    sees: Ints  # (human's headings, offsets, offsets, robot's headings)
    engages: Floats
    manner: Ints
    manners: list[Manner]
    robot: Ints  # rows, columns, heading after each action but the last: (actions, robot's headings, angles, 3)
    puts: list[list[Put]]  # by the human's heading
    teleports: npt.NDArray[np.bool_]  # (engagements,): where the last action does; elsewhere it is a stay
    desired: Floats  # (directions, directions): the next by the last


class _Floor(NamedTuple):
    """A floor on which nobody meets a border, and its middle, where the human stands."""

    task: Social
    middle: int

    def scene(self, row: int, col: int, robot_heading: int, human_heading: int, engagement: int = 0) -> Scene:
        """The robot at an offset from the human."""
        robot = Body(self.middle + row, self.middle + col, robot_heading)
        human = Body(self.middle, self.middle, human_heading)
        first = first_scene(self.task.lab, self.task.geometry, NOWHERE, robot, human)
        aimed = first._replace(engagement=engagement, desired_direction=0, goal_room=0)
        return related(self.task.lab, self.task.geometry, aimed)


def social_model(human: Human, distances: tuple[int, ...], reach: int, direction_change: float) -> SocialModel:
    """The tables of a human.

    Args:
        human: its record.
        distances: the four thresholds, in cells.
        reach: the largest offset told from larger ones, in cells.
        direction_change: the probability of another desired direction in a step.
    """
    middle = reach + 2 * MAX_SPEED
    floor = _Floor(make_social(human, 1, 2 * middle + 1, direction_change, distances), middle)
    side = range(-reach, reach + 1)
    angle = np.empty((len(side), len(side)), np.int64)
    sees = np.empty((N_DIRECTIONS, len(side), len(side), N_DIRECTIONS), np.int64)
    seen: dict[tuple[int, int], Scene] = {}
    number: dict[tuple[int, int], int] = {}
    for place in np.ndindex(sees.shape):
        heading, row, col, robot_heading = (int(each) for each in place)
        scene = floor.scene(side[row], side[col], robot_heading, heading)
        view = scene.distance, scene.interaction_level
        seen.setdefault(view, scene)
        angle[row, col] = scene.angle
        sees[place] = number.setdefault(view, len(number))
    by_angle = [(side[row], side[col]) for row, col in (np.argwhere(angle == each)[0] for each in range(N_DIRECTIONS))]
    manner, manners = _manners(human, floor, by_angle)
    puts, teleports = _teleporting(floor)
    return SocialModel(
        reach,
        angle,
        sees,
        _engages(human, floor, list(seen.values())),
        manner,
        manners,
        _robot(floor, by_angle),
        puts,
        teleports,
        _desired(floor),
    )


def _engages(human: Human, floor: _Floor, seen: list[Scene]) -> Floats:
    table = np.zeros((len(seen), N_ENGAGEMENTS, len(KINDS), N_ENGAGEMENTS))
    for view, before, kind in np.ndindex(table.shape[:3]):
        scene = seen[view]._replace(engagement=int(before))
        for after, probability in outcomes(engage, human, floor.task.geometry, scene, KINDS[kind]).items():
            table[view, before, kind, after] = probability
    return table


def _manners(human: Human, floor: _Floor, by_angle: list[tuple[int, int]]) -> tuple[Ints, list[Manner]]:
    numbers: dict[frozenset[tuple[Way, float]], int] = {}
    table = np.empty((len(KINDS), N_ENGAGEMENTS, N_DIRECTIONS, N_DIRECTIONS), np.int64)
    found: list[Manner] = []
    paid: dict[tuple[int, int], tuple[float, ...]] = {}
    for kind, engagement, angle, heading in np.ndindex(table.shape):
        scene = floor.scene(*by_angle[angle], 0, int(heading))
        manner: Manner = {}
        reactions = outcomes(behave, human, floor.task.lab, scene, int(engagement), KINDS[kind])
        for reaction, probability in reactions.items():
            after = scene._replace(**reaction._asdict())
            done = after.engagement, after.human_action
            if done not in paid:
                paid[done] = tuple(float(follows_in_direction(after, each)) for each in range(N_DIRECTIONS))
            gone = after.human_row - scene.human_row, after.human_col - scene.human_col
            way = Way(*gone, after.human_heading, after.engagement, paid[done])
            manner[way] = manner.get(way, 0.0) + probability
        key = frozenset(manner.items())
        if key not in numbers:
            numbers[key] = len(found)
            found.append(manner)
        table[kind, engagement, angle, heading] = numbers[key]
    return table, found


def _bodies(floor: _Floor, scene: Scene, action: int) -> dict[Body, float]:
    """Where a step leaves the robot, less where the human was."""
    task = floor.task._replace(human=STILL, direction_change=0.0)
    bodies: dict[Body, float] = {}
    for (after, _, _), probability in outcomes(step, task, scene, action).items():
        row, col = after.robot_row - scene.human_row, after.robot_col - scene.human_col
        body = Body(row, col, after.robot_heading)
        bodies[body] = bodies.get(body, 0.0) + probability
    return bodies


def _robot(floor: _Floor, by_angle: list[tuple[int, int]]) -> Ints:
    table = np.empty((Action.GO_TO_HUMAN_VISION.value, N_DIRECTIONS, N_DIRECTIONS, 3), np.int64)
    for action, heading, angle in np.ndindex(table.shape[:3]):
        offset = by_angle[angle]
        (body,) = _bodies(floor, floor.scene(*offset, int(heading), 0), int(action))
        table[action, heading, angle] = body.row - offset[0], body.col - offset[1], body.heading
    return table


def _teleporting(floor: _Floor) -> tuple[list[list[Put]], npt.NDArray[np.bool_]]:
    """Where it puts the robot by the human's heading, and at which engagements."""
    far = floor.task.geometry.reach // 4  # from where it puts the robot
    puts: list[list[Put]] = [[] for _ in range(N_DIRECTIONS)]
    teleports = np.zeros(N_ENGAGEMENTS, np.bool_)
    for heading in range(N_DIRECTIONS):
        for engagement in range(N_ENGAGEMENTS):
            scene = floor.scene(far, far, 0, heading, engagement)
            bodies = _bodies(floor, scene, Action.GO_TO_HUMAN_VISION.value)
            if bodies != _bodies(floor, scene, Action.STAY.value):
                teleports[engagement] = True
                puts[heading] = [Put(*body, probability) for body, probability in bodies.items()]
    return puts, teleports


def _desired(floor: _Floor) -> Floats:
    table = np.zeros((N_DIRECTIONS, N_DIRECTIONS))
    task = floor.task._replace(human=STILL)
    for before in range(N_DIRECTIONS):
        scene = floor.scene(floor.middle // 2, 0, 0, 0)._replace(desired_direction=before)
        for (after, _, _), probability in outcomes(step, task, scene, Action.STAY.value).items():
            table[before, after.desired_direction] += probability
    return table
