"""The package's own logs, replayed step by step by the oracle."""

import numpy as np
import pytest

from tests.oracle.checker import best_directions_of, check_frequencies, check_log, greedy_moves_of
from tests.oracle.grid import Grid
from tests.world.package_log import EPSILON, HUMAN, module_tables, package_log

STEPS = 30_000


def settings_of(task):
    settings = {"epsilon": EPSILON}
    if task in ("social", "visit"):
        settings["human"] = HUMAN
    if task == "visit":
        navigation, go_to_human = module_tables()
        settings["best_directions"] = best_directions_of(navigation, Grid())
        settings["greedy_moves"] = greedy_moves_of(go_to_human)
    return settings


VARIANTS = [
    ("navigation", {}),
    ("go_to_human", {}),
    ("go_to_human", {"success": "seen"}),
    ("go_to_human", {"distances": (2, 3, 5, 8)}),
    ("social", {}),
    ("social", {"arena": 30, "direction_change": 0.5}),
    ("social", {"distances": (2, 3, 5, 8)}),
    ("visit", {}),
    ("visit", {"goal_rooms": (0, 3, 4, 8), "social_reward": "none"}),
]


@pytest.mark.parametrize(("task", "options"), VARIANTS)
def test_every_logged_step_obeys_the_rules(task, options):
    log = package_log(task, STEPS, **options)
    settings = settings_of(task) | options
    assert check_log(log, task, **settings) == []
    frequencies = check_frequencies(log, task, **settings)
    assert frequencies
    assert [each for each in frequencies if not abs(each.z) < 4.5] == []


def test_the_logs_hold_every_engagement_and_gesture():
    log = package_log("visit", 2 * STEPS)
    assert set(np.unique(log["interaction_level"])) == set(range(8))
    assert set(np.unique(log["action"])) == set(range(31))
    assert log["reward"].sum() > 100
    assert log["social_reward"].sum() > 300


def test_no_step_of_a_visit_moves_the_robot_more_than_three_cells():
    log = package_log("visit", STEPS)
    within = log["step"][1:] > 0
    for axis in ("robot_row", "robot_col"):
        jump = np.abs(np.diff(log[axis].astype(int)))[within]
        assert jump.max() == 3
