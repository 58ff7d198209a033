"""Replay a cell's log step by step against the rules and tell every contradiction."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from visitlab_cli.world.enums import Action, Direction, Engagement

from . import rules
from .frequencies import check_frequencies, odd
from .lab import NO_DOORS, Lab
from .settings import Settings, best_directions_of, greedy_moves_of, ranges
from .tally import Frequency

__all__ = [
    "Frequency",
    "Lab",
    "Settings",
    "Violation",
    "best_directions_of",
    "check_frequencies",
    "check_log",
    "greedy_moves_of",
]

LONGEST_MOVE = 3


class Violation(NamedTuple):
    """A value that the rules forbid; row -1 where it concerns a whole column."""

    row: int
    column: str
    expected: Any
    got: Any


def check_log(columns: Mapping[str, np.ndarray], task: str, **settings: Any) -> list[Violation]:
    """Every contradiction between a cell's log and TASK.md; an empty list where there is none.

    Each row is judged from the logged row before it, so that one wrong value is not told again for
    the rest of the log.

    Args:
        columns: the columns of the task by name, all rows in order, those of step 0 included.
        task: navigation, go_to_human, social or visit.
        **settings: the fields of `Settings`.
    """
    return _Replay(columns, Settings(task=task, **settings)).run()


class _Replay:
    """One log under examination."""

    def __init__(self, columns: Mapping[str, np.ndarray], settings: Settings) -> None:
        self.settings = settings
        self.task = settings.task
        self.place = settings.place()
        self.humans = settings.make_humans() if settings.has_reactions else []
        self.source = columns
        self.columns: dict[str, list[Any]] = {}
        self.violations: list[Violation] = []
        self.n_rows = 0

    def run(self) -> list[Violation]:
        if not self._columns_fit():
            return self.violations
        self.columns = {name: np.asarray(self.source[name]).tolist() for name in self.settings.columns}
        unreadable = self._out_of_range()
        steps = self.columns["step"]
        for i in range(self.n_rows):
            self._numbering(i)
            if i in unreadable:
                continue
            self._doors(i, known_before=i > 0 and i - 1 not in unreadable)
            self._consistent(i)
            if steps[i] == 0:
                self._start(i, known_before=i > 0 and i - 1 not in unreadable)
            elif i > 0 and i - 1 not in unreadable:
                self._step(i)
        self._complete()
        return self.violations

    @property
    def grid(self) -> rules.Grid:
        """That of the trial of the row that is judged."""
        return self.place.grid

    # -------------------------------------------------------------------------------- the whole log

    def _columns_fit(self) -> bool:
        wanted, found = set(self.settings.columns), set(self.source)
        for name in sorted(wanted - found):
            self.violations.append(Violation(-1, name, "a column", "none"))
        for name in sorted(found - wanted):
            self.violations.append(Violation(-1, name, f"no such column in {self.task}", "a column"))
        lengths = {name: len(self.source[name]) for name in wanted & found}
        if len(set(lengths.values())) > 1:
            self.violations.append(Violation(-1, "*", "columns of one length", lengths))
        self.n_rows = max(lengths.values(), default=0)
        if self.n_rows == 0:
            self.violations.append(Violation(-1, "*", "at least one row", 0))
        return not self.violations

    def _out_of_range(self) -> set[int]:
        bad: set[int] = set()
        for name, (low, high) in ranges(self.settings, self.grid).items():
            values = np.asarray(self.source[name]).astype(np.float64)
            fits = (values >= low) & (values <= high) & (values == np.floor(values))
            for i in np.flatnonzero(~fits).tolist():
                self._tell(i, name, f"a whole number, {low} to {high}", self.columns[name][i])
                bad.add(i)
        return bad

    def _complete(self) -> None:
        last = self.columns["step"][-1]
        if not self.settings.partial_last_trial and last != self.settings.steps_in_trial:
            self._tell(self.n_rows - 1, "step", f"{self.settings.steps_in_trial} in the last row", last)

    # ---------------------------------------------------------------------------------- small tools

    def _tell(self, i: int, column: str, expected: Any, got: Any) -> None:
        self.violations.append(Violation(i, column, expected, got))

    def _is(self, i: int, column: str, expected: Any) -> bool:
        got = self.columns[column][i]
        if got == expected:
            return True
        self._tell(i, column, expected, got)
        return False

    def _among(self, i: int, column: str, allowed: Any) -> bool:
        got = self.columns[column][i]
        if got in allowed:
            return True
        self._tell(i, column, f"one of {sorted(allowed)}", got)
        return False

    def _robot(self, i: int) -> rules.Cell:
        return self.columns["robot_row"][i], self.columns["robot_col"][i]

    def _human(self, i: int) -> rules.Cell:
        return self.columns["human_row"][i], self.columns["human_col"][i]

    def _geometry(self, i: int) -> rules.Geometry:
        c = self.columns
        return rules.geometry_in(
            self.grid,
            self._robot(i),
            c["robot_heading"][i],
            self._human(i),
            c["human_heading"][i],
            self.settings.distances,
        )

    def _engagement(self, i: int) -> int:
        return rules.engagement_of(self.columns["interaction_level"][i])

    # ------------------------------------------------------------------------------------ every row

    def _numbering(self, i: int) -> None:
        c = self.columns
        if i == 0:
            self._is(i, "trial", 0)
            self._is(i, "step", 0)
        elif c["step"][i - 1] == self.settings.steps_in_trial:
            self._is(i, "trial", c["trial"][i - 1] + self.settings.trial_stride)
            self._is(i, "step", 0)
        else:
            self._is(i, "trial", c["trial"][i - 1])
            self._is(i, "step", c["step"][i - 1] + 1)

    def _doors(self, i: int, known_before: bool) -> None:
        """Which doors are open, and so where the trial takes place; they toggle before a trial only."""
        c, settings = self.columns, self.settings
        trial = c["trial"][i]
        self.place = settings.place(trial)
        if not settings.n_doors:
            return
        lab, now = settings.lab_in(trial), c["open_doors"][i]
        if lab is None or not lab.toggled:
            self._is(i, "open_doors", NO_DOORS)
        elif not 0 <= now < 2 ** len(lab.toggled):
            self._tell(i, "open_doors", f"the bits of {lab.toggled}", now)
        else:
            self.place = settings.place(trial, now)
            if c["step"][i] > 0:
                self._is(i, "open_doors", c["open_doors"][i - 1] if known_before else now)
            elif i == 0 or known_before:
                last = c["trial"][i - 1] if i > 0 else None
                same_phase = last is not None and settings.phase_of(last) == settings.phase_of(trial)
                before = c["open_doors"][i - 1] if same_phase else lab.open_at_first
                times = settings.toggles_of(trial, last)
                for door, p in lab.toggling.items():
                    toggled = lab.is_open(door, now) != lab.is_open(door, before)
                    if odd(p, times) in (0, 1) and toggled != odd(p, times):
                        self._tell(i, "open_doors", f"{door} toggles with probability {odd(p, times)}", now)

    def _consistent(self, i: int) -> None:
        """What follows from the other values of the same row: phase, geometry, level, state."""
        c = self.columns
        if self.settings.phases:
            self._is(i, "phase", self.settings.phase_of(c["trial"][i]))
        if self.task == "navigation":
            self._is(i, "state", rules.navigation_state(self.grid, c["goal_room"][i], self._robot(i)))
            return
        geo = self._geometry(i)
        self._is(i, "distance", geo.distance)
        self._is(i, "angle", geo.angle)
        engagement = self._engagement(i) if self.settings.has_reactions else Engagement.NONE
        level = rules.interaction_level(geo, engagement)
        self._is(i, "interaction_level", level)
        if self.task == "go_to_human":
            state = rules.go_to_human_state(geo.angle, c["human_heading"][i], geo.distance)
        else:
            state = rules.social_state(level, geo.distance, c["desired_direction"][i], geo.angle)
        self._is(i, "state", state)

    # ------------------------------------------------------------------------------ a trial's first row

    def _start(self, i: int, known_before: bool) -> None:
        for who in ("robot", "human") if self.settings.has_human else ("robot",):
            cell = self.columns[f"{who}_row"][i], self.columns[f"{who}_col"][i]
            if cell not in self.place.reachable:
                self._tell(i, f"{who}_row, {who}_col", "a cell that can be reached", cell)
        self._is(i, "action", Action.NO_ACTION)
        self._is(i, "explored", 0)
        self._is(i, "reward", 0)
        if self.task == "navigation":
            east_or_kept = {int(Direction.EAST)}
            if i > 0 and (known_before or self.settings.trial_stride > 1):
                kept = self.columns["robot_heading"][i - 1]
                east_or_kept |= {kept} if self.settings.trial_stride == 1 else set(range(8))
            self._among(i, "robot_heading", east_or_kept)
            self._among(i, "goal_room", self.place.goals)
        if self.settings.has_reactions:
            self._is(i, "human_action", Action.NO_ACTION)
            if self._engagement(i) != Engagement.NONE:
                level = rules.interaction_level(self._geometry(i))
                self._tell(i, "interaction_level", level, self.columns["interaction_level"][i])
        if self.task == "social":
            self._is(i, "human_row", self.grid.height // 2)
            self._is(i, "human_col", self.grid.width // 2)
        if self.task == "visit":
            self._start_of_visit(i, known_before)

    def _start_of_visit(self, i: int, known_before: bool) -> None:
        self._is(i, "executed_action", Action.NO_ACTION)
        self._is(i, "social_reward", 0)
        carried = known_before and self.settings.trial_stride == 1
        if carried and self.columns["goal_room"][i - 1] in self.place.goals:
            self._is(i, "goal_room", self.columns["goal_room"][i - 1])
        else:
            self._among(i, "goal_room", self.place.goals)
        self._desired_direction(i, self.columns["desired_direction"][i - 1] if carried else None)

    # ------------------------------------------------------------------------------------------ a step

    def _step(self, i: int) -> None:
        c = self.columns
        action = c["action"][i]
        if action >= self.settings.n_actions:
            self._tell(i, "action", f"below {self.settings.n_actions}", action)
            return
        if self.settings.epsilon in (0, 1):
            self._is(i, "explored", self.settings.epsilon)
        if self.task == "navigation":
            self._robot_moves(i, action, angle=0)
            self._is(i, "goal_room", c["goal_room"][i - 1])
            self._is(i, "reward", rules.navigation_reward(self.grid, c["goal_room"][i - 1], self._robot(i)))
        elif self.task == "go_to_human":
            self._robot_moves(i, action, angle=c["angle"][i - 1])
            for column in ("human_row", "human_col", "human_heading"):
                self._is(i, column, c[column][i - 1])
            self._is(i, "reward", rules.go_to_human_reward(self._geometry(i), self.settings.success))
        elif self.task == "social":
            self._social_step(i, action)
        else:
            self._visit_step(i, action)

    def _robot_moves(self, i: int, action: int, angle: int) -> None:
        heading = self.columns["robot_heading"][i - 1]
        cell, heading = rules.robot_after(self.grid, self._robot(i - 1), heading, action, angle)
        self._robot_is_at(i, cell)
        self._is(i, "robot_heading", heading)

    def _robot_is_at(self, i: int, cell: rules.Cell) -> None:
        self._is(i, "robot_row", cell[0])
        self._is(i, "robot_col", cell[1])

    def _social_step(self, i: int, action: int) -> None:
        c = self.columns
        perceived = self._geometry(i - 1)
        if action != Action.GO_TO_HUMAN_VISION:
            self._robot_moves(i, action, perceived.angle)
        elif self._engagement(i - 1) == Engagement.NONE:
            target = rules.teleport_target(self.grid, self._human(i - 1), c["human_heading"][i - 1])
            self._robot_is_at(i, target)
        else:
            self._robot_moves(i, Action.STAY, perceived.angle)
        self._human_reacts(i, perceived, action)
        desired = c["desired_direction"][i - 1]
        self._is(i, "reward", rules.social_reward(self._engagement(i), c["human_action"][i], desired))
        if self.settings.direction_change == 0:
            self._is(i, "desired_direction", desired)

    def _visit_step(self, i: int, action: int) -> None:
        c = self.columns
        perceived = self._geometry(i - 1)
        executed = c["executed_action"][i]
        if action == Action.GO_TO_HUMAN_VISION:
            state = rules.go_to_human_state(perceived.angle, c["human_heading"][i - 1], perceived.distance)
            self._among(i, "executed_action", self.settings.moves_at(state))
        else:
            self._is(i, "executed_action", action)
        if executed < Action.GO_TO_HUMAN_VISION:
            self._robot_moves(i, executed, perceived.angle)
            self._human_reacts(i, perceived, executed)
        before, after = self._robot(i - 1), self._robot(i)
        if max(abs(after[0] - before[0]), abs(after[1] - before[1])) > LONGEST_MOVE:
            self._tell(i, "robot_row, robot_col", f"at most {LONGEST_MOVE} cells from {before}", after)
        desired = c["desired_direction"][i - 1]
        earned = rules.social_reward(self._engagement(i), c["human_action"][i], desired)
        self._is(i, "social_reward", earned if self.settings.social_reward == "social" else 0)
        goal = c["goal_room"][i - 1]
        reached = rules.visit_reward(self.grid, goal, self._human(i))
        self._is(i, "reward", reached)
        if reached:
            self._among(i, "goal_room", self.place.goals - {goal})
        else:
            self._is(i, "goal_room", goal)
        self._desired_direction(i, desired)

    def _desired_direction(self, i: int, current: int | None) -> None:
        cell = self.grid.cell_number(self._human(i))
        best = self.settings.directions_at(self.columns["goal_room"][i], cell)
        if self.settings.best_directions is not None and current in best:
            self._is(i, "desired_direction", current)
        else:
            self._among(i, "desired_direction", best)

    def _human_reacts(self, i: int, perceived: rules.Geometry, action: int) -> None:
        """The human's engagement, action, cell and heading have a positive probability together."""
        c, gesture = self.columns, rules.gesture_of(action)
        human = self.settings.human_in(self.humans, c["trial"][i])
        assert human is not None
        before, after = self._engagement(i - 1), self._engagement(i)
        acted, heading = c["human_action"][i], c["human_heading"][i - 1]
        cell = self.grid.after(self._human(i - 1), acted)
        self._is(i, "human_row", cell[0])
        self._is(i, "human_col", cell[1])
        engagements = rules.engagement_outcomes(before, perceived, gesture, human)
        if after not in engagements:
            allowed = f"engagement {before} becomes one of {sorted(engagements)}"
            self._tell(i, "interaction_level", allowed, c["interaction_level"][i])
        elif self._among(i, "human_action", rules.movement_outcomes(after, perceived.angle, gesture, human)):
            moved = rules.heading_after(heading, acted)
            self._among(i, "human_heading", rules.gaze_outcomes(after, perceived.angle, moved, human))
