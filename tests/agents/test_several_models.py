"""An agent without a table `q`, with two models: all who read what it saved ask it, and none looks for names."""

import json

import pytest

from tests.program import Clone, the_run

KIND = '''"""Two Dyna-like models of one world, and two tables whose mean is what it believes."""

from typing import ClassVar, Literal, NamedTuple

from visitlab_cli.agents.base import CHOOSE, LEARN, AgentParameters, zeros
from visitlab_cli.agents.declared import fault_in_model, floats
from visitlab_cli.agents.exploration import Table, greedy
from visitlab_cli.agents.sparse_model import (
    SparseModel,
    count,
    declared_model,
    empty_model,
    model_arrays,
    restored_model,
    saved_model,
    sweep,
)

NAMES = ("near", "far")


class Twin(NamedTuple):
    tables: Table
    values: Table
    near: SparseModel
    far: SparseModel


class TwinParameters(AgentParameters):
    """Sweeps the near model and counts in both."""

    plans: ClassVar[bool] = True
    kind: Literal["twin"]
    plan_every: int = 50

    def create(self, setting):
        tables = zeros(setting._replace(n_states=2 * setting.n_states)).reshape(2, setting.n_states, -1)
        return Twin(tables, zeros(setting)[:, 0].copy(), empty_model(setting), empty_model(setting))

    def restore(self, setting, saved):
        models = (restored_model(setting, saved, f"{name}_") for name in NAMES)
        return Twin(saved["tables"].copy(), zeros(setting)[:, 0].copy(), *models)

    def save(self, record):
        actions = record.tables.shape[2]
        near, far = saved_model(record.near, actions, "near_"), saved_model(record.far, actions, "far_")
        return {"tables": record.tables, **near, **far}

    def values(self, saved):
        return saved["tables"].mean(axis=0)

    def models(self, saved):
        return {name: model_arrays(saved, f"{name}_") for name in NAMES}

    def arrays(self, setting):
        tables = {"tables": floats(2, setting.n_states, setting.n_actions)}
        return tables | declared_model(setting, "near_") | declared_model(setting, "far_")

    def fault(self, setting, saved):
        faults = (fault_in_model(model) for model in self.models(saved).values())
        return next(filter(None, faults), None)


@CHOOSE.of(Twin)
def choose(agent, state, step, random):
    return greedy(agent.tables[0, state], random), False


@LEARN.of(Twin)
def learn(agent, state, action, reward, next_state, end, step, random):
    pair = state * agent.tables.shape[2] + action
    count(agent.near, pair, reward, next_state)
    if step % 2 == 0:
        count(agent.far, pair, reward, next_state)
    if step % 50 == 0:
        sweep(agent.near, agent.tables[0], agent.values, 0.9, 1, False)
'''
CONFIG = """name: twins
humans: {slow: {p_S: [1, 0, 0], p_M: 0.1}}
agents: {twin: {kind: twin}}
experiments:
  navigation: {task: navigation, agents: [twin], steps: 200}
  go_to_human: {task: go_to_human, agents: [twin], steps: 200}
  social: {task: social, agents: [twin], humans: [slow], steps: 400}
  again: {task: social, agents: [twin], humans: [slow], steps: 100, start_from: social/twin/slow}
  visit:
    task: visit
    modules: {navigation: navigation/twin, go_to_human: go_to_human/twin, social: social/twin/slow}
    humans: [slow]
    trials: 1
    trial_steps: 60
"""


DRAWN = "from pathlib import Path; from visitlab_cli.scene.trial import load_trial"


@pytest.fixture
def program(tmp_path):
    """A clone to which the kind was added."""
    (tmp_path / "twins.yaml").write_text(CONFIG)
    return Clone(tmp_path, {"agents/twin.py": KIND})


@pytest.mark.slow
def test_it_trains_goes_on_steers_a_visit_and_is_verified_drawn_and_exported(program, tmp_path):
    done = program("run", "twins.yaml", "--workers", 1)
    assert done.returncode == 0, done.stderr
    run = the_run(tmp_path / "runs")
    frozen = program("eval", run, "--frozen")
    assert frozen.returncode == 0, frozen.stderr
    for command in (["runs", "verify", run], ["export", run, "--experiment", "social", "--table", "models", "--csv"]):
        told = program(*command)
        assert told.returncode == 0, told.stderr
    shown = json.loads(program("affordances", run, "--json").stdout)
    assert sum(each["visits"] for each in shown["trained"]["transitions"]) == 400
    for log in run.rglob("steps.mcap"):
        assert program.python(f"{DRAWN}; print(load_trial(Path({str(log)!r}), 0).q.ndim)") == "2", log
    (run / "social" / "twin" / "slow" / "seed-0000" / "model.npz").write_bytes(b"no model")
    assert program("runs", "verify", run).returncode == 4
