"""Agents in plain Python, from a file that a command names: trained, visited, watched, frozen, read."""

from pathlib import Path

import numpy as np
import pytest

from tests.agents.plain_q import PlainQParameters
from tests.program import hashes, the_run, visitlab
from visitlab_cli.agents import plain
from visitlab_cli.agents.base import Setting, choose, learn
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import random_state

FILE = Path(__file__).with_name("plain_q.py")
CONFIG = """
name: plain
humans: {h: {p_S: [0, 0.5, 0.5], p_A: 0.05}}
agents:
  mine: {kind: plain_q}
  mf: {kind: q_learning}
  watching: {kind: observer, watches: mine, learner: mf, until: 200, acts_as: mf}
experiments:
  navigation: {task: navigation, agents: [mine, watching], steps: 1000}
  go: {task: go_to_human, agents: [mine], steps: 1000}
  social: {task: social, agents: [mine], humans: [h], steps: 1000}
  again: {task: social, agents: [mine], humans: [h], steps: 1000, start_from: social/mine/h}
  visit:
    task: visit
    modules: {navigation: navigation/mine, go_to_human: go/mine, social: social/mine}
    humans: [h]
    trials: 3
"""
SETTING = Setting("navigation", 4, 3, 100, seed=1, cell="a/b")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain")
    (folder / "plain.yaml").write_text(CONFIG)
    done = visitlab("run", folder / "plain.yaml", "--plugin", FILE, "--out", folder / "one", "--workers", 1)
    assert done.returncode == 0, done.stderr
    return the_run(folder / "one")


def test_the_same_bytes_in_two_processes(run, tmp_path):
    done = visitlab("run", run / "config.yaml", "name=plain", "--plugin", FILE, "--out", tmp_path, "--workers", 2)
    assert done.returncode == 0, done.stderr
    again = the_run(tmp_path)
    assert {path: digest for path, digest in hashes(again).items() if "seed-" in path} == {
        path: digest for path, digest in hashes(run).items() if "seed-" in path
    }


@pytest.mark.parametrize("command", [["runs", "verify"], ["runs", "show"], ["steps"], ["report"]])
def test_what_it_made_is_read_without_it(run, command):
    done = visitlab(*command, run)
    assert done.returncode == 0, done.stderr
    assert "plain_q" not in done.stderr


def test_nothing_more_is_made_without_it_and_frozen_it_is_greedy_with_it(run):
    done = visitlab("eval", run, "--frozen", "--trials", 2)
    assert done.returncode == 4
    assert "no kind of agents is called plain_q here; install its package, or name its file by --plugin" in done.stderr
    assert visitlab("eval", run, "--frozen", "--trials", 2, "--plugin", FILE).returncode == 0
    assert visitlab("runs", "verify", run).returncode == 0


def test_a_wrong_action_fails_its_cell_alone_and_keeps_the_traceback(run, tmp_path):
    done = visitlab(
        "train", run / "config.yaml", "agents.mine.wrong_at=35", "--plugin", FILE, "--out", tmp_path, "--workers", 1
    )
    assert done.returncode == 4
    line = (
        "its agent (kind plain_q) failed in trial 1, step 15: ValueError: act answered 25, but actions go from 0 to 24"
    )
    assert f"navigation/mine/seed-0000: failed: {line}" in done.stderr
    file = the_run(tmp_path) / "failures" / "navigation--mine--seed-0000.txt"
    assert "Traceback" in file.read_text()
    assert visitlab("runs", "rm", the_run(tmp_path), "--yes").returncode == 0


@kernel
def play(agent, state, steps, random, chosen):
    for step in range(1, steps + 1):
        action, explored = choose(agent, state, step, random)
        chosen[step - 1] = action + 10 * explored
        learn(agent, state, action, 1.0 if action == 2 else 0.0, (state + action) % 4, False, step, random)
        state = (state + action) % 4
    return state


def test_it_goes_on_where_it_stopped_draws_included():
    parameters, unused = PlainQParameters(kind="plain_q"), random_state(0, "unused")
    whole, half, rest = (np.zeros(steps, np.int64) for steps in (200, 120, 80))
    play(parameters.create(SETTING), 0, 200, unused, whole)
    assert (whole >= 10).any()
    record = parameters.create(SETTING)
    state = play(record, 0, 120, unused, half)
    resumed = plain.restored(parameters, SETTING, parameters.save(record), same_draws=True)
    play(resumed, state, 80, unused, rest)
    assert [*half, *rest] == whole.tolist()


@pytest.mark.parametrize("missing", ["act", "learn", "arrays", "restore"])
def test_a_method_that_is_missing_is_named(monkeypatch, missing):
    from tests.agents import plain_q

    monkeypatch.delattr(plain_q.PlainQ, missing)
    with pytest.raises(plain.AgentFailedError, match=f"a PlainQ has no method {missing}"):
        PlainQParameters(kind="plain_q").create(SETTING)
