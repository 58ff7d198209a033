"""A kind of agent that somebody adds to the program: everything that reads a config meets it."""

import json
import os
import shutil
import subprocess

import pytest

from tests.program import COMMAND, the_run
from visitlab_cli.sources import PACKAGE

KIND = '''"""A kind with a setting that Python has no name for, and no word of what it costs."""

from typing import Literal

from pydantic import Field

from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.agents.q_learning import QLearningParameters


class TracesParameters(AgentParameters):
    """Q-learning whose step is called lambda."""

    kind: Literal["traces"]
    lambda_: float = Field(default=0.5, ge=0, le=1, alias="lambda", description="its step")
    rooms: set[str] = Field(default=set(), description="what it has seen")

    def create(self, setting):
        return QLearningParameters(kind="q_learning", alpha=self.lambda_).create(setting)

    def restore(self, setting, saved):
        return QLearningParameters(kind="q_learning", alpha=self.lambda_).restore(setting, saved)

    def save(self, record):
        return {"q": record.q, "visits": record.visits}
'''
CONFIG = """name: added
agents:
  one: {kind: traces, rooms: [b, a, c, d, e]}
  two: {like: one, lambda: 0.25}
experiments:
  navigation: {task: navigation, agents: [one, two], steps: 200}
vary: {agents.two.lambda: [0.125, 1]}
"""


@pytest.fixture
def program(tmp_path):
    """Runs a clone to which the kind was added: the finished process."""
    package = tmp_path / "clone" / "visitlab_cli"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
    (package / "agents" / "traces.py").write_text(KIND)
    registry = package / "agents" / "registry.py"
    text = registry.read_text().replace("    | ScriptedParameters", "    | ScriptedParameters\n    | TracesParameters")
    line = "from visitlab_cli.agents.traces import TracesParameters\n"
    registry.write_text(text.replace("\nAnyAgent", f"{line}\nAnyAgent"))
    (tmp_path / "added.yaml").write_text(CONFIG)
    surroundings = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(package.parent), "NO_COLOR": "1"}

    def run(*arguments, hashseed="0"):
        return subprocess.run(
            [*COMMAND, *map(str, arguments)],
            cwd=tmp_path,
            env=surroundings | {"PYTHONHASHSEED": hashseed},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


def test_it_is_estimated_run_verified_and_compared_under_its_own_words(program, tmp_path):
    planned = program("run", "added.yaml", "--dry-run", "--json")
    assert (planned.returncode, json.loads(planned.stdout)["cells"]) == (0, 3), planned.stderr
    for hashseed in ("1", "2"):
        done = program("run", "added.yaml", "--workers", 2, hashseed=hashseed)
        assert done.returncode == 0, done.stderr
    run = the_run(tmp_path / "runs")
    assert "edited" not in done.stderr
    assert (run / "navigation" / "two" / "agents.two.lambda=1.0" / "seed-0000" / "cell.json").is_file()
    for command in (["runs", "verify", run], ["compare", run, "--by", "agent"]):
        told = program(*command, hashseed="3")
        assert (told.returncode, told.stderr) == (0, ""), command
    shown = program("validate", "added.yaml", "agents.one.lambda=0.75", "--show").stdout
    assert "lambda: 0.75" in shown
    assert "lambda_" not in shown
    settings = json.loads(program("schema").stdout)["$defs"]["TracesParameters"]["properties"]
    assert set(settings) == {"kind", "lambda", "rooms"}
    refused = program("validate", "added.yaml", "agents.one.lamda=1", "agents.two.lambda=2")
    assert refused.returncode == 3
    assert "agents.one.lamda: unknown; did you mean lambda?" in refused.stderr
    assert "agents.two.lambda: must be at most 1 (got 2)" in refused.stderr
