"""Play the tasks from the oracle's own distributions: logs on which the checks are themselves tested."""

import random
from typing import Any

import numpy as np

from visitlab_cli.world.enums import Action, Engagement

from . import rules
from .lab import NO_DOORS
from .settings import Settings


def play(task: str, trials: int, seed: int = 0, **settings: Any) -> dict[str, np.ndarray]:
    """The log of a robot that acts half at random and half sensibly; `explored` tells which."""
    return Game(Settings(task=task, **settings), random.Random(seed)).play(trials)


class Game:
    """A task in progress: the current row and those before it."""

    def __init__(self, settings: Settings, source: random.Random) -> None:
        self.settings, self.task, self.random = settings, settings.task, source
        self.place = settings.place()
        self.row: dict[str, Any] = {}
        self.rows: list[dict[str, Any]] = []
        self.engagement = int(Engagement.NONE)
        self.humans = settings.make_humans() if settings.has_reactions else []
        self.human: Any = None

    @property
    def grid(self) -> rules.Grid:
        return self.place.grid

    def play(self, trials: int) -> dict[str, np.ndarray]:
        for trial in range(trials):
            self.start(trial)
            for _ in range(self.settings.steps_in_trial):
                self.step()
        return {name: np.array([row[name] for row in self.rows]) for name in self.settings.columns}

    def start(self, trial: int) -> None:
        eighth, none = self.random.randrange, int(Action.NO_ACTION)
        last = self.row
        self.human = self.settings.human_in(self.humans, trial)
        self.row = {
            "trial": trial,
            "phase": self.settings.phase_of(trial),
            "step": 0,
            "action": none,
            "explored": False,
            "reward": 0.0,
        }
        self.engagement = int(Engagement.NONE)
        self.row["open_doors"] = self.toggled(trial, last)
        self.place = self.settings.place(trial, self.row["open_doors"])
        self.put("robot", self.random.choice(self.place.starts), eighth(8))
        self.put("human", self.random.choice(self.place.starts), eighth(8))
        self.row |= {"human_action": none, "executed_action": none, "social_reward": 0.0}
        if self.task == "navigation":
            self.row |= {"robot_heading": 0, "goal_room": self.random.choice(sorted(self.place.goals))}
        elif self.task == "social":
            self.row |= {"human_row": self.grid.height // 2, "human_col": self.grid.width // 2}
            self.row["desired_direction"] = eighth(8)
        elif self.task == "visit":
            kept = last.get("goal_room")
            self.row["goal_room"] = kept if kept in self.place.goals else self.random.choice(sorted(self.place.goals))
            self.refresh_direction(last.get("desired_direction"))
        self.finish()

    def toggled(self, trial: int, last: dict[str, Any]) -> int:
        """Which doors are open now: each toggles by chance, from how the trial or the lab before it had them."""
        lab, phase_of = self.settings.lab_in(trial), self.settings.phase_of
        if lab is None or not lab.toggled:
            return NO_DOORS
        same_phase = bool(last) and phase_of(last["trial"]) == phase_of(trial)
        now: int = last["open_doors"] if same_phase else lab.open_at_first
        for bit, door in enumerate(lab.toggled):
            now ^= (self.random.random() < lab.toggling[door]) << bit
        return now

    def step(self) -> None:
        before = self.row
        self.row = dict(before) | {"step": before["step"] + 1}
        explored = self.random.random() < 0.5
        n = self.settings.n_actions
        action = self.random.randrange(n) if explored else self.sensible_action()
        self.row |= {"action": action, "explored": explored, "executed_action": action}
        robot, heading, angle = self.cell("robot"), before["robot_heading"], before.get("angle", 0)
        if action == Action.GO_TO_HUMAN_VISION and self.task == "social":
            if self.engagement == Engagement.NONE:
                target = rules.teleport_target(self.grid, self.cell("human"), before["human_heading"])
                self.put("robot", target, self.random.randrange(8))
        else:
            if action == Action.GO_TO_HUMAN_VISION:
                state = rules.go_to_human_state(angle, before["human_heading"], before["distance"])
                self.row["executed_action"] = self.random.choice(sorted(self.settings.moves_at(state)))
            executed = self.row["executed_action"]
            self.put("robot", *rules.robot_after(self.grid, robot, heading, executed, angle))
        if self.settings.has_reactions:
            perceived = self.perceived(before)
            reaction = self.react(perceived, before["human_heading"], rules.gesture_of(action))
            self.engagement, self.row["human_action"] = reaction.engagement, reaction.action
            self.put("human", self.grid.after(self.cell("human"), reaction.action), reaction.heading)
        self.pay(before)
        self.finish()

    def perceived(self, before: dict[str, Any]) -> rules.Geometry:
        """What the human goes by: both as they were when the step began."""
        robot, human = (before["robot_row"], before["robot_col"]), (before["human_row"], before["human_col"])
        headings = before["robot_heading"], before["human_heading"]
        return rules.geometry_in(self.grid, robot, headings[0], human, headings[1], self.settings.distances)

    def react(self, perceived: rules.Geometry, heading: int, gesture: int) -> rules.Reaction:
        """Engagement, movement and gaze, one after the other."""
        engagements = rules.engagement_outcomes(self.engagement, perceived, gesture, self.human)
        engagement = self.draw(engagements)
        action = self.draw(rules.movement_outcomes(engagement, perceived.angle, gesture, self.human))
        heading = rules.heading_after(heading, action)
        heading = self.draw(rules.gaze_outcomes(engagement, perceived.angle, heading, self.human))
        return rules.Reaction(engagement, action, heading)

    def draw(self, distribution: dict[int, float]) -> int:
        return self.random.choices(list(distribution), list(distribution.values()))[0]

    def sensible_action(self) -> int:
        if not self.settings.has_reactions:
            return self.random.randrange(self.settings.n_actions)
        if self.engagement == Engagement.NONE:
            choices = [Action.GO_TO_HUMAN_VISION, Action.LOOK, Action.HELLO]
            return int(self.random.choice(choices if self.row["distance"] in (1, 2, 3) else choices[:1]))
        if self.engagement == Engagement.GREETED:
            return int(Action.COME)
        return int(self.random.choice([Action.POINT, Action.STAY, Action.LOOK, Action.HELLO, Action.COME]))

    def pay(self, before: dict[str, Any]) -> None:
        grid, row = self.grid, self.row
        if self.task == "navigation":
            row["reward"] = float(rules.navigation_reward(grid, row["goal_room"], self.cell("robot")))
        elif self.task == "go_to_human":
            row["reward"] = float(rules.go_to_human_reward(self.geometry(), self.settings.success))
        else:
            desired = self.desired_direction(before)
            social = float(rules.social_reward(self.engagement, row["human_action"], desired))
        if self.task == "social":
            row["reward"] = social
            if self.random.random() < self.settings.direction_change:
                row["desired_direction"] = self.redrawn_direction(before)
        elif self.task == "visit":
            row["social_reward"] = social if self.settings.social_reward == "social" else 0.0
            row["reward"] = float(rules.visit_reward(grid, before["goal_room"], self.cell("human")))
            if row["reward"]:
                row["goal_room"] = self.random.choice(sorted(self.place.goals - {before["goal_room"]}))
            self.refresh_direction(before["desired_direction"])

    def desired_direction(self, before: dict[str, Any]) -> int:
        """The one that the social reward is judged by."""
        return int(before["desired_direction"])

    def redrawn_direction(self, before: dict[str, Any]) -> int:
        return self.random.randrange(8)

    def refresh_direction(self, current: int | None) -> None:
        cell = self.grid.cell_number(self.cell("human"))
        best = self.settings.directions_at(self.row["goal_room"], cell)
        self.row["desired_direction"] = current if current in best else self.random.choice(sorted(best))

    def finish(self) -> None:
        """Geometry, level and state of the row, which is then part of the log."""
        row = self.row
        if self.task == "navigation":
            row["state"] = rules.navigation_state(self.grid, row["goal_room"], self.cell("robot"))
        else:
            geo = self.geometry()
            level = rules.interaction_level(geo, self.engagement)
            row |= {"distance": geo.distance, "angle": geo.angle, "interaction_level": int(level)}
            if self.task == "go_to_human":
                row["state"] = rules.go_to_human_state(geo.angle, row["human_heading"], geo.distance)
            else:
                row["state"] = rules.social_state(level, geo.distance, row["desired_direction"], geo.angle)
        self.rows.append(row)

    def put(self, who: str, cell: rules.Cell, heading: int) -> None:
        self.row |= {f"{who}_row": cell[0], f"{who}_col": cell[1], f"{who}_heading": heading}

    def cell(self, who: str) -> rules.Cell:
        return self.row[f"{who}_row"], self.row[f"{who}_col"]

    def geometry(self) -> rules.Geometry:
        row, distances = self.row, self.settings.distances
        return rules.geometry_in(
            self.grid, self.cell("robot"), row["robot_heading"], self.cell("human"), row["human_heading"], distances
        )
