"""A kind of agent that somebody adds to the program: everything that reads a config meets it."""

import json

import pytest

from tests.program import Clone, the_run

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
    """A clone to which the kind was added."""
    (tmp_path / "added.yaml").write_text(CONFIG)
    return Clone(tmp_path, {"agents/traces.py": KIND})


def test_it_is_estimated_run_verified_and_compared_under_its_own_words(program, tmp_path):
    planned = program("run", "added.yaml", "--dry-run", "--json")
    assert (planned.returncode, json.loads(planned.stdout)["cells"]) == (0, 3), planned.stderr
    for hashseed in ("1", "2"):
        done = program("run", "added.yaml", "--workers", 2, PYTHONHASHSEED=hashseed)
        assert done.returncode == 0, done.stderr
    run = the_run(tmp_path / "runs")
    assert "edited" not in done.stderr
    assert (run / "navigation" / "two" / "agents.two.lambda=1.0" / "seed-0000" / "cell.json").is_file()
    for command in (["runs", "verify", run], ["compare", run, "--by", "agent"]):
        told = program(*command, PYTHONHASHSEED="3")
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
