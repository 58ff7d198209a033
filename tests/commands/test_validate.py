"""`validate --show`, and `--dry-run` of `run`, `train`, `eval`: what would be, and nothing is written."""

import json
import os
import shutil
from functools import partial

import pytest
from typer.testing import CliRunner

from tests.program import TINY, hashes, visitlab
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.agents.rmax import RMaxParameters
from visitlab_cli.cli import app
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.loading import load
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.estimate import LOG_BYTES, estimate
from visitlab_cli.storage import file_system
from visitlab_cli.world.tasks import TASKS

ONE_CELL = "experiments={navigation: {task: navigation, agents: [mf], steps: 1200}}"


def test_show_prints_a_config_that_is_the_same(tmp_path):
    done = visitlab("validate", TINY, "seeds=3", "agents.mf.alpha=0.25", "--show")
    assert done.returncode == 0
    resolved = tmp_path / "resolved.yaml"
    resolved.write_text(done.stdout)
    assert load(resolved) == load(TINY, ["seeds=3", "agents.mf.alpha=0.25"])
    assert "gamma: 0.9" in done.stdout  # a default
    told = json.loads(visitlab("validate", TINY, "--show", "--json").stdout)
    assert told["config"]["humans"]["fast_pointing"]["p_A"] == 0.05  # by `like`


def test_every_error_is_told_with_its_place(tmp_path):
    text = TINY.read_text().replace("p_A: 0.05", "p_a: 0.05").replace("seeds: 1", "seeds: 0")
    (tmp_path / "bad.yaml").write_text(text)
    done = visitlab("validate", "bad.yaml", "--show", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr.splitlines() == [
        "bad.yaml:4:8: seeds: must be at least 1 (got 0)",
        "bad.yaml:7:63: humans.fast.p_a: unknown; did you mean p_A?",
    ]


def test_errors_as_json(tmp_path):
    (tmp_path / "bad.yaml").write_text(TINY.read_text().replace("p_A: 0.05", "p_a: 0.05"))
    done = visitlab("validate", "bad.yaml", "seed=x", "--json", cwd=tmp_path)
    assert done.returncode == 3
    assert json.loads(done.stdout) == {
        "valid": False,
        "errors": [
            {
                "file": "bad.yaml",
                "line": 7,
                "column": 63,
                "path": "humans.fast.p_a",
                "message": "unknown; did you mean p_A?",
            },
            {
                "file": "override 'seed=x'",
                "line": None,
                "column": None,
                "path": "seed",
                "message": "must be a whole number (got 'x')",
            },
        ],
    }
    assert len(done.stderr.splitlines()) == 2


def test_a_dry_run_tells_what_there_is_to_do_and_writes_nothing(tmp_path):
    done = visitlab("run", TINY, "--dry-run", "--workers", 2, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (done.stderr, list(tmp_path.iterdir())) == ("", [])
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["module", "or", "visit", "cells", "steps", "time", "on", "one", "core", "disk"]
    assert lines[-2].startswith("17 cells to do; 18,000 steps, ")
    assert lines[-1] == f"about 1 s on 2 workers; the run is runs/tiny-{config_hash(load(TINY))}"


def test_a_dry_run_counts_what_is_done(tiny_run, tmp_path):
    run = tmp_path / tiny_run.name
    shutil.copytree(tiny_run, run)
    shutil.rmtree(run / "visit" / "slow")
    before = hashes(run)
    told = json.loads(visitlab("run", TINY, "--out", tmp_path, "--dry-run", "--json").stdout)
    assert (told["done"], told["cells"], told["steps"], list(told["groups"])) == (16, 1, 400, ["visit/slow"])
    trainings = json.loads(visitlab("train", TINY, "--out", tmp_path, "--dry-run", "--json").stdout)
    assert (trainings["done"], trainings["cells"]) == (14, 0)
    visits = json.loads(visitlab("eval", run, "--trials", 7, "--human", "slow", "--dry-run", "--json").stdout)
    assert [group["steps"] for group in visits["groups"].values()] == [700, 700]
    assert hashes(run) == before


@pytest.mark.parametrize("command", [("run",), ("train", "--json"), ("submit", "--shell")])
def test_a_plan_for_where_nothing_can_be_written_warns_of_it(tmp_path, command):
    (tmp_path / "file").touch()
    command, *options = command
    done = visitlab(command, TINY, *options, "--dry-run", "--out", tmp_path / "file")
    assert (done.returncode, done.stderr.count("\n")) == (0, 1)
    assert f"can't be written: {tmp_path / 'file'} is a file, not a folder; without --dry-run" in done.stderr
    assert done.stdout


def test_a_plan_of_a_run_that_can_only_be_read_warns_where_something_is_to_do(tiny_run, monkeypatch):
    monkeypatch.setattr(file_system.os, "access", lambda _, mode: not mode & os.W_OK)
    plan_of = partial(CliRunner().invoke, app, catch_exceptions=False)
    some = plan_of(["eval", str(tiny_run), "--trials", "7", "--human", "slow", "--dry-run"])
    assert (some.exit_code, some.stderr.count("\n")) == (0, 1)
    assert some.stderr.startswith(f"{tiny_run}: can't be written: ")
    assert some.stderr.endswith("copy the run to a folder that can be\n")
    assert plan_of(["eval", str(tiny_run), "--dry-run"]).stderr == ""


def size_of(cell, *, log):
    return sum(file.stat().st_size for file in cell.iterdir() if log or file.name != "steps.mcap")


def test_the_estimate_of_disk_is_about_what_each_cell_takes(tiny_run):
    for cell in plan(load(TINY)):
        taken = size_of(tiny_run / cell.path, log=True)
        assert 0.5 < estimate([cell], 1).bytes / taken < 2, cell.path
    for cell in plan(load(TINY, ["record.steps=none"])):
        taken = size_of(tiny_run / cell.path, log=False)
        assert 1 / 3 < estimate([cell], 1).bytes / taken < 3, cell.path


def test_the_estimate_of_disk_has_the_trials_that_are_recorded():
    (every,) = plan(load(TINY, [ONE_CELL]))
    some = {n: plan(load(TINY, [ONE_CELL, f"record.steps={{one_trial_in: {n}}}"])) for n in (1, 7, 1_000)}
    none = estimate(plan(load(TINY, [ONE_CELL, "record.steps=none"])), 1).bytes
    logs = {n: estimate(cells, 1).bytes - none for n, cells in some.items()}
    assert estimate([every], 1).bytes - none == logs[1]
    a_trial = every.settings.trial_steps * TASKS["navigation"].costs.log_bytes_a_step
    trials = every.trials
    assert logs[1] == round(LOG_BYTES + trials * a_trial)
    assert logs[7] == round(LOG_BYTES + -(-trials // 7) * a_trial)
    assert logs[1_000] == round(LOG_BYTES + a_trial)


def test_the_estimate_of_time_has_what_each_cell_costs_however_short_it_is():
    for workers in (1, 2):
        many = plan(load(TINY, [ONE_CELL.replace("1200", "20"), "seeds=300"]))
        assert estimate(many, workers).seconds >= 300 * TASKS["navigation"].costs.seconds / workers
    (one,) = plan(load(TINY, [ONE_CELL]))
    assert estimate([one], 9).seconds > TASKS["navigation"].costs.seconds


def test_more_workers_gain_until_the_longest_chain_is_left():
    cells = plan(load("quickstart"))
    seconds = [estimate(cells, workers).seconds for workers in (1, 2, 3, 99)]
    assert seconds[0] > seconds[1] >= seconds[2] == seconds[3] > 0
    told = [(500_000, RMaxParameters, "navigation"), (100_000, ModelBasedParameters, "visit")]
    chain = [n * kind.microseconds_a_step[task] / 1e6 + TASKS[task].costs.seconds for n, kind, task in told]
    assert seconds[3] == pytest.approx(sum(chain))


def test_every_agent_that_can_play_a_task_has_its_cost():
    from visitlab_cli.agents import registry

    members = registry.AnyAgent.__origin__.__args__  # of the union
    for parameters in members:
        assert parameters.microseconds_a_step.keys() == set(parameters.tasks)
