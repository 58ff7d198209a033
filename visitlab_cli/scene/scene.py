"""A trial's scene: the shapes of its place, and those of each moment in it, from back to front."""

from collections.abc import Iterator

import numpy as np

from visitlab_cli.scene.colours import DESIRED, HUMAN, INK, ROBOT
from visitlab_cli.scene.lab import arena_shapes, goal_shapes, lab_shapes, reached_shape
from visitlab_cli.scene.shapes import Arrow, Body, Line, Role, Shape, Sight, Speech, Style, Vectors
from visitlab_cli.scene.sight import REACH, cells_seen, fields_around, unwalled_around
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.view import sign_to, view_of
from visitlab_cli.scene.words import GESTURES, executed, open_doors_in
from visitlab_cli.world.enums import Action
from visitlab_cli.world.sight import Walls

COLOURS = {"robot": ROBOT, "human": HUMAN}
BODIES = {"robot": Role.ROBOT, "human": Role.HUMAN}
WAYS = {"robot": Role.ROBOT_WAY, "human": Role.HUMAN_WAY}
WANTED = {"robot": Role.WANTED_ROBOT, "human": Role.WANTED_HUMAN}
SAYS = {"robot": Role.ROBOT_SAYS, "human": Role.HUMAN_SAYS}
TRAIL_STEPS = 8
"""The last steps of a way that a drawer shows strongly."""
ASIDE, NARROW = {"robot": 0.4, "human": -0.4}, 0.75
"""Who share a cell stand so many cells east of its middle, and are so much narrower: both are to be seen."""
BUBBLE_NEEDS = 3
"""Rows north of the robot that a bubble above it needs."""


class Scene:
    """The shapes of a trial; `view` is what is seen of the world, as ranges of x and y in cells."""

    def __init__(self, trial: Trial) -> None:
        """Nothing is drawn yet."""
        self.trial = trial
        self.view = view_of(trial)
        self._who = ("human", "robot") if trial.has_human else ("robot",)
        self._places = {who: trial.places(who) for who in self._who}
        self._ahead = {who: trial.headings(f"{who}_heading") for who in self._who}
        self._executed = executed(trial.steps)
        self._desired = trial.headings("desired_direction") if trial.has_engagement else None

    def place(self) -> list[Shape]:
        """What stays as it is: floor, tiles, rooms."""
        if not self.trial.has_rooms:
            return arena_shapes(self.trial.rows, *self.view)
        return lab_shapes(self.trial.lab, open_doors_in(self.trial.steps))

    def moment(self, step: int) -> list[Shape]:
        """What is to be seen after a step; of step 0 how the trial begins."""
        return list(self._moment(step))

    def moments(self) -> list[list[Shape]]:
        """What is to be seen after each step, step 0 first."""
        return [self.moment(step) for step in range(self.trial.length)]

    def share_a_cell(self, step: int) -> bool:
        """Whether robot and human stand in the same cell."""
        return self.trial.has_human and bool((self._places["robot"][step] == self._places["human"][step]).all())

    def _moment(self, step: int) -> Iterator[Shape]:
        steps, lab = self.trial.steps, self.trial.lab
        if self.trial.has_goal:
            yield from goal_shapes(lab, int(steps["goal_room"][step]))
            if self.trial.plays.counts_goals and step and steps["reward"][step] > 0:
                yield reached_shape(lab, int(steps["goal_room"][step - 1]))
        if self.trial.has_human:
            yield self._sight(step)
        for who in self._who:
            yield Line(WAYS[who], self._places[who][: step + 1], Style(COLOURS[who], 0.15))
        if self._desired is not None:
            yield _arrow(
                Role.DESIRED, self._places["human"][step], self._desired[step], (1.2, 3.4), Style(DESIRED, 0.4)
            )
        if self.trial.has_plan and steps["plan_leads"][step]:
            for who in self._who:
                yield self._wanted(who, step)
        for who in self._who:
            yield self._body(who, step)
        if self.trial.has_human:
            sign = sign_to(self._places["robot"][step], self._places["human"][step], self.view)
            if sign is not None and not self.trial.has_rooms:
                yield sign
        action = int(self._executed[step])
        if action == Action.POINT and self._desired is not None and step:
            way = self._desired[step - 1]  # that of the step after is another where a goal was reached
            yield _arrow(Role.POINTED, self._places["robot"][step], way, (0.8, 2.6), Style(INK, 0.2))
        if action in GESTURES:
            x, y = map(float, self._places["robot"][step])
            yield Speech(SAYS["robot"], (x, y), GESTURES[Action(action)], above=y > BUBBLE_NEEDS)

    def _body(self, who: str, step: int) -> Body:
        place, style = self._places[who][step], Style(COLOURS[who], 0.24)
        heading, ahead = int(self.trial.steps[f"{who}_heading"][step]), self._ahead[who][step]
        if self.share_a_cell(step):
            return Body(BODIES[who], place + np.array([ASIDE[who], 0], np.float32), heading, ahead, style, NARROW)
        return Body(BODIES[who], place, heading, ahead, style)

    def _wanted(self, who: str, step: int) -> Line:
        """The border of the cell that the plan wants robot or human in."""
        row, col = (int(self.trial.steps[f"wanted_{who}_{axis}"][step]) for axis in ("row", "col"))
        corners = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (0, 0)], np.float32)
        return Line(WANTED[who], corners + np.array([col, row], np.float32), Style(COLOURS[who], 0.14))

    def _sight(self, step: int) -> Sight:
        trial = self.trial
        row, col, heading = (int(trial.steps[f"human_{name}"][step]) for name in ("row", "col", "heading"))
        cells = cells_seen(row, col, heading, (trial.rows, trial.cols), trial.distances)
        walled = trial.has_rooms and isinstance(trial.lab.walls, Walls)
        if walled:
            cells = cells * unwalled_around(trial.lab, row, col, open_doors_in(trial.steps))
        near = fields_around(trial.distances)[1]
        corner = np.array([col - REACH, row - REACH], np.float32)
        return Sight(
            Role.SIGHT, self._places["human"][step], heading, corner, cells, near, float(trial.distances[-1]), walled
        )


def _arrow(role: Role, place: Vectors, way: Vectors, ends: tuple[float, float], style: Style) -> Arrow:
    """An arrow from a place on, along a unit vector, between two distances from there."""
    start, end = ends
    return Arrow(role, place + start * way, place + end * way, style)
