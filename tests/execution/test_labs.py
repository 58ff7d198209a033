"""Trainings and visits in labs with walls and doors: the same bytes however they are run, and all that reads them."""

import json

import numpy as np
import pytest

from tests.oracle.checker import Lab, best_directions_of, check_frequencies, check_log, greedy_moves_of
from tests.oracle.lab import NO_DOORS
from tests.program import hashes, only_cells, the_run, visitlab
from visitlab_cli.log.reader import read_steps
from visitlab_cli.scene.trial import lab_of_log, load_trial
from visitlab_cli.storage.arrays import read_model
from visitlab_cli.world.enums import InteractionLevel
from visitlab_cli.world.lab import sees

CONFIG = """
name: labs
seed: 11
humans:
  fast: {p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.05}
labs:
  small: {map: map.txt, corridor: Z}
  shut: {like: small, closed: [AZ]}
agents:
  rmax: {kind: rmax}
  script: {kind: scripted}
experiments:
  navigation:
    task: navigation
    agents: [rmax]
    lab: small
    phases: [{steps: 1000}, {trials: 20, lab: shut}, {trials: 20, doors: {BC: 0.5}}]
  go_to_human: {task: go_to_human, agents: [rmax], lab: small, steps: 600}
  social: {task: social, agents: [script], humans: [fast], steps: 20}
  visit:
    task: visit
    lab: small
    modules: {navigation: navigation/rmax, go_to_human: go_to_human/rmax, social: social/script}
    phases: [{trials: 4, human: fast}, {trials: 4, human: fast, lab: shut}, {trials: 8, human: fast, doors: {BC: 0.5}}]
    trial_steps: 40
"""
MAP = """
AAAAA#BBBB
AAAAA#BBBB
AAAAAZBBbB
AAaaZZCCcC
ZZzzZzcCCC
ZZZZZzcCCC
"""


FAST = {"p_S": (0, 0.5, 0.5), "p_H": 0.05, "p_M": 0.05, "p_O": 0.15, "p_A": 0.05, "p_P": 0}
PATHS = ("navigation/rmax", "go_to_human/rmax", "visit/phases")


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    folder = tmp_path_factory.mktemp("labs")
    (folder / "map.txt").write_text(MAP)
    (folder / "labs.yaml").write_text(CONFIG)
    return folder / "labs.yaml"


@pytest.fixture(scope="module")
def run(config):
    done = visitlab("run", config, "seeds=2", "--workers", 2, "--out", config.parent / "runs")
    assert done.returncode == 0, done.stderr
    return the_run(config.parent / "runs")


def log_of(run):
    return run / "visit" / "phases" / "seed-0000" / "steps.mcap"


def test_one_worker_uncompiled_and_what_is_added_later(run, config, tmp_path):
    for seeds, env in ((1, {"NUMBA_DISABLE_JIT": "1"}), (2, {})):
        done = visitlab("run", config, f"seeds={seeds}", "--workers", 1, "--out", tmp_path, env=env)
        assert done.returncode == 0, done.stderr
    assert only_cells(hashes(the_run(tmp_path))) == only_cells(hashes(run))


def test_the_map_is_kept_with_the_run(run, config):
    assert "AAAAA#BBBB\n" in (run / "config.yaml").read_text().replace("      ", "")
    assert lab_of_log(log_of(run), 0).rooms.tolist()[0] == [0] * 5 + [-1] + [1] * 4


def test_who_is_behind_a_wall_is_not_seen_and_seems_far_and_no_step_goes_through_one(run):
    steps = read_steps(log_of(run))
    hidden = 0
    for phase in range(3):
        lab, rows = lab_of_log(log_of(run), phase), np.flatnonzero(steps["phase"] == phase)
        for row in rows.tolist():
            robot, human = ([int(steps[f"{who}_{axis}"][row]) for axis in ("row", "col")] for who in ("robot", "human"))
            assert lab.rooms[tuple(robot)] >= 0
            if not sees(lab, *robot, *human, int(steps["open_doors"][row])):
                hidden += 1
                assert steps["distance"][row] == 4
                level = steps["interaction_level"][row]
                assert level == InteractionLevel.NOT_SEEN or level >= InteractionLevel.GREETED
    assert hidden > 50


def test_doors_change_between_trials_only_and_goals_are_where_all_can_get(run):
    steps = read_steps(log_of(run))
    begins = steps["step"] == 0
    assert (np.diff(steps["open_doors"].astype(int))[~begins[1:]] == 0).all()
    assert len(set(steps["open_doors"][steps["phase"] == 2].tolist())) > 1
    assert set(steps["open_doors"][steps["phase"] < 2].tolist()) == {-1}
    assert set(steps["goal_room"].tolist()) <= {0, 1, 3}, "never the corridor"
    for phase, unreachable in ((1, 0), (2, 1)):
        assert unreachable not in steps["goal_room"][steps["phase"] == phase]


def test_the_logs_obey_the_rules_of_their_labs_and_doors(run):
    logs = {path: read_steps(run / path / "seed-0000/steps.mcap") for path in PATHS}
    small, shut = Lab(MAP, "Z"), Lab(MAP, "Z", closed=["AZ"])
    labs = small, shut, Lab(MAP, "Z", toggling={"BC": 0.5})
    tables = [read_model(run / path / "seed-0000/model.npz")["q"] for path in PATHS[:2]]
    modules = {
        "best_directions": best_directions_of(tables[0], small.grid(NO_DOORS)),
        "greedy_moves": greedy_moves_of(tables[1]),
    }
    visited = {"phases": list(zip((4, 4, 8), [FAST] * 3, labs, strict=True)), "trial_steps": 40} | modules
    settings = [{"phases": list(zip((50, 20, 20), [None] * 3, labs, strict=True))}, {"lab": small}, visited]
    for log, task, said in zip(logs.values(), ("navigation", "go_to_human", "visit"), settings, strict=True):
        assert check_log(log, task, **said) == []
        assert [each for each in check_frequencies(log, task, **said) if not abs(each.z) < 4.5] == []
    for said, trials, human in ((settings[0], 20, None), (visited, 4, FAST)):
        said["phases"][1] = (trials, human, small)
    told = [
        check_log(logs[path], task, **said)
        for path, task, said in ((PATHS[0], "navigation", settings[0]), (PATHS[2], "visit", visited))
    ]
    assert any(told), "the door that is shut is seen"


def test_a_trial_shows_the_walls_of_its_phase(run):
    shut = [load_trial(log_of(run), number) for number in (0, 5)]
    assert shut[0].lab is not shut[1].lab
    assert (shut[0].lab.reach != shut[1].lab.reach).any()
    told = json.loads(visitlab("steps", run, "--experiment", "visit", "--trial", 5, "--json").stdout)
    assert any("is blocked" in step["caption"] for step in told["steps"])


@pytest.mark.parametrize(
    "words",
    [
        ["report", "RUN"],
        ["figures", "RUN", "--only", "phases", "--only", "doors"],
        ["runs", "show", "RUN"],
        ["metrics", "RUN"],
        ["runs", "verify", "RUN"],
        ["replay", "RUN", "--experiment", "visit", "--trial", "9", "--strip", "OUT/strip.svg"],
        ["replay", "RUN", "--experiment", "visit", "--trial", "9", "--save", "OUT/trial.rrd"],
        ["export", "RUN", "--experiment", "visit", "--trial", "9", "--foxglove", "--output", "OUT/trial.mcap"],
        ["export", "RUN", "--experiment", "visit", "--trial", "9", "--ros2bag", "--output", "OUT/bag"],
    ],
    ids=" ".join,
)
def test_whoever_reads_runs_reads_one_with_walls(run, tmp_path, words):
    done = visitlab(*(word.replace("OUT", str(tmp_path)).replace("RUN", str(run)) for word in words))
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
