"""What is told of a plan before it runs."""

import json

import pytest

from tests.program import visitlab
from visitlab_cli.config.loading import load_text
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.evaluation import Evaluation
from visitlab_cli.plan.notes import notes_on

CONFIG = """
name: notes
humans: {a: {p_S: [1, 0, 0]}, b: {p_S: [0, 1, 0]}}
agents:
  mb: {kind: model_based}
  other: {kind: model_based, epsilon: 0.2, plan_every: 10}
  multi: {kind: multi_model}
  told: {kind: multi_model, told: true}
experiments:
  navigation: {task: navigation, agents: [mb], steps: 20}
  go: {task: go_to_human, agents: [mb], steps: 20}
  social: {task: social, agents: [mb, other, multi, told], humans: [a, b], steps: 20}
  visit:
    task: visit
    modules: {navigation: navigation/mb, go_to_human: go/mb, social: SOCIAL}
    MEETS
"""
DROPPED = "experiments.visit: the pool goes on as its first agent, {} ({}); {}'s {} is dropped"
UNTOLD = (
    "experiments.visit: agents.told.told: there are no phases, so nobody is told; with b it goes on with what it "
    "learned with a"
)


def config(social, meets="humans: [b]"):
    return CONFIG.replace("SOCIAL", social).replace("MEETS", meets)


@pytest.mark.parametrize(
    ("social", "meets", "notes"),
    [
        ("{pool: [social/mb/a, social/mb/b]}", "humans: [b]", []),
        # plan_every is the visit's
        (
            "{pool: [social/mb/a, social/other/b, social/other/a]}",
            "humans: [a, b]",
            [DROPPED.format("mb", "epsilon 0.05", "other", "epsilon 0.2")],
        ),
        (
            "{pool: [social/multi/a, social/told/b]}",
            "humans: [b]",
            [DROPPED.format("multi", "told false", "told", "told true")],
        ),
        ("social/told/a", "humans: [a, b]", [UNTOLD]),
        ("social/told/a", "phases: [{trials: 1, human: b}]", []),
        ("social/multi/a", "humans: [b]", []),
    ],
)
def test_what_a_config_says_and_nothing_comes_of_is_told(social, meets, notes):
    found = load_text(config(social, meets), "notes.yaml")
    assert notes_on(plan(found)) == notes
    assert notes_on(plan(found, Evaluation(frozen=True))) == []


def test_the_commands_tell_it_aside(tmp_path):
    (tmp_path / "notes.yaml").write_text(config("social/told/a"))
    for words in (["validate"], ["run", "--dry-run"], ["submit", "--shell", "--dry-run"]):
        done = visitlab(words[0], "notes.yaml", *words[1:], cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, f"{UNTOLD}\n"), words
    assert visitlab("run", "notes.yaml", "--dry-run", "--quiet", cwd=tmp_path).stderr == ""
    assert json.loads(visitlab("validate", "notes.yaml", "--json", cwd=tmp_path).stdout)["notes"] == [UNTOLD]
