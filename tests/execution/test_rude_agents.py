"""What others' code does to the process that it is in ends no program, moves no file and is no result."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from tests.program import the_run, visitlab
from visitlab_cli.execution.executor import DIED

FILE = Path(__file__).with_name("rude_agent.py")
CONFIG = """name: rude
agents:
  ends: {kind: rude, does: DOES}
  wanders: {kind: rude, does: wander}
  ours: {kind: q_learning}
experiments:
  navigation: {task: navigation, agents: [ends, wanders, ours], steps: 100}
"""


@pytest.mark.parametrize(("does", "workers"), [("leave", 1), ("crash", 2)])
def test_who_ends_its_process_or_goes_elsewhere_fails_alone_and_stays_in_the_run(tmp_path, does, workers):
    (tmp_path / "config.yaml").write_text(CONFIG.replace("DOES", does))
    done = visitlab(
        "run", "config.yaml", "--plugin", FILE, "--out", "runs", "--workers", workers, "--quiet", "--json", cwd=tmp_path
    )
    assert done.returncode == 4, done.stderr
    assert "results" in json.loads(done.stdout)
    run = the_run(tmp_path / "runs")
    found = {cell.parts[-3] for cell in run.glob("navigation/*/*/cell.json")}
    assert found == {"wanders", "ours"}
    told = done.stderr.splitlines()
    (failed,) = [line for line in told if ": failed: " in line]
    assert failed.startswith(f"navigation/ends/seed-0000: failed: {DIED} (")
    assert {"imported", does, "wander", "past Python"} <= set(told)


def test_what_it_prints_is_no_answer_of_plugin_check(tmp_path):
    done = visitlab("plugin", "check", "rude", "does=wander", "--plugin", FILE, "--json", cwd=tmp_path)
    assert done.returncode == 4  # it learns nothing
    assert [answer["passed"] for answer in json.loads(done.stdout)["answers"]].count(False) == 1
    assert "wander" in done.stderr.splitlines()


ONE_AFTER_THE_OTHER = """
import os, visitlab_cli
agents, played = {"mine": {"kind": "rude", "does": "wander"}}, {"task": "navigation", "agents": ["mine"], "steps": 100}
for name in ("first", "second"):
    os.environ["VISITLAB_PLUGINS"] = os.path.abspath(f"{name}/rude_agent.py")
    config = {"name": name, "agents": agents, "experiments": {"navigation": played}}
    assert len(visitlab_cli.run(config, "runs").cells) == 1
"""


def test_a_worker_knows_the_plug_ins_of_its_run_not_those_of_the_first(tmp_path):
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        (tmp_path / name / FILE.name).write_text(f"{FILE.read_text()}# {name}\n")
    done = subprocess.run(
        [sys.executable, "-c", ONE_AFTER_THE_OTHER], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
