"""`validate --show`, and `--dry-run` of `run`, `train`, `eval`: what would be, and nothing is written."""

import json
import shutil

from tests.program import TINY, hashes, visitlab
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.loading import load
from visitlab_cli.execution.cells import plan
from visitlab_cli.execution.estimate import LOG_BYTES_A_STEP, estimate


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


def test_the_estimate_of_disk_is_about_what_a_run_takes(tiny_run):
    (run_of_steps,) = [load(TINY, ["experiments={navigation: {task: navigation, agents: [mf], steps: 1200}}"])]
    cells = plan(run_of_steps)
    log = (tiny_run / "navigation" / "mf" / "seed-0000" / "steps.mcap").stat().st_size
    of_steps = 1200 * LOG_BYTES_A_STEP["navigation"]
    assert 0.5 < log / of_steps < 2
    assert of_steps < estimate(cells, 1).bytes
    unrecorded = plan(run_of_steps.model_copy(update={"record": load(TINY, ["record.steps=none"]).record}))
    assert round(estimate(cells, 1).bytes - estimate(unrecorded, 1).bytes) == round(of_steps)


def test_more_workers_gain_until_the_longest_chain_is_left():
    cells = plan(load("quickstart"))
    seconds = [estimate(cells, workers).seconds for workers in (1, 2, 3, 99)]
    assert seconds[0] > seconds[1] >= seconds[2] == seconds[3] > 0
    assert seconds[3] == 500_000 * ModelBasedParameters.microseconds_a_step["social"] / 1e6 + 100_000 * 22e-6


def test_every_agent_that_can_play_a_task_has_its_cost():
    from visitlab_cli.agents import registry

    members = registry.AnyAgent.__origin__.__args__  # of the union
    for parameters in members:
        assert parameters.microseconds_a_step.keys() == set(parameters.tasks)
