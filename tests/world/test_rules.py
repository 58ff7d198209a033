"""The package's own logs, replayed step by step by the oracle."""

import numpy as np
import pytest

from tests.oracle.checker import Lab, best_directions_of, check_frequencies, check_log, greedy_moves_of
from tests.oracle.grid import Grid
from tests.oracle.lab import NO_DOORS
from tests.world.package_log import EPSILON, HUMAN, LABS, TRIAL_STEPS, module_tables, package_log, phases_log

STEPS = 30_000
LAB_STEPS = {"navigation": 8_000, "go_to_human": 8_000, "visit": 20_000}


def settings_of(task, *labs, steps=STEPS):
    """What the oracle must know of a log of `package_log`, or of `phases_log` with so many `steps` in each lab."""
    settings = {"epsilon": EPSILON}
    places = [Lab(**LABS[lab]) if lab else None for lab in labs] or [None]
    if task in ("social", "visit"):
        settings["human"] = HUMAN
    if places[0]:
        settings["lab"] = places[0]
    if len(labs) > 1:
        settings["phases"] = [(steps // TRIAL_STEPS[task], HUMAN, place) for place in places]
    if task == "visit":
        grid = places[0].grid(NO_DOORS) if places[0] else Grid()
        navigation, go_to_human = module_tables(grid.n_rooms * grid.n_cells)
        settings["best_directions"] = best_directions_of(navigation, grid)
        settings["greedy_moves"] = greedy_moves_of(go_to_human)
    return settings


def contradictions(log, task, **settings):
    """What the oracle has against a log: wrong values, or events that are too frequent or too rare."""
    found = check_log(log, task, **settings)
    return found or [each for each in check_frequencies(log, task, **settings) if not abs(each.z) < 4.5]


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
    assert contradictions(log, task, **settings) == []
    assert check_frequencies(log, task, **settings)


@pytest.mark.slow  # compiled; tests/world/test_mutations.py has shorter logs, uncompiled
@pytest.mark.parametrize("task", LAB_STEPS)
@pytest.mark.parametrize("lab", LABS)
def test_every_logged_step_in_a_lab_obeys_the_rules(task, lab):
    log = package_log(task, LAB_STEPS[task], lab=lab)
    assert contradictions(log, task, **settings_of(task, lab)) == []


@pytest.mark.slow
@pytest.mark.parametrize("task", LAB_STEPS)
def test_phases_with_labs_and_doors_of_their_own_obey_the_rules(task):
    steps, labs = 3_000, ["nine rooms", "toggling", "closed", "toggling"]
    log = phases_log(task, [(steps, lab) for lab in labs])
    assert contradictions(log, task, **settings_of(task, *labs, steps=steps)) == []
    assert set(np.unique(log["phase"][log["open_doors"] == -1])) == {0, 2}


@pytest.mark.slow
def test_the_logs_of_labs_hold_what_walls_do():
    log, lab = package_log("visit", LAB_STEPS["visit"], lab="toggling"), Lab(**LABS["toggling"])
    grids = {doors: lab.grid(doors) for doors in np.unique(log["open_doors"]).tolist()}
    assert len(grids) == 8, "one of the four doors never toggles"
    where = np.column_stack([log[name] for name in ("robot_row", "robot_col", "human_row", "human_col")]).tolist()
    doors = log["open_doors"].tolist()
    seen = np.array([grids[d].sees((a, b), (c, e)) for d, (a, b, c, e) in zip(doors, where, strict=True)])
    near = np.abs(np.array(where)[:, :2] - np.array(where)[:, 2:]).max(axis=1) <= 5
    assert (near & ~seen).sum() > 500
    engaged, lost = log["interaction_level"][:-1] > 4, log["interaction_level"][1:] < 5
    assert (engaged & lost & (near & ~seen)[:-1]).sum() >= 5
    assert log["reward"].sum() > 5


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
