"""Backward induction over the tables of the social task: V_0 = 0, V_k(s) = max_a E[r + V_{k-1}(s')].

States are numbered as an array (engagement, human's heading, row, column, robot's heading), the offset being rows and
columns; values have the desired direction as a last axis. What does not depend on the robot's heading, as no move does,
is computed once for all eight. A step is taken in two halves: `awaiting` is what is to come
once the robot has acted and the human's manner is decided, by manner, the new offset from where the human was, and
the robot's new heading.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.exact.social_model import KINDS, N_ENGAGEMENTS, OTHER, Floats, Ints, Manner, SocialModel
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS, N_SOCIAL_ACTIONS, Action

VISION = Action.GO_TO_HUMAN_VISION.value
Bytes = npt.NDArray[np.uint8]


class Future(NamedTuple):
    """For some states an engagement that may follow: with which probability, shape (states, 1), and which manner."""

    states: Ints
    probability: Floats
    manner: Ints


class States(NamedTuple):
    """Parts of all states, or of those with one of the robot's headings: each of shape (states,).

    And by kind of action what may become of the human.
    """

    engagement: Ints
    heading: Ints
    row: Ints
    col: Ints
    robot_heading: Ints
    angle: Ints
    futures: list[list[Future]]


def shape_of(model: SocialModel) -> tuple[int, int, int, int, int]:
    """Of the states as an array."""
    side = 2 * model.reach + 1
    return N_ENGAGEMENTS, N_DIRECTIONS, side, side, N_DIRECTIONS


def states_of(model: SocialModel, robot_headings: int = N_DIRECTIONS) -> States:
    """All states of a model with the first so many of the robot's headings."""
    engagement, heading, row, col, robot_heading = (
        each.ravel() for each in np.indices((*shape_of(model)[:-1], robot_headings))
    )
    angle = model.angle[row, col]
    sees = model.sees[heading, row, col, robot_heading]
    futures = []
    for kind in range(len(KINDS)):
        after = model.engages[sees, engagement, kind]
        manner = model.manner[kind][:, angle, heading]
        of_kind = []
        for following in range(N_ENGAGEMENTS):
            states = np.flatnonzero(after[:, following])
            of_kind.append(Future(states, after[states, following, None], manner[following, states]))
        futures.append([each for each in of_kind if len(each.states)])
    return States(engagement, heading, row, col, robot_heading, angle, futures)


def _unturned(model: SocialModel) -> list[bool]:
    """For each action but the last: whether nothing that follows depends on the robot's heading."""
    engages = model.engages[model.sees]  # (headings, rows, columns, robot's headings, engagements, kinds, engagements)
    alike = (engages == engages[:, :, :, :1]).all(axis=(0, 1, 2, 3, 4, 6))
    return [
        bool(alike[kind_of(action)] and (model.robot[action] == model.robot[action, :1]).all())
        for action in range(VISION)
    ]


def direction_blind(model: SocialModel) -> SocialModel:
    """The model of who never looks at the desired direction: one direction, in which a move pays the mean reward.

    So it does, for that is uniform at a trial's start, and at each redrawing.
    """
    manners: list[Manner] = []
    for manner in model.manners:
        blind: Manner = {}
        for way, chance in manner.items():
            same = way._replace(reward=(float(np.mean(way.reward)),))
            blind[same] = blind.get(same, 0.0) + chance
        manners.append(blind)
    return model._replace(manners=manners, desired=np.ones((1, 1)))


def kind_of(action: int) -> int:
    """The number of an action's kind."""
    return KINDS.index(action) if action in KINDS else OTHER


def awaiting(model: SocialModel, values: Floats) -> Floats:
    """What is to come after the robot's half of a step: (manners, rows, columns, robot's headings, directions).

    Rows and columns reach `MAX_SPEED` cells farther than a state's.
    """
    side = 2 * model.reach + 1
    wide = side + 2 * MAX_SPEED
    hoped = (values @ model.desired.T).reshape(N_ENGAGEMENTS * N_DIRECTIONS, side, side, -1)
    farther = [(0, 0), (2 * MAX_SPEED, 2 * MAX_SPEED), (2 * MAX_SPEED, 2 * MAX_SPEED), (0, 0)]
    hoped = np.pad(hoped, farther, mode="edge")
    found = np.zeros((len(model.manners), wide, wide, N_DIRECTIONS, len(model.desired)))
    for (rows, cols), mixture in _mixtures(model.manners).items():
        manners, human = np.flatnonzero(mixture.any(axis=1)), np.flatnonzero(mixture.any(axis=0))
        south, east = MAX_SPEED - rows, MAX_SPEED - cols  # the human goes one way, the robot's offset the other
        there = hoped[human, south : south + wide, east : east + wide].reshape(len(human), -1)
        found[manners] += (mixture[np.ix_(manners, human)] @ there).reshape(len(manners), *found.shape[1:])
    for number, manner in enumerate(model.manners):
        found[number] += sum(chance * np.array(way.reward) for way, chance in manner.items())
    return found


def _mixtures(manners: Sequence[Manner]) -> dict[tuple[int, int], Floats]:
    """By where the human goes: the probability of each engagement and heading, for each manner."""
    found: dict[tuple[int, int], Floats] = {}
    for number, manner in enumerate(manners):
        for way, chance in manner.items():
            empty = np.zeros((len(manners), N_ENGAGEMENTS * N_DIRECTIONS))
            mixture = found.setdefault((way.rows, way.cols), empty)
            mixture[number, way.engagement * N_DIRECTIONS + way.heading] += chance
    return found


class Induction:
    """What a step is worth; made once for a model."""

    def __init__(self, model: SocialModel) -> None:
        """The states and what may follow each."""
        self.model = model
        self._all, self._one_heading = states_of(model), states_of(model, 1)
        self._unturned = _unturned(model)
        self.nothing = np.zeros((len(self._one_heading.row), N_DIRECTIONS, len(model.desired)))
        """The values with no step left: (states of one of the robot's headings, these, directions)."""

    def action_values(self, values: Floats) -> Iterator[tuple[int, Floats]]:
        """Each action, and what it is worth with one step more than `values`, whose shape it has.

        First those for which it does not depend on the robot's heading: there that axis has length 1.
        """
        model = self.model
        to_come = awaiting(model, values)
        for action in sorted(range(VISION), key=lambda action: not self._unturned[action]):
            states = self._one_heading if self._unturned[action] else self._all
            rows, cols, heading = model.robot[action, states.robot_heading, states.angle].T
            worth = _expected(to_come, states.futures[kind_of(action)], states.row + rows, states.col + cols, heading)
            worth = worth.reshape(*values.shape[:1], -1, *values.shape[2:])
            if action == Action.STAY:
                stay = worth
            yield action, worth
        yield VISION, self._vision(to_come, stay)

    def _vision(self, to_come: Floats, stay: Floats) -> Floats:
        """What `go_to_human_vision` is worth: teleporting, where it does, else as staying."""
        model, states, worth = self.model, self._one_heading, stay.copy()
        for heading, puts in enumerate(model.puts):
            here = model.teleports[states.engagement] & (states.heading == heading)
            mean = np.zeros((len(here), len(model.desired)))
            for put in puts:
                parts = put.row + model.reach, put.col + model.reach, put.heading
                place = [np.full(len(here), part) for part in parts]
                mean += put.probability * _expected(to_come, states.futures[OTHER], *place)
            worth[here] = mean[here, None]
        return worth

    def optimal(self, steps: int) -> Iterator[tuple[Floats, Bytes]]:
        """With 1, 2, ... `steps` steps left: the best expected reward and an action that brings it, as `nothing`."""
        values = self.nothing
        for _ in range(steps):
            best, actions = np.full((1, 1, 1), -1.0), np.zeros((1, 1, 1), np.uint8)
            for action, worth in self.action_values(values):
                actions = np.where(worth > best, np.uint8(action), actions)
                best = np.maximum(worth, best)
            values = best
            yield values, actions

    def random(self, steps: int) -> Floats:
        """The expected reward of uniformly random actions in so many steps, as `nothing`."""
        values = self.nothing
        for _ in range(steps):
            total = np.zeros(values.shape)
            for _, worth in self.action_values(values):
                total += worth
            values = total / N_SOCIAL_ACTIONS
        return values


def _expected(to_come: Floats, futures: Sequence[Future], row: Ints, col: Ints, heading: Ints) -> Floats:
    """The mean over what may become of the human, with the robot at an offset and a heading, each (states,)."""
    wide, flat = to_come.shape[1], to_come.reshape(-1, to_come.shape[-1])
    place = ((row + MAX_SPEED) * wide + col + MAX_SPEED) * N_DIRECTIONS + heading
    worth = np.zeros((len(place), flat.shape[1]))
    for states, probability, manner in futures:
        found = flat[manner * (wide * wide * N_DIRECTIONS) + place[states]]
        if len(states) == len(place):
            worth += probability * found
        else:
            worth[states] += probability * found
    return worth
