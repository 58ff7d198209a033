"""Phases: one agent lives through all of them, and only what a phase says changes."""

import json
from pathlib import Path

import numpy as np
import pytest

import visitlab_cli
from tests.oracle.checker import best_directions_of, check_log, greedy_moves_of
from tests.oracle.grid import Grid
from tests.program import hashes, only_cells, the_run, visitlab
from visitlab_cli.config.loading import load_text
from visitlab_cli.errors import NotFoundError
from visitlab_cli.execution.build import build
from visitlab_cli.execution.cell_runner import saved_model, simulate
from visitlab_cli.log.reader import iter_steps, read_metadata, read_steps, read_trial
from visitlab_cli.log.schema import schema_bytes
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.evaluation import Evaluation
from visitlab_cli.plan.saved import trials_of, unsound
from visitlab_cli.plan.selection import Selection
from visitlab_cli.random_numbers import random_state
from visitlab_cli.replay.choice import Log, Logs, choose_trial
from visitlab_cli.storage.arrays import read_model, read_trials
from visitlab_cli.world.tasks import columns_of

HUMANS = {
    "fast": {"p_S": [0, 0.5, 0.5], "p_H": 0.05, "p_M": 0.05, "p_O": 0.15, "p_A": 0.05, "p_P": 0},
    "still": {"p_S": [1, 0, 0], "p_H": 0, "p_M": 0, "p_O": 0, "p_A": 0, "p_P": 0},
}
CONFIG = f"""
name: phases
seed: 5
humans: {HUMANS}
agents:
  mf: {{kind: q_learning}}
  mb: {{kind: model_based, plan_every: 200}}
  rmax: {{kind: rmax, plan_every: 200}}
  watcher: {{kind: observer, watches: mb, learner: mf, until: 600, acts_as: mf}}
  script: {{kind: scripted}}
  mirror: {{kind: model_based, plan_every: 200, symmetric: true, unvisited: zero}}
experiments:
  navigation: {{task: navigation, agents: [rmax], NAVIGATION}}
  go_to_human: {{task: go_to_human, agents: [mb], steps: 1200}}
  social: {{task: social, agents: [mb, watcher, mirror], SOCIAL}}
  on: {{task: social, agents: [mb], humans: [still], steps: 400, start_from: STARTmb/WHO}}
  script: {{task: social, agents: [script], humans: [fast], steps: 20}}
  visit:
    task: visit
    modules: {{navigation: navigation/rmax, go_to_human: go_to_human/mb, social: SOCIALMODULE}}
    trial_steps: 30
    VISIT
"""
PHASED = {
    "NAVIGATION": "phases: [{steps: 800}, {trials: 20, plan_every: 50}]",
    "SOCIALMODULE": "script/script",
    "SOCIAL": "phases: [{steps: 800, human: fast}, {trials: 20, human: still, plan_every: 10}]",
    "START": "social/",
    "WHO": "phases",
    "VISIT": "phases: [{trials: 20, human: fast}, {trials: 15, human: still}, {trials: 20, human: fast}]",
}
TRIALS = {"visit/phases": [20, 15, 20], "social/mb/phases": [40, 20], "navigation/rmax": [40, 20]}


def filled(**words):
    text = CONFIG
    for word, value in {**PHASED, **words}.items():
        text = text.replace(word, value)
    return text


def cells_of(**words):
    return {cell.group: cell for cell in plan(load_text(filled(**words), "phases.yaml"))}


def played(cell):
    """All that a cell's simulation gives, with a stream that does not depend on its path."""
    simulation, random = build(cell, {}), random_state(3, "the same")
    rows = []
    names = [column.name for column in columns_of(cell.task)]

    def record(columns, count):
        rows.append({name: getattr(columns, name)[:count].copy() for name in names})

    rewards, _ = simulate(simulation, random, record, lambda steps: None)
    steps = {name: np.concatenate([block[name] for block in rows]) for name in names}
    return {"rewards": rewards, **steps, **saved_model(simulation, random)}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("phases")
    (folder / "phases.yaml").write_text(filled())
    done = visitlab("run", folder / "phases.yaml", "--out", folder / "runs", "--workers", 1)
    assert done.returncode == 0, done.stderr
    return the_run(folder / "runs")


@pytest.mark.parametrize("agent", ["mb", "watcher", "mirror"])
@pytest.mark.parametrize(
    "phases",
    [
        "phases: [{trials: 7, human: fast}, {steps: 1060, human: fast}]",
        "phases: [{trials: 30, human: fast}, {trials: 30, human: fast, plan_every: 200}]",
    ],
)
def test_phases_that_change_nothing_are_one_training(agent, phases):
    whole = played(cells_of(SOCIAL="humans: [fast], steps: 1200", WHO="fast")[f"social/{agent}/fast"])
    parts = played(cells_of(SOCIAL=phases)[f"social/{agent}/phases"])
    assert whole["rewards"].shape == (60,)
    for name, values in whole.items():
        np.testing.assert_array_equal(parts[name], values, err_msg=name)


@pytest.mark.parametrize(
    ("word", "group", "phases", "same", "other"),
    [
        ("SOCIAL", "social/mb/phases", "{trials: 40, human: fast}, {trials: 20, human: WHOM}", "fast", "still"),
        ("NAVIGATION", "navigation/rmax", "{trials: 40}, {trials: 20, plan_every: WHOM}", "200", "7"),
    ],
)
def test_what_a_phase_changes_begins_with_its_first_trial(word, group, phases, same, other):
    one, two = (
        played(cells_of(**{word: f"phases: [{phases}]".replace("WHOM", each)})[group]) for each in (same, other)
    )
    until = int(np.flatnonzero(one["trial"] == 40)[0])
    names = [column.name for column in columns_of(group.split("/")[0])]
    for name in names:
        np.testing.assert_array_equal(one[name][:until], two[name][:until])
    assert any((one[name][until:] != two[name][until:]).any() for name in names)
    np.testing.assert_array_equal(one["trial"], two["trial"])


def test_the_table_of_trials_and_the_log_say_which_phase(run):
    for group, trials in TRIALS.items():
        folder = run / group / "seed-0000"
        expected = np.repeat(np.arange(len(trials)), trials)
        table = read_trials(folder / "trials.parquet")
        np.testing.assert_array_equal(table["phase"], expected)
        np.testing.assert_array_equal(table["trial"], np.arange(len(expected)))
        steps = read_steps(folder / "steps.mcap")
        np.testing.assert_array_equal(steps["phase"], expected[steps["trial"]])
        np.testing.assert_array_equal(
            np.concatenate([block["phase"] for block in iter_steps(folder / "steps.mcap")]), steps["phase"]
        )
        assert set(read_trial(folder / "steps.mcap", trials[0])["phase"]) == {1}


def test_nothing_says_a_phase_where_there_are_none(run):
    folder = run / "go_to_human/mb/seed-0000"
    assert "phase" not in read_steps(folder / "steps.mcap")
    assert "phase" not in read_trials(folder / "trials.parquet")
    assert schema_bytes() in (folder / "steps.mcap").read_bytes()  # as it always was
    assert b"phase" not in schema_bytes()


def test_the_log_obeys_the_rules_of_each_phases_human_and_of_no_other(run):
    steps = read_steps(run / "visit/phases/seed-0000/steps.mcap")
    tables = [read_model(run / path / "seed-0000/model.npz")["q"] for path in ("navigation/rmax", "go_to_human/mb")]
    rules = {
        "trial_steps": 30,
        "best_directions": best_directions_of(tables[0], Grid(24, 24)),
        "greedy_moves": greedy_moves_of(tables[1]),
    }
    order = [("fast", 20), ("still", 15), ("fast", 20)]
    right = [(trials, HUMANS[name]) for name, trials in order]
    assert check_log(steps, "visit", phases=right, **rules) == []
    swapped = [(trials, HUMANS["fast" if name == "still" else "still"]) for name, trials in order]
    wrong = {steps["phase"][each.row] for each in check_log(steps, "visit", phases=swapped, **rules)}
    assert {0, 2} <= wrong  # where it is told that nobody moves about who does
    shifted = [(21, HUMANS["fast"]), (14, HUMANS["still"]), (20, HUMANS["fast"])]
    assert {each.column for each in check_log(steps, "visit", phases=shifted, **rules)} == {"phase"}


def test_the_goal_carries_over_and_the_steps_go_on(run):
    steps = read_steps(run / "visit/phases/seed-0000/steps.mcap")
    begins = np.flatnonzero((steps["step"] == 0) & (steps["trial"] > 0))
    assert (steps["goal_room"][begins] == steps["goal_room"][begins - 1]).all()
    assert read_model(run / "social/mb/phases/seed-0000/model.npz")["visits"].sum() == 1200


def test_a_training_goes_on_from_one_with_phases():
    cells = cells_of()
    assert cells["on/mb/still"].modules == {"social": "social/mb/phases/seed-0000"}
    assert cells["on/mb/still"].humans == ("still",)
    assert cells["social/mb/phases"].humans == ("fast", "still")
    social = cells_of(SOCIALMODULE="social/mb")
    assert social["visit/phases"].settings.modules.social == "social/mb/phases"


def test_the_same_bytes_with_two_workers_and_without_compiling(run, tmp_path):
    for name, options in (("two", {}), ("uncompiled", {"env": {"NUMBA_DISABLE_JIT": "1"}})):
        (tmp_path / "phases.yaml").write_text(filled())
        out = tmp_path / name
        done = visitlab("run", tmp_path / "phases.yaml", "--out", out, "--workers", 2, **options)
        assert done.returncode == 0, done.stderr
        assert hashes(the_run(out)) == hashes(run)


def test_more_seeds_later_and_a_damaged_table(run, tmp_path):
    (tmp_path / "phases.yaml").write_text(filled())
    out = tmp_path / "runs"
    for more in ([], ["seeds=2"]):
        assert visitlab("run", tmp_path / "phases.yaml", *more, "--out", out).returncode == 0
    later = only_cells(hashes(the_run(out)))
    assert {path: digest for path, digest in later.items() if "seed-0000" in path} == only_cells(hashes(run))
    cell = cells_of()["visit/phases"]
    other = cells_of(VISIT="phases: [{trials: 21, human: fast}, {trials: 34, human: still}]")["visit/phases"]
    assert unsound(run, cell) is None
    assert unsound(run, other) == ("trials.parquet", "no table of trials: its phases are not those of its config")
    assert list(trials_of(run, other)["phase"][:21]) == [0] * 20 + [1]  # as it was played


@pytest.mark.parametrize("command", ["steps", "replay"])
def test_a_number_is_counted_within_its_phase_and_not_beyond(run, command):
    save = ["--save", run.parent / "trial.rrd"] if command == "replay" else []
    done = visitlab(command, run, "--phase", "1", "--trial", "14", "--json", *save)
    assert (done.returncode, json.loads(done.stdout)["trial"]) == (0, 34), done.stderr
    done = visitlab(command, run, "--phase", "1", "--trial", "15", *save)
    assert (done.returncode, done.stdout) == (5, "")
    assert done.stderr.endswith("/steps.mcap: --trial 15: phase 1 has trials 0 to 14\n")


def test_who_is_met_in_turn_is_chosen_by_phases():
    cells = plan(load_text(filled(), "phases.yaml"))
    for selection in (Selection("visit", "still"), Selection("visit", "fast"), Selection("social", "fast")):
        with pytest.raises(NotFoundError, match="is met in phases there: use --human phases, or --phase N"):
            selection.of(Path("run"), cells)
    assert {cell.experiment for cell in Selection(human="still").of(Path("run"), cells)} == {"on"}  # met alone
    with pytest.raises(NotFoundError, match="no human stil; did you mean still?"):
        Selection("visit", "stil").of(Path("run"), cells)


def test_metrics_of_a_human_are_of_the_phases_with_it_too(run):
    told = [
        json.loads(visitlab("metrics", run, "--json", *more).stdout)["metrics"] for more in ((), ("--human", "still"))
    ]
    assert told[1] == [row for row in told[0] if row["human"] == "still"]
    assert {(row["experiment"], row.get("phase")) for row in told[1]} == {("social", 1), ("on", None), ("visit", 1)}
    phased = json.loads(visitlab("metrics", run, "--json", "--human", "phases", "-e", "visit").stdout)["metrics"]
    assert {row["human"] for row in phased} == {"fast", "still"}
    pytest.importorskip("pandas")
    frame = visitlab_cli.load(run).metrics(human="still")
    assert list(frame["mean"]) == [row["mean"] for row in told[1]]
    with pytest.raises(NotFoundError, match="no visit with stil, and metrics are of these"):
        visitlab_cli.load(run).metrics(human="stil")
    done = visitlab("metrics", run, "--human", "stil")
    assert (done.returncode, done.stderr.endswith("no human stil; did you mean still?\n")) == (5, True)


def test_an_evaluation_with_a_human_of_its_own_has_no_phases():
    config = load_text(filled(), "phases.yaml")
    (cell,) = plan(config, Evaluation(humans=("still",)))
    assert (cell.human, cell.settings.phases, cell.trials, cell.humans) == ("still", (), 55, ("still",))
    (frozen,) = plan(config, Evaluation(frozen=True))
    assert (frozen.human, len(frozen.settings.phases)) == ("phases", 3)


def test_thinned_logs_keep_their_phases(tmp_path):
    (tmp_path / "thin.yaml").write_text(filled() + "record: {steps: {one_trial_in: 7}}\n")
    done = visitlab("run", tmp_path / "thin.yaml", "--out", tmp_path / "runs")
    assert done.returncode == 0, done.stderr
    file = the_run(tmp_path / "runs") / "visit/phases/seed-0000/steps.mcap"
    steps = read_steps(file)
    assert read_metadata(file)["one_trial_in"] == "7"
    np.testing.assert_array_equal(steps["phase"], np.repeat([0, 1, 2], [20, 15, 20])[steps["trial"]])
    logs = Logs((Log(file, str(file)),))
    assert [choose_trial(logs, "1", 1).trial, choose_trial(logs, "14", 1).trial] == [21, 34]  # from its first, 20
    with pytest.raises(NotFoundError, match="phase 1 has trials 0 to 14"):
        choose_trial(logs, "15", 1)


@pytest.mark.parametrize(
    "command",
    [
        pytest.param(["report"], marks=pytest.mark.slow),
        ["figures"],
        ["compare", "--by", "agent"],
        ["compare", "--by", "phase"],
        ["metrics"],
        ["runs", "show", "--metrics"],
        ["steps", "--phase", "1"],
        ["runs", "verify"],
    ],
    ids=" ".join,
)
def test_whoever_reads_a_run_reads_one_in_which_humans_are_met_in_turn(run, command):
    done = visitlab(*command, run)
    assert done.returncode == 0, done.stderr
    assert "not visitlab's" not in done.stdout
