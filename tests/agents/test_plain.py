"""Agents in plain Python, from a file that a command names: trained, visited, watched, frozen, read."""

import re
from pathlib import Path

import numba
import numpy as np
import pytest

from tests.agents.plain_q import PlainQParameters
from tests.program import hashes, the_run, visitlab
from visitlab_cli.agents import plain
from visitlab_cli.agents.base import Setting, choose, learn
from visitlab_cli.compiled import JIT_DISABLED, kernel
from visitlab_cli.errors import RunError
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


def test_nothing_more_is_made_without_it_and_frozen_it_is_greedy_with_it(run, tmp_path):
    (tmp_path / "empty.py").touch()
    done = visitlab("eval", run, "--frozen", "--plugin", tmp_path / "empty.py")
    assert (done.returncode, "empty.py: declares no kind" in done.stderr) == (3, True)
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


REFUSED = {
    "the cell's": (
        lambda self: {"random_state": self.q},
        "an array can't be called random_state, a name of",
    ),
    "its draws'": (lambda self: {"agent_random_state": self.q}, "can't be called agent_random_state, a name of"),
    "numpy's": (lambda self: {"file": self.q}, "an array can't be called file, a name of visitlab's own"),
    "values'": (lambda self: {"q": self.q + 1}, "its array q is not what values answers"),
    "a path": (lambda self: {"a/b": self.q}, "an array can't be called 'a/b': letters, digits and _"),
    "nothing": (lambda self: {"": self.q}, "an array can't be called ''"),
    "a number": (lambda self: {1: self.q}, "an array can't be called 1"),
    "of 2 bytes": (lambda self: {"t": self.q.astype(np.float16)}, "its array t is of dtype float16, which is not kept"),
    "None": (lambda self: None, "arrays answered None, not arrays by name"),
    "ragged": (lambda self: {"t": [[1], [2, 3]]}, "its array t: ValueError"),
}


@pytest.mark.parametrize(("arrays", "line"), REFUSED.values(), ids=REFUSED)
def test_arrays_that_could_not_be_read_again_are_refused(monkeypatch, arrays, line):
    from tests.agents import plain_q

    parameters = PlainQParameters(kind="plain_q")
    monkeypatch.setattr(plain_q.PlainQ, "arrays", arrays)
    with pytest.raises(plain.AgentFailedError, match=r"its agent \(kind plain_q\) failed: ") as told:
        parameters.save(parameters.create(SETTING))
    assert line in str(told.value)
    assert "\n" not in str(told.value)


def test_it_is_given_back_what_is_its_own(monkeypatch):
    from tests.agents import plain_q

    parameters, given = PlainQParameters(kind="plain_q"), {}
    monkeypatch.setattr(plain_q.PlainQ, "restore", lambda self, arrays: given.update(arrays))
    saved = parameters.save(parameters.create(SETTING))
    plain.restored(parameters, SETTING, {**saved, "random_state": np.ones(4, np.uint64)})
    assert given.keys() == {"q"}


@pytest.mark.parametrize(("answer", "told"), [(None, "None"), (1.5, "1.5"), (float("nan"), "nan"), (("a", 1), "'a'")])
def test_what_is_no_action_is_told(monkeypatch, answer, told):
    from tests.agents import plain_q

    monkeypatch.setattr(plain_q.PlainQ, "act", lambda self, state, random, step: answer)
    record = PlainQParameters(kind="plain_q").create(SETTING)
    with pytest.raises(RuntimeError):
        play(record, 0, 20, random_state(0, "unused"), np.zeros(20, np.int64))
    assert f"step 1: TypeError: act answered {told}; an action is a whole number" in str(plain.failure_in(record, 20))


WRONG = {
    "plain": FILE.read_text().replace("plain_q", "wrong").replace('{"q": self.q}', '{"a/b": self.q}'),
    "compiled": """
from typing import Literal
from visitlab_cli.agents.q_learning import QLearningParameters

class Mine(QLearningParameters):
    kind: Literal["wrong"]

    def save(self, record):
        return {"a/b": record.q}
""",
}


@pytest.mark.parametrize("source", WRONG.values(), ids=WRONG)
def test_what_could_not_be_kept_is_told_before_it_is_learned(tmp_path, source):
    from visitlab_cli.config.loading import load
    from visitlab_cli.execution import cell_runner
    from visitlab_cli.plan.cells import plan

    (tmp_path / "wrong.py").write_text(source)
    config = tmp_path / "wrong.yaml"
    config.write_text(
        "{name: w, agents: {a: {kind: wrong}}, experiments: {n: {task: navigation, agents: [a], steps: 20}}}"
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("VISITLAB_PLUGINS", str(tmp_path / "wrong.py"))
        (cell,) = plan(load(config))
        patch.setattr(cell_runner, "simulate", lambda *given: pytest.fail("it was played"))
        with pytest.raises(RunError, match="an array can't be called 'a/b'"):
            cell_runner.run_cell(tmp_path, cell, lambda steps: None)


def unknown_attribute(x):
    return x.nothing


def unknown_name(x):
    return nothing + x  # noqa: F821


def wrong_types(x):
    return x["a"]


@pytest.mark.skipif(JIT_DISABLED, reason="nothing is compiled")
@pytest.mark.parametrize(
    ("function", "line"),
    [
        (
            unknown_attribute,
            r"Unknown attribute 'nothing' of type int64 \(test_plain.py, line \d+, unknown_attr.*\)",
        ),
        (unknown_name, "NameError: name 'nothing' is not defined"),
        (wrong_types, r"no implementation of getitem\(int64, .*\) \(test_plain.py, line \d+, wrong_types\)"),
    ],
)
def test_what_can_not_be_compiled_is_told_with_the_reason_and_the_place(function, line):
    with pytest.raises(numba.core.errors.NumbaError) as told:
        numba.njit(function).compile((numba.int64,))
    assert re.fullmatch(f"can't be compiled: {line}", plain.in_a_line(told.value))
