"""What kernels of others answer is looked at before it is used: that cell fails, and it alone, in a line."""

import json
from pathlib import Path

import pytest

from tests.program import the_run, visitlab

FILE = Path(__file__).with_name("wrong_answers.py")
AGENTS = {
    "right": ({"answer": 24}, ""),
    "no_action": ({"answer": 99}, "failed in trial 1, step 15: choose answered 99, but actions go from 0 to 24"),
    "of_another_task": ({"answer": 25}, "failed in trial 1, step 15: choose answered 25, but actions go from 0 to 24"),
    "negative": ({"answer": -1}, "failed in trial 1, step 15: choose answered -1, but actions go from 0 to 24"),
    "no_number": ({"value": "nan"}, "failed: its array q holds what is no number"),
    "endless": ({"value": "inf"}, "failed: its array q holds what is no number"),
    "too_large": ({"value": "'1e31'"}, "failed: its array q has values from 0.0 to 1e+31, not from -1e+30 to 1e+30"),
}
HUMANS = {
    "well": ({}, ""),
    "far_away": ({"row": 500}, "failed: react answered the cell 500, 7, but nobody can be there"),
    "outside": ({"row": -3}, "failed: react answered the cell -3, 7, but nobody can be there"),
    "turned": ({"heading": 77}, "failed: react answered human_heading 77, but that goes from 0 to 7"),
    "eager": ({"engagement": 9}, "failed: react answered engagement 9, but that goes from 0 to 3"),
    "nimble": ({"human_action": 30}, "failed: react answered human_action 30, but that goes from 0 to 24"),
}


def entries(kind, cases):
    return "".join(
        f"  {name}: {{kind: {kind}{''.join(f', {key}: {value}' for key, value in settings.items())}}}\n"
        for name, (settings, _) in cases.items()
    )


CONFIG = f"""name: wrong
agents:
{entries("wrong_agent", AGENTS)}  q: {{kind: q_learning}}
  watching: {{kind: observer, watches: no_action, learner: q, until: 100, acts_as: q}}
humans:
{entries("odd_human", HUMANS)}
experiments:
  navigation: {{task: navigation, agents: [{", ".join(AGENTS)}, watching], steps: 100}}
  social: {{task: social, agents: [q], humans: [{", ".join(HUMANS)}], steps: 100}}
"""
EXPECTED = {
    **{f"navigation/{name}": line and f"its agent (kind wrong_agent) {line}" for name, (_, line) in AGENTS.items()},
    "navigation/watching": f"its agent (kind wrong_agent) {AGENTS['no_action'][1]}",
    **{f"social/q/{name}": line and f"its human (kind odd_human) {line}" for name, (_, line) in HUMANS.items()},
}


@pytest.mark.parametrize(("workers", "compiled"), [(2, True), (1, False)])
def test_a_wrong_answer_fails_its_cell_and_it_alone(tmp_path, workers, compiled):
    (tmp_path / "config.yaml").write_text(CONFIG)
    env = {} if compiled else {"NUMBA_DISABLE_JIT": "1"}
    options = ["--plugin", FILE, "--out", tmp_path / "runs", "--workers", workers, "--quiet"]
    done = visitlab("run", tmp_path / "config.yaml", *options, env=env)
    assert done.returncode == 4, done.stderr
    told = done.stderr.splitlines()[:-1]  # the last sums up
    failing = {cell: line for cell, line in EXPECTED.items() if line}
    assert sorted(told) == sorted(f"{cell}/seed-0000: failed: {line}" for cell, line in failing.items())
    run = the_run(tmp_path / "runs")
    finished = {cell for cell in EXPECTED if (run / cell / "seed-0000" / "cell.json").is_file()}
    assert finished == EXPECTED.keys() - failing.keys()


@pytest.mark.parametrize(("case", "line"), [("no_action", "it chose 99"), ("no_number", "q holds what is no number")])
def test_plugin_check_finds_it_too(case, line):
    settings = [f"{name}={value}" for name, value in AGENTS[case][0].items()]
    done = visitlab("plugin", "check", "wrong_agent", *settings, "--json", env={"VISITLAB_PLUGINS": str(FILE)})
    assert done.returncode == 4
    (failed,) = [answer for answer in json.loads(done.stdout)["answers"] if not answer["passed"]]
    assert line in failed["seen"]
