"""The checks on logs that are right, on logs with one wrong value, and on logs of wrong rules."""

import random
from typing import Any

import numpy as np
import pytest

from visitlab_cli.world.enums import Engagement

from . import rules
from .checker import check_frequencies, check_log
from .playing import Game, play
from .settings import COLUMNS, Settings
from .tally import z_score

HUMAN = {"p_S": (0.2, 0.3, 0.5), "p_H": 0.3, "p_M": 0.2, "p_O": 0.15, "p_A": 0.1, "p_P": 0.4}
LIMIT = 4.5


def modules() -> dict[str, Any]:
    """Some navigation and go_to_human, neither of them sensible."""
    source = np.random.default_rng(5)
    directions = source.random((9, 576, 8)) < 0.4
    moves = source.random((320, 25)) < 0.2
    directions[..., 3] = moves[..., 24] = True
    return {"best_directions": directions, "greedy_moves": moves}


SETTINGS: dict[str, dict[str, Any]] = {
    "navigation": {},
    "go_to_human": {},
    "social": {"human": HUMAN},
    "visit": {"human": HUMAN, "goal_rooms": (0, 1, 2, 3, 4, 5, 6, 7), **modules()},
}
TRIALS = {"navigation": 400, "go_to_human": 400, "social": 600, "visit": 150}


@pytest.fixture(scope="module")
def logs() -> dict[str, dict[str, np.ndarray]]:
    return {task: play(task, TRIALS[task], seed=1, **settings) for task, settings in SETTINGS.items()}


def worst(log: dict[str, np.ndarray], task: str, **settings: Any) -> float:
    return max(abs(frequency.z) for frequency in check_frequencies(log, task, **settings))


# ------------------------------------------------------------------------------------------ right logs


@pytest.mark.parametrize("task", SETTINGS)
def test_a_right_log_passes(logs, task):
    assert check_log(logs[task], task, **SETTINGS[task]) == []
    assert worst(logs[task], task, epsilon=0.5, **SETTINGS[task]) < LIMIT


@pytest.mark.parametrize(
    ("task", "settings"),
    [
        ("navigation", {"walls": [((5, c), (6, c)) for c in range(20)], "trial_steps": 7}),
        ("go_to_human", {"success": "seen", "distances": (0, 2, 3, 6)}),
        ("social", {"human": HUMAN, "arena": 30, "direction_change": 0.0}),
        ("social", {"human": HUMAN | {"p_A": 0, "p_S": (0, 0, 1)}, "distances": (0, 2, 3, 6)}),
        ("visit", {"human": HUMAN, "social_reward": "none", "goal_rooms": [2, 5], "trial_steps": 30}),
    ],
)
def test_options_are_part_of_the_rules(task, settings):
    log = play(task, 150, seed=2, **settings)
    assert check_log(log, task, **settings) == []
    assert worst(log, task, **settings) < LIMIT


def test_recorded_trials_one_in_three(logs):
    log = logs["visit"]
    kept = log["trial"] % 3 == 0
    some = {name: values[kept] for name, values in log.items()}
    assert check_log(some, "visit", trial_stride=3, **SETTINGS["visit"]) == []
    assert check_log(some, "visit", **SETTINGS["visit"])


def test_modules_may_be_given_as_functions(logs):
    arrays = modules()
    functions = {
        "best_directions": lambda goal, cell: set(np.flatnonzero(arrays["best_directions"][goal, cell])),
        "greedy_moves": lambda state: set(np.flatnonzero(arrays["greedy_moves"][state])),
    }
    assert check_log(logs["visit"], "visit", **(SETTINGS["visit"] | functions)) == []


# ------------------------------------------------------------------------------------- one wrong value


@pytest.mark.parametrize(
    ("task", "column"),
    [(task, column) for task, columns in COLUMNS.items() for column in columns if column != "explored"],
)
def test_a_wrong_value_is_seen_where_it_stands(logs, task, column):
    """At most of 40 rows: another action may by chance have led to the same."""
    log = logs[task]
    seen = 0
    rows = np.random.default_rng(3).choice(np.arange(1, 240), size=40, replace=False).tolist()
    for row in rows:
        part = {name: values[: row + 30].copy() for name, values in log.items()}
        value = part[column][row]
        part[column][row] = 1 - value if "reward" in column else value + 1
        found = check_log(part, task, partial_last_trial=True, **SETTINGS[task])
        assert all(row <= violation.row <= row + 1 for violation in found)
        seen += bool(found)
    # An idle human may look anywhere; its heading shows in no other column unless the level changes.
    assert seen >= (20 if column == "human_heading" else 30), seen


def test_exploring_is_checked_where_it_is_known(logs):
    assert check_log(logs["navigation"], "navigation", epsilon=0)
    assert worst(logs["navigation"], "navigation", epsilon=0.45) > LIMIT


def test_missing_and_strange_columns_and_values_are_told(logs):
    log = dict(logs["navigation"])
    del log["goal_room"]
    log["human_row"] = log["robot_row"]
    assert {violation.column for violation in check_log(log, "navigation")} == {"goal_room", "human_row"}
    log = {name: values.copy() for name, values in logs["social"].items()}
    log["reward"][5] = np.nan
    log["robot_row"][9] = 120
    found = check_log(log, "social", **SETTINGS["social"])
    assert {(violation.row, violation.column) for violation in found} == {(5, "reward"), (9, "robot_row")}


def test_a_log_that_ends_within_a_trial_is_told_unless_it_may(logs):
    log = {name: values[:-3] for name, values in logs["social"].items()}
    assert [violation.column for violation in check_log(log, "social", **SETTINGS["social"])] == ["step"]
    assert check_log(log, "social", partial_last_trial=True, **SETTINGS["social"]) == []


# ---------------------------------------------------------------------------------- other probabilities


@pytest.mark.slow
@pytest.mark.parametrize(
    "other",
    [
        {"p_S": (0.3, 0.3, 0.4)},
        {"p_H": 0.7},
        {"p_M": 0.26},
        {"p_O": 0.2},
        {"p_A": 0.2},
        {"p_P": 0.6},
    ],
    ids=lambda other: next(iter(other)),
)
def test_another_human_is_told_by_its_frequencies(other):
    human = HUMAN | other
    log = play("social", 800, seed=4, human=human)
    assert check_log(log, "social", human=HUMAN) == []
    assert worst(log, "social", human=human) < LIMIT
    names = [f.name for f in check_frequencies(log, "social", human=HUMAN) if abs(f.z) > LIMIT]
    assert any(next(iter(other)) in name for name in names)


@pytest.mark.slow
def test_other_redrawing_is_told_by_its_frequencies(logs):
    assert worst(logs["social"], "social", human=HUMAN, direction_change=0.15) > LIMIT
    log = play("visit", 300, seed=4, human=HUMAN, goal_rooms=range(8))
    assert worst(log, "visit", human=HUMAN) > LIMIT


# -------------------------------------------------------------------------------------------- wrong rules


def _clear_caches() -> None:
    for value in vars(rules).values():
        if hasattr(value, "cache_clear"):
            value.cache_clear()


def _gaze_redrawn_to_another(engagement, angle, heading, human):
    if engagement != Engagement.NONE:
        return {(angle + 4) % 8: 1.0}
    return {d: 1 - human.p_O if d == heading else human.p_O / 7 for d in range(8)}


def _gaze_stays_when_moving(engagement, angle, heading, human):
    return {heading: 1.0} if engagement == Engagement.NONE else {(angle + 4) % 8: 1.0}


WRONG = {
    "the human follows during gestures": ("GESTURES", (26, 28), "social"),
    "distance 4 is appropriate": ("APPROPRIATE", (1, 2, 3, 4), "social"),
    "distance 3 is not": ("APPROPRIATE", (1, 2), "go_to_human"),
    "teleport at speed 1": ("TELEPORT_SPEED", 1, "social"),
    "a tie goes up": ("angle_of", lambda b: (b + 50) // 100 % 8, "social"),
    "the angle is rounded down": ("angle_of", lambda b: b // 100, "social"),
    "the bearing is mirrored": (
        "bearing",
        lambda robot, human, right=rules.bearing: right(human, robot),
        "go_to_human",
    ),
    "facing takes the rounded bearing": (
        "within",
        lambda heading, b, k, right=rules.within: right(heading, rules.angle_of(b) * 100, k),
        "go_to_human",
    ),
    "bounds are excluded": (
        "within",
        lambda heading, b, k, right=rules.within: (
            right(heading, b, k) and (heading * 100 - b) % 800 not in (100 * k, 800 - 100 * k)
        ),
        "social",
    ),
    "hello needs no robot that faces the human": (
        "hello_success",
        lambda geo, human: float(geo.appropriate and geo.seen),
        "social",
    ),
    "hello may fail when faced": (
        "hello_success",
        lambda geo, human: 1 - human.p_H if geo.appropriate and geo.seen and geo.robot_faces else 0.0,
        "social",
    ),
    "the new gaze is another one": ("gaze_outcomes", _gaze_redrawn_to_another, "social"),
    "no random gaze": ("gaze_outcomes", _gaze_stays_when_moving, "visit"),
    "gestures earn": ("social_reward", lambda e, action, desired: int(e == Engagement.FOLLOWING), "social"),
    "random movement earns": (
        "social_reward",
        lambda e, action, desired: int(rules.is_move(action) and action % 8 == desired),
        "social",
    ),
    "only full speed earns": (
        "social_reward",
        lambda e, action, desired: int(e == Engagement.FOLLOWING and action == 16 + desired),
        "visit",
    ),
    "success only where both face": (
        "go_to_human_reward",
        lambda geo, success: int(geo.appropriate and geo.human_faces and geo.robot_faces),
        "go_to_human",
    ),
    "state numbers in another order": (
        "social_state",
        lambda level, distance, desired, angle: level + 8 * (distance + 5 * (angle + 8 * desired)),
        "visit",
    ),
    "levels 2 and 3 swapped": (
        "interaction_level",
        lambda geo, e=0, right=rules.interaction_level: {2: 3, 3: 2}.get(right(geo, e), right(geo, e)),
        "go_to_human",
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WRONG)
def test_a_log_of_wrong_rules_is_refused(name, monkeypatch):
    attribute, wrong, task = WRONG[name]
    with monkeypatch.context() as patched:
        _clear_caches()
        patched.setattr(rules, attribute, wrong)
        log = play(task, TRIALS[task], seed=6, **SETTINGS[task])
    _clear_caches()
    assert check_log(log, task, **SETTINGS[task]) or worst(log, task, **SETTINGS[task]) > LIMIT


class PerceivesTheRobotAfterItActed(Game):
    def perceived(self, before):
        return super().perceived(self.row)


class IsPaidByTheNewDirection(Game):
    def desired_direction(self, before):
        self.new_direction = before["desired_direction"]
        if self.random.random() < 0.2:
            self.new_direction = self.random.randrange(8)
        return self.new_direction

    def redrawn_direction(self, before):
        return self.new_direction


class DrawsAnotherDirection(Game):
    def redrawn_direction(self, before):
        return (before["desired_direction"] + self.random.randrange(1, 8)) % 8


class ForgetsTheGoal(Game):
    def start(self, trial):
        self.row = {}
        super().start(trial)


class MovesFourCells(Game):
    def step(self):
        super().step()
        self.row["robot_col"] = (self.row["robot_col"] + 4) % 24


@pytest.mark.slow
@pytest.mark.parametrize(
    ("game", "task"),
    [
        (PerceivesTheRobotAfterItActed, "social"),
        (PerceivesTheRobotAfterItActed, "visit"),
        (IsPaidByTheNewDirection, "social"),
        (DrawsAnotherDirection, "social"),
        (ForgetsTheGoal, "visit"),
        (MovesFourCells, "visit"),
    ],
)
def test_a_log_of_another_game_is_refused(game, task):
    log = game(Settings(task=task, **SETTINGS[task]), random.Random(7)).play(TRIALS[task])
    assert check_log(log, task, **SETTINGS[task]) or worst(log, task, **SETTINGS[task]) > LIMIT


# ---------------------------------------------------------------------------------------------- z-scores


def test_z_scores():
    assert z_score(600, 500.0, 250.0, 1000) == pytest.approx(6.313, abs=0.01)  # exact tail of the binomial
    assert z_score(5600, 5000.0, 2500.0, 10000) == 12.0
    assert 0 <= z_score(1, 0.05, 0.0499, 100) < 2  # once in 20 is no wonder
    assert z_score(0, 3.0, 2.9, 100) == pytest.approx(-1.67, abs=0.02)  # 0.97 ** 100 = 0.0476
    assert z_score(3, 0.0, 0.0, 100) == np.inf


# -------------------------------------------------------------------------------------------- phases


def test_each_phase_is_judged_by_its_own_human():
    still = {"p_S": (1, 0, 0), "p_H": 0.0, "p_M": 0.0, "p_O": 0.0, "p_A": 0.0, "p_P": 0.0}
    phases = [(40, HUMAN), (40, still)]
    log = play("social", 80, seed=4, phases=phases)
    assert check_log(log, "social", phases=phases) == []
    assert worst(log, "social", phases=phases) < LIMIT
    swapped = check_log(log, "social", phases=[(40, still), (40, HUMAN)])
    assert {log["phase"][each.row] for each in swapped} == {0}
    late = log | {"phase": np.where(log["trial"] == 40, 0, log["phase"])}
    assert {(each.row, each.column) for each in check_log(late, "social", phases=phases)} == {
        (row, "phase") for row in np.flatnonzero(log["trial"] == 40)
    }
    assert [each.column for each in check_log(log, "social", human=HUMAN)] == ["phase"]
