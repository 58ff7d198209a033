"""Compare how often each random choice fell out each way with its probability in the rules.

Each choice is counted in exactly the situations where its probability applies, and against the
probability that it had there, given everything before it. The number of times that an event happens
then has mean sum(p) and variance sum(p (1 - p)), whatever the agent does.
"""

from collections import Counter
from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np

from visitlab_cli.world.enums import Action, Direction, Engagement

from . import rules
from .lab import NO_DOORS
from .settings import Settings
from .tally import Frequency, Tally


def check_frequencies(columns: Mapping[str, np.ndarray], task: str, **settings: Any) -> list[Frequency]:
    """Observed against expected for each random choice of a log that `check_log` passes.

    Args:
        columns: the columns of the task by name, all rows in order, those of step 0 included.
        task: navigation, go_to_human, social or visit.
        **settings: the fields of `Settings`; the same as for `check_log`.
    """
    return _Counting(columns, Settings(task=task, **settings)).run()


def odd(p: float, times: int) -> float:
    """The probability that what happens with probability p happens an odd number of times."""
    return p if times == 1 else (1 - (1 - 2 * p) ** times) / 2


class _Counting:
    """One log, its choices being counted."""

    def __init__(self, columns: Mapping[str, np.ndarray], settings: Settings) -> None:
        self.settings = settings
        self.task = settings.task
        self.place = settings.place()
        self.humans = settings.make_humans() if settings.has_reactions else []
        self.human: rules.Human | None = None
        self.columns: dict[str, list[Any]] = {n: np.asarray(columns[n]).tolist() for n in settings.columns}
        self.tally = Tally()
        self.shares: dict[tuple[Any, str], dict[int, float]] = {}

    @property
    def grid(self) -> rules.Grid:
        """That of the trial of the row that is counted."""
        return self.place.grid

    def run(self) -> list[Frequency]:
        started = None
        for i, step in enumerate(self.columns["step"]):
            self.human = self.settings.human_in(self.humans, self.columns["trial"][i])
            if step == 0:
                self._doors(i, started)
                self._start(i, started)
                started = i
                continue
            self._exploration(i)
            if self.settings.has_reactions:
                self._human_step(i)
            if self.task == "social":
                self._teleport(i)
                self._direction_change(i)
            if self.task == "visit":
                self._visit_step(i)
        return self.tally.results()

    # ------------------------------------------------------------------------------ a trial's first row

    def _doors(self, i: int, previous: int | None) -> None:
        """Where the trial takes place, and which doors toggled before it."""
        settings, trial = self.settings, self.columns["trial"][i]
        now = self.columns["open_doors"][i] if settings.n_doors else NO_DOORS
        self.place, lab = settings.place(trial, now), settings.lab_in(trial)
        if lab is None or not lab.toggled:
            return
        before, last = lab.open_at_first, None
        if previous is not None:
            last = self.columns["trial"][previous]
            if settings.phase_of(last) == settings.phase_of(trial):
                before = self.columns["open_doors"][previous]
        times = settings.toggles_of(trial, last)
        changes = {}
        for door, p in lab.toggling.items():
            changes[door] = lab.is_open(door, now) != lab.is_open(door, before), odd(p, times)
            way = "shuts" if lab.is_open(door, before) else "opens"
            self.tally.add(f"door {door} {way}", *changes[door])
        for one, other in pairwise(lab.toggled):
            (first, p), (second, q) = changes[one], changes[other]
            self.tally.add(f"doors {one} and {other} both toggle", first and second, p * q)

    def _start(self, i: int, previous: int | None) -> None:
        c, goals = self.columns, sorted(self.place.goals)
        self._start_cell("robot", i)
        headings = [] if self.task == "navigation" else ["robot_heading", "human_heading"]
        if self.task in ("go_to_human", "visit"):
            self._start_cell("human", i)
            for axis in ("row", "col"):
                same = c[f"robot_{axis}"][i] == c[f"human_{axis}"][i]
                self.tally.add(f"start: same {axis}", same, sum(p**2 for p in self._share(axis).values()))
        if self.task == "social":
            headings.append("desired_direction")
        for name in headings:
            self.tally.uniform(f"start: {name}", c[name][i], range(len(Direction)))
            if previous is not None:
                self.tally.add(f"start: {name} as the trial before", c[name][i] == c[name][previous], 1 / 8)
        for a, b in pairwise(headings):
            self.tally.uniform(f"start: {a} - {b}", (c[a][i] - c[b][i]) % 8, range(8))
        carried = self.task == "visit" and i > 0 and self.settings.trial_stride == 1
        if self.task == "navigation" or (self.task == "visit" and i == 0):
            self.tally.uniform("start: goal_room", c["goal_room"][i], goals)
        elif carried and c["goal_room"][i - 1] not in goals:
            self.tally.uniform("start: goal_room in place of one out of reach", c["goal_room"][i], goals)
        if self.task == "navigation":
            room = self.grid.room((c["robot_row"][i], c["robot_col"][i]))
            in_some_goal = sum(self._share("room").get(goal, 0) for goal in goals)
            self.tally.add("start: in the goal room", room == c["goal_room"][i], in_some_goal / len(goals))
        if carried or (self.task == "visit" and i == 0):
            self._direction_draw(i, c["desired_direction"][i - 1] if carried else None)

    def _start_cell(self, who: str, i: int) -> None:
        """Its row and its column where there are few, else bands of five; both diagonals modulo 8; its room."""
        cell = self.columns[f"{who}_row"][i], self.columns[f"{who}_col"][i]
        for name in ("row in bands", "col in bands", "row + col modulo 8", "row - col modulo 8", "room"):
            if name != "room" or self.settings.lab_in(self.columns["trial"][i]):
                self.tally.choice(f"start: {who} {name}", self._aspect(name, cell), self._share(name))

    def _aspect(self, name: str, cell: rules.Cell) -> int:
        row, col = cell
        if name == "room":
            return self.grid.room(cell)
        if "bands" in name:
            n, value = (self.grid.height, row) if "row" in name else (self.grid.width, col)
            return value if n <= 30 else value // 5 * 5
        return {"row": row, "col": col, "row + col modulo 8": (row + col) % 8, "row - col modulo 8": (row - col) % 8}[
            name
        ]

    def _share(self, name: str) -> dict[int, float]:
        """How probable each value of an aspect of a cell is where a trial may begin."""
        starts = self.place.starts
        key = (self.place.reachable, name)
        if key not in self.shares:
            counts = Counter(self._aspect(name, cell) for cell in starts)
            self.shares[key] = {value: count / len(starts) for value, count in sorted(counts.items())}
        return self.shares[key]

    # ------------------------------------------------------------------------------------------ a step

    def _exploration(self, i: int) -> None:
        epsilon, explored = self.settings.epsilon, bool(self.columns["explored"][i])
        if epsilon is not None:
            self.tally.add("explores", explored, epsilon)
        if explored:
            self.tally.uniform("explored action", self.columns["action"][i], range(self.settings.n_actions))

    def _geometry(self, i: int) -> rules.Geometry:
        c = self.columns
        robot, human = (c["robot_row"][i], c["robot_col"][i]), (c["human_row"][i], c["human_col"][i])
        return rules.geometry_in(
            self.grid, robot, c["robot_heading"][i], human, c["human_heading"][i], self.settings.distances
        )

    def _human_step(self, i: int) -> None:
        c = self.columns
        assert self.human is not None
        geo = self._geometry(i - 1)
        gesture = rules.gesture_of(c["action"][i])
        before = rules.engagement_of(c["interaction_level"][i - 1])
        after = rules.engagement_of(c["interaction_level"][i])
        action, heading = c["human_action"][i], c["human_heading"][i]
        self._engagement(before, after, geo, gesture)
        if after == Engagement.NONE:
            self._idle(before, action, c["human_heading"][i - 1], heading)
        elif rules.is_move(action):
            self._speed("following", action)

    def _engagement(self, before: int, after: int, geo: rules.Geometry, gesture: int) -> None:
        human, tally = self.human, self.tally
        assert human is not None
        names = [engagement.name.lower() for engagement in Engagement]
        outcomes = rules.engagement_outcomes(before, geo, gesture, human)
        facing = ", faced" if gesture == Action.HELLO and geo.human_faces else ""
        situation = f"engagement {names[before]}, {Action(gesture).name.lower()}{facing}"
        tally.choice(situation, names[after], {names[e]: p for e, p in outcomes.items()})

        hello = rules.hello_success(geo, human) if gesture == Action.HELLO else 0.0
        tries = gesture == Action.HELLO and hello > 0
        if before == Engagement.NONE:
            if tries and not geo.human_faces:
                tally.add("p_H: fails hello", after == Engagement.NONE, human.p_H)
        elif geo.appropriate:
            if tries and before == Engagement.GREETED:
                # A lost human that is greeted again cannot be told from one that was not lost.
                both = human.p_A * (1 - hello)
                tally.add("p_A and p_H: lost, hello fails", after == Engagement.NONE, both)
            elif tries:
                tally.add("p_A: loses attention", after != before, human.p_A)
                if after != before and not geo.human_faces:
                    tally.add("p_H: fails hello, just lost", after == Engagement.NONE, human.p_H)
            else:
                tally.add("p_A: loses attention", after == Engagement.NONE, human.p_A)
                if gesture == Action.COME and before == Engagement.GREETED and after != Engagement.NONE:
                    tally.add("p_P: needs pointing", after == Engagement.CALLED, human.p_P)

    def _idle(self, before: int, action: int, heading_before: int, heading: int) -> None:
        """Random movement and eye movement of a human that is not engaged."""
        human, tally = self.human, self.tally
        assert human is not None
        moved = rules.is_move(action)
        lost = ", just lost" if before != Engagement.NONE else ""
        tally.add(f"p_M: moves at random{lost}", moved, human.p_M)
        base = heading_before
        if moved:
            base = rules.move_parts(action)[1]
            tally.uniform("random move: direction", base, range(8))
            tally.uniform("random move: turn", (base - heading_before) % 8, range(8))
            self._speed("random", action)
        turned = heading != base
        tally.add(f"p_O: looks elsewhere{lost}", turned, human.p_O * 7 / 8)
        tally.add(f"p_O: looks elsewhere, {'moved' if moved else 'standing'}", turned, human.p_O * 7 / 8)
        if turned:
            tally.uniform("random gaze: turn", (heading - base) % 8, range(1, 8))
            others = [direction for direction in range(8) if direction != base]
            tally.uniform("random gaze: heading", heading, others)

    def _speed(self, name: str, action: int) -> None:
        assert self.human is not None
        speed, direction = rules.move_parts(action)
        p_S = {s: p for s, p in enumerate(self.human.p_S, start=1) if p > 0}
        self.tally.choice(f"p_S: speed of a {name} move", speed, p_S)
        kind = "diagonal" if direction % 2 else "straight"
        self.tally.choice(f"p_S: speed of a {name} {kind} move", speed, p_S)

    def _teleport(self, i: int) -> None:
        c = self.columns
        if (
            c["action"][i] == Action.GO_TO_HUMAN_VISION
            and rules.engagement_of(c["interaction_level"][i - 1]) == Engagement.NONE
        ):
            heading = c["robot_heading"][i]
            self.tally.uniform("teleport: heading", heading, range(8))
            turn = (heading - c["human_heading"][i - 1]) % 8
            self.tally.uniform("teleport: heading - the human's", turn, range(8))

    def _direction_change(self, i: int) -> None:
        c, p = self.columns, self.settings.direction_change * 7 / 8
        before, after = c["desired_direction"][i - 1], c["desired_direction"][i]
        self.tally.add("desired direction changes", after != before, p)
        if c["reward"][i]:
            self.tally.add("desired direction changes after a reward", after != before, p)
        if c["step"][i] == self.settings.steps_in_trial:
            self.tally.add("desired direction changes in a last step", after != before, p)
        if after != before:
            self.tally.uniform("desired direction: change", (after - before) % 8, range(1, 8))
            others = [direction for direction in range(8) if direction != before]
            self.tally.uniform("desired direction: new", after, others)

    # ----------------------------------------------------------------------------------------- a visit

    def _visit_step(self, i: int) -> None:
        c = self.columns
        goal = c["goal_room"][i - 1]
        human = (c["human_row"][i], c["human_col"][i])
        if rules.visit_reward(self.grid, goal, human):
            self.tally.uniform("new goal room", c["goal_room"][i], sorted(self.place.goals - {goal}))
        self._direction_draw(i, c["desired_direction"][i - 1])
        if c["action"][i] == Action.GO_TO_HUMAN_VISION and self.settings.greedy_moves is not None:
            geo = self._geometry(i - 1)
            state = rules.go_to_human_state(geo.angle, c["human_heading"][i - 1], geo.distance)
            moves = sorted(self.settings.moves_at(state))
            self._rank("go_to_human: rank of the move drawn", c["executed_action"][i], moves)

    def _direction_draw(self, i: int, current: int | None) -> None:
        """Navigation draws among its best directions where the current one is not among them."""
        c = self.columns
        if self.settings.best_directions is None:
            return
        cell = self.grid.cell_number((c["human_row"][i], c["human_col"][i]))
        best = self.settings.directions_at(c["goal_room"][i], cell)
        if current not in best:
            self.tally.uniform("best direction", c["desired_direction"][i], sorted(best))
            self._rank("best direction: rank", c["desired_direction"][i], sorted(best))

    def _rank(self, name: str, got: int, choices: list[int]) -> None:
        if got in choices:
            self.tally.uniform(name, choices.index(got), range(len(choices)))
