"""The metrics of interactions, against a plain reading of the same logs, and where the answer is known."""

import itertools
import json
import math
from pathlib import Path

import numpy as np
import pytest

import visitlab_cli
from tests.program import visitlab
from visitlab_cli.config.loading import load_text
from visitlab_cli.log.reader import read_steps
from visitlab_cli.plan.cells import plan
from visitlab_cli.results import metrics
from visitlab_cli.results.metrics import METRICS, WHOLE, Part, measured, metrics_of
from visitlab_cli.results.ways import distances_to
from visitlab_cli.storage.run_folder import read_config
from visitlab_cli.world.enums import DISTANCE_NAMES
from visitlab_cli.world.lab import make_lab, paper_lab

CELLS = ["social/mb/fast/seed-0000", "social/script/fast/seed-0000", "visit/fast/seed-0000", "visit/slow/seed-0000"]


def trials_in(steps):
    begins = [*np.flatnonzero(steps["step"] == 0), len(steps["step"])]
    for first, last in itertools.pairwise(begins):
        yield [{name: values[row].item() for name, values in steps.items()} for row in range(first, last)]


def faces(row, col, heading, to_row, to_col):
    """Within 45 degrees, to the hundredth of a direction in which the task counts."""
    bearing = round(100 * (math.atan2(row - to_row, to_col - col) / (math.pi / 4) % 8)) % 800
    turn = (100 * heading - bearing) % 800
    return min(turn, 800 - turn) <= 100


def plainly(steps):
    """The same metrics, a step after another."""
    trials = list(trials_in(steps))
    rows = [row for trial in trials for row in trial[1:]]
    found = {
        "robot_gaze": [
            faces(r["robot_row"], r["robot_col"], r["robot_heading"], r["human_row"], r["human_col"]) for r in rows
        ],
        "human_gaze": [
            # seen from the human: opposite to the robot's bearing, whose rounding the task shares
            (lambda turn: min(turn, 800 - turn) <= 100)(
                (
                    100 * r["human_heading"]
                    - round(
                        100
                        * (
                            math.atan2(r["robot_row"] - r["human_row"], r["human_col"] - r["robot_col"])
                            / (math.pi / 4)
                            % 8
                        )
                    )
                    - 400
                )
                % 800
            )
            for r in rows
        ],
        "following": [r["interaction_level"] == 7 for r in rows],
    }
    for number, name in enumerate(DISTANCE_NAMES):
        found[name.replace(" ", "_")] = [r["distance"] == number for r in rows]
    conditions = {"seen": lambda r: r["interaction_level"] >= 1, "greeted": lambda r: r["interaction_level"] >= 5}
    conditions["following"] = lambda r: r["interaction_level"] == 7
    if "goal_room" in steps:
        conditions["goal"] = lambda r: r["step"] > 0 and r["reward"] > 0
    for name, is_so in conditions.items():
        firsts = [next((r["step"] for r in trial if is_so(r)), None) for trial in trials]
        found[f"trials_{name}"] = [first is not None for first in firsts]
        found[f"steps_until_{name}"] = [first for first in firsts if first is not None]
    losses, backs = 0, []
    for trial in trials:
        for before, now in itertools.pairwise(trial):
            if before["interaction_level"] >= 5 > now["interaction_level"]:
                losses += 1
                back = next((r["step"] for r in trial[now["step"] :] if r["interaction_level"] >= 5), None)
                backs.append(None if back is None else back - now["step"])
    found["attention_lost"] = [100 * losses / len(rows)]
    found["attention_back"] = [back is not None for back in backs]
    found["steps_until_back"] = [back for back in backs if back is not None]
    return {name: float(np.mean(values)) for name, values in found.items() if values}


@pytest.mark.parametrize("path", CELLS)
def test_each_number_is_what_a_plain_reading_of_the_log_says(tiny_run, path):
    (cell,) = [cell for cell in plan(read_config(tiny_run)) if cell.path == path]
    found = {name: value for name, value in metrics_of(tiny_run, cell)[WHOLE].items() if not math.isnan(value)}
    efficiency = found.pop("path_efficiency", 1.0)
    assert found == pytest.approx(plainly(read_steps(tiny_run / path / "steps.mcap")))
    assert 0 < efficiency <= 1


def columns(**values):
    rows = len(values["step"])
    zero = np.zeros(rows, np.uint32)
    names = ["trial", "reward", "robot_row", "robot_col", "robot_heading", "human_row", "human_col", "human_heading"]
    base = dict.fromkeys([*names, "interaction_level", "distance", "goal_room"], zero)
    return base | {name: np.array(each, np.uint32) for name, each in values.items()}


def test_the_way_to_a_goal_is_judged_from_where_it_was_set():
    rooms = np.zeros((1, 7), int)
    rooms[0, 5:] = 1
    lab = make_lab(1, 7, rooms=rooms)
    steps = columns(
        step=[0, 1, 2, 3, 4, 5, 6, 0, 1],
        human_col=[3, 2, 3, 5, 4, 5, 6, 0, 5],  # 4 cells instead of 2; then room 0, which is a move away: 1 cell
        goal_room=[1, 1, 1, 0, 1, 1, 1, 1, 1],
        reward=[0, 0, 0, 1, 1, 0, 0, 0, 1],
    )
    assert measured(steps, lab)["path_efficiency"] == pytest.approx(np.mean([2 / 4, 1 / 1, 1.0]))
    stood = columns(step=[0, 1], human_col=[5, 5], goal_room=[1, 0], reward=[0, 1])
    assert math.isnan(measured(stood, lab)["path_efficiency"])


RING = """
name: ring
humans: {one: {p_S: [1, 0, 0]}}
agents: {mf: {kind: q_learning}, script: {kind: scripted}}
labs:
  ring: {map: "AabB\\nA##B\\naccb\\n"}
  shut: {like: ring, closed: [AB]}
experiments:
  navigation: {task: navigation, agents: [mf], lab: ring, steps: 100}
  go_to_human: {task: go_to_human, agents: [mf], steps: 100}
  social: {task: social, agents: [script], humans: [one], steps: 20}
  visit:
    task: visit
    lab: ring
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mf, social: social/script}
    phases: [{trials: 1, human: one}, {trials: 1, human: one, lab: shut}, {trials: 2, human: one, doors: {AB: 0.5}}]
    trial_steps: 5
"""


def test_the_way_to_a_goal_is_the_shortest_in_the_lab_of_its_phase_and_while_the_doors_of_its_trial_are_open(
    tmp_path, monkeypatch
):
    """From A's corner to B it is two moves by their door, and five by C's: each time the human takes those."""
    (cell,) = [cell for cell in plan(load_text(RING, "ring.yaml")) if cell.task == "visit"]
    way = {
        "step": range(6),
        "human_row": [0, 1, 2, 2, 2, 2],
        "human_col": [0, 0, 0, 1, 2, 3],
        "reward": [0, 0, 0, 0, 0, 1],
    }
    steps = columns(**{name: 4 * list(values) for name, values in way.items()})
    for name, values in {"trial": range(4), "phase": [0, 1, 2, 2], "open_doors": [-1, -1, 1, 0]}.items():
        steps[name] = np.repeat(np.array(values), 6)
    steps["goal_room"] = np.array(4 * [1, 1, 1, 1, 1, 2])
    (tmp_path / cell.path).mkdir(parents=True)
    (tmp_path / cell.path / "steps.mcap").touch()
    monkeypatch.setattr(metrics, "read_steps", lambda file, names: {name: steps[name] for name in names})
    found = metrics_of(tmp_path, cell, first=2)
    assert list(found) == [Part(phase, "first 2") for phase in range(3)]
    expected = [2 / 5, 1.0, (2 / 5 + 1) / 2]
    assert [each["path_efficiency"] for each in found.values()] == pytest.approx(expected)


def test_attention_that_is_lost_at_the_end_of_a_trial_does_not_come_back_in_the_next():
    steps = columns(step=[0, 1, 2, 0, 1, 2, 3, 4], interaction_level=[0, 5, 1, 0, 7, 3, 2, 6])
    found = measured(steps, paper_lab())
    assert found["attention_lost"] == pytest.approx(100 * 2 / 6)
    assert (found["attention_back"], found["steps_until_back"]) == (0.5, 2.0)
    assert (found["trials_following"], found["steps_until_following"], found["steps_until_seen"]) == (0.5, 1.0, 1.0)


def test_ways_go_around_walls_and_end_where_there_is_none():
    rooms = np.array([[0, 0, 0], [0, 0, 1]])
    wall = [((1, 1), (1, 2))]
    assert distances_to(make_lab(2, 3, wall, rooms=rooms), 1).tolist() == [
        [3, 2, 1],
        [3, 3, 0],
    ]  # no diagonal past a wall
    closed = [*wall, ((0, 2), (1, 2))]
    assert distances_to(make_lab(2, 3, closed, rooms=rooms), 1).tolist() == [[-1, -1, -1], [-1, -1, 0]]


def test_the_command_the_door_and_the_page_name_every_metric(tiny_run):
    pytest.importorskip("pandas")
    done = visitlab("metrics", tiny_run, "-e", "visit", "--json")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)["metrics"]
    frame = visitlab_cli.load(tiny_run).metrics(experiment="visit")
    assert list(frame["metric"]) == [row["metric"] for row in told]
    assert list(frame["mean"]) == [row["mean"] for row in told]
    shown = json.loads(visitlab("runs", "show", tiny_run, "--metrics", "--json").stdout)
    assert [row for row in shown["metrics"] if row["experiment"] == "visit"] == told
    assert {row["experiment"] for row in shown["metrics"]} == {"social", "visit", "visit_scripted"}
    assert "metrics" not in json.loads(visitlab("runs", "show", tiny_run, "--json").stdout)
    table = visitlab("runs", "show", tiny_run, "--metrics").stdout
    assert visitlab("metrics", tiny_run).stdout in table
    done = visitlab("metrics", tiny_run, "-e", "visit")
    assert [line.split()[3] for line in done.stdout.splitlines()[1:]] == [row["metric"] for row in told]
    page = (Path(visitlab_cli.__file__).parents[1] / "docs" / "metrics.md").read_text()
    assert [name for name in METRICS if f"`{name}`" not in page] == []


@pytest.mark.parametrize(
    ("more", "line"), [(["-e", "navigation"], "has no training of the social module and no visit, and metrics are")]
)
def test_what_has_no_metrics_is_one_line(tiny_run, more, line):
    done = visitlab("metrics", tiny_run, *more)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (5, "", 1)
    assert line in done.stderr
