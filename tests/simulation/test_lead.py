"""Leading: the plan against value iteration written a second way, and what a visit that leads by it does."""

import os
import subprocess
import sys

import numpy as np
import pytest

from tests.simulation.small_lab import HUMAN, model_of, played, two_rooms, visit_in
from visitlab_cli.simulation.controller import prepare
from visitlab_cli.simulation.lead import sweep_lead
from visitlab_cli.simulation.vehicle import plan_directions
from visitlab_cli.world.lab import make_lab, move, sees

GAMMA, SHARE = 0.9, 0.6
LEAD = "route", "mask", "plan", "lead"
TOLD = (0.2, 0.3, 0.5), 0.1


def planned(lab, **options):
    visit = visit_in(lab, *LEAD, **options)
    prepare(visit.controller, visit.direction_values)
    return visit


def whole_values(lab, speeds, loss):
    """W over (goal, human's cell, robot's cell), by the rules of the lab itself and whole arrays, until it settles."""
    cells = [(row, col) for row in range(lab.rows) for col in range(lab.cols)]
    number = {cell: index for index, cell in enumerate(cells)}
    after = np.array([[number[move(lab, *cell, a % 8, a // 8 + 1, -1)] for a in range(24)] for cell in cells])
    after = np.column_stack([after, np.arange(len(cells))])
    rows, cols = np.array(cells).T
    north, east = rows[:, None] - rows, cols[:, None] - cols  # of the human's cell from the robot's, [human, robot]
    apart = np.maximum(abs(north), abs(east))
    near = (apart >= 2) & (apart <= 5) & np.array([[sees(lab, *cell, *other, -1) for other in cells] for cell in cells])
    bearing = np.round(np.arctan2(north, -east) / (np.pi / 4) % 8, 2)  # from human to robot: rows grow southwards
    towards = (np.rint((bearing + 4) % 8).astype(int) + 4) % 8
    room, values = lab.rooms.ravel(), np.zeros((lab.n_rooms, len(cells), len(cells)))
    for _ in range(220):
        lost = SHARE * values[values > 0].mean() if (values > 0).any() else 0.0
        best = np.full(values.shape, -np.inf)
        for action in range(25):
            worth = np.zeros(values.shape)
            robot = np.broadcast_to(after[:, action], near.shape)
            for slower, chance in enumerate(speeds):
                human = after[np.arange(len(cells))[:, None], 8 * slower + towards]
                for goal in range(lab.n_rooms):
                    hit = room[human] == goal
                    others = (values.sum(axis=0) - values[goal])[human, robot] / (lab.n_rooms - 1)
                    kept = np.where(hit, others, values[goal][human, robot])
                    follows = np.where(near[human, robot], (1 - loss) * kept + loss * lost, lost)
                    worth[goal] += chance * (hit + GAMMA * follows)
            best = np.maximum(best, worth)
        values = np.where(near, best, 0.0)
    return values


@pytest.mark.parametrize("walls", [True, False])
def test_the_plan_is_value_iteration_over_the_whole_state(walls):
    lab = two_rooms() if walls else make_lab(6, 6, rooms=np.tile(np.arange(6) // 3, (6, 1)))
    visit = planned(lab, told=TOLD)
    leading, known = visit.controller.leading, visit.controller.known
    for _ in range(220):
        sweep_lead(leading, known)
    expected, side = whole_values(lab, *TOLD), 2 * leading.reach + 1
    for human in range(36):
        for robot in range(36):
            offset = np.subtract(known.place[robot], known.place[human]) + leading.reach
            values = leading.values[human, offset[0] * side + offset[1]]
            np.testing.assert_allclose(values, expected[:, human, robot], atol=1e-9)


def test_the_vehicle_is_value_iteration_with_the_humans_speeds():
    lab = two_rooms()
    known, speeds = visit_in(lab, "plan").controller.known, np.array([0.5, 0.0, 0.5])
    values = np.zeros((2, 36, 8))
    plan_directions(known.after, lab.rooms.ravel(), speeds, values)
    best = values.max(axis=2)
    for direction in range(8):
        ahead = known.after[:, [direction, direction + 16]]
        for goal in range(2):
            worth = np.where(lab.rooms.ravel()[ahead] == goal, 1.0, GAMMA * best[goal][ahead]).mean(axis=1)
            np.testing.assert_allclose(values[goal, :, direction], worth, atol=1e-9)


@pytest.mark.slow
def test_the_robot_goes_where_the_plan_sends_it_and_does_not_explore():
    log = played(visit_in(two_rooms(), *LEAD), 40)
    leads = np.flatnonzero(log["plan_leads"])
    leads = leads[(leads + 1 < len(log["step"]))]
    leads = leads[log["step"][leads + 1] > 0]
    assert len(leads) > 200
    for axis in ("row", "col"):
        assert (log[f"robot_{axis}"][leads + 1] == log[f"wanted_robot_{axis}"][leads]).all()
    assert not log["explored"][leads + 1].any()
    assert (log["interaction_level"][leads] == 7).all()
    apart = [abs(log[f"robot_{axis}"].astype(int) - log[f"human_{axis}"])[leads] for axis in ("row", "col")]
    assert set(np.maximum(*apart).tolist()) <= {2, 3, 4, 5}


@pytest.mark.slow
def test_leading_reaches_more_goals_than_the_papers_modules():
    lab = two_rooms(8, 16)
    paper = played(visit_in(lab), 40)["reward"].sum()
    assert played(visit_in(lab, *LEAD), 40)["reward"].sum() > 2 * paper


def test_a_masked_robot_is_never_blocked():
    log = played(visit_in(two_rooms(), "mask"), 40)
    moves = np.flatnonzero((log["action"] < 24) & (log["step"] > 0))
    gone = [abs(np.diff(log[f"robot_{axis}"].astype(int)))[moves - 1] for axis in ("row", "col")]
    assert (np.maximum(*gone) == log["action"][moves] // 8 + 1).all()


def test_what_nobody_tried_is_a_stay():
    lab = two_rooms()
    model = model_of(lab)
    nothing = {name: array[:0] for name, array in model.items()} | {"successor_offsets": np.zeros(1801, np.int64)}
    known = visit_in(lab, *LEAD, model=nothing).controller.known
    assert (known.after == np.arange(36)[:, None]).all()
    assert (known.meant[:, :24] == 24).all()
    assert (known.meant[:, 24:] == np.arange(24, 30)).all()
    log = played(visit_in(lab, "plan", "lead", model=nothing), 2)
    assert log["plan_leads"].any()  # it knows no better than to stay
    assert (log["action"][1:][log["plan_leads"][:-1] & (log["step"][1:] > 0)] == 24).all()


def test_of_several_ends_the_one_seen_most_often_counts():
    lab = two_rooms()
    model = model_of(lab)
    first = {"successor_offsets": model["successor_offsets"] + 1, "successor_counts": model["successor_counts"]}
    first["successor_offsets"][0] = 0
    first["successor_states"] = np.concatenate([[7], model["successor_states"]])
    for count, end in ((1, 1), (2, 7)):  # as often: the first cell
        first["successor_counts"] = np.concatenate([[count], model["successor_counts"]])
        assert visit_in(lab, "plan", model=first).controller.known.after[0, 0] == end


def test_nothing_is_asked_of_the_human():
    lab = two_rooms()
    true, wrong = planned(lab), planned(lab, human=HUMAN | {"p_S": (1, 0, 0), "p_A": 1.0})
    assert (true.controller.leading.values == wrong.controller.leading.values).all()
    assert (true.direction_values == wrong.direction_values).all()


def test_a_plan_is_made_anew_after_ten_trials_where_an_estimate_has_changed():
    visit = planned(two_rooms())
    leading, estimates = visit.controller.leading, visit.controller.estimates
    first = leading.values.copy()
    estimates.loss[0] = 0.5
    for _ in range(9):
        prepare(visit.controller, visit.direction_values)
        assert (leading.values == first).all()
    prepare(visit.controller, visit.direction_values)
    second = leading.values.copy()
    assert (second != first).any()
    for _ in range(20):
        prepare(visit.controller, visit.direction_values)
    assert (leading.values == second).all()  # nothing has changed since
    assert leading.loss[0] == 0.5


@pytest.mark.slow
def test_uncompiled(tmp_path):
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    for name, setting in (("compiled", {}), ("plain", environment)):
        command = [sys.executable, "-m", "tests.simulation.small_lab", tmp_path / name]
        subprocess.run(command, env=os.environ | setting, check=True)
    with np.load(tmp_path / "compiled.npz") as compiled, np.load(tmp_path / "plain.npz") as plain:
        assert set(compiled) == set(plain)
        for name in compiled:
            if name == "values":  # compiled arithmetic may join a product and a sum
                np.testing.assert_allclose(compiled[name], plain[name], rtol=1e-12)
            else:
                assert (compiled[name] == plain[name]).all(), name
        assert compiled["plan_leads"].any()
