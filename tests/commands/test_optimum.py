"""`visitlab optimum`, end to end."""

import json

import pytest

from tests.program import visitlab
from visitlab_cli.config.loading import load
from visitlab_cli.storage.run_folder import open_run


@pytest.mark.slow
def test_optimum_prints_the_three_trainings():
    done = visitlab("optimum")
    assert done.returncode == 0, done.stderr
    assert "navigation" in done.stdout
    assert "18.0787" in done.stdout
    assert [line.split()[-2] for line in done.stdout.splitlines() if "human_2_pointing" in line] == ["8.75"]


@pytest.mark.slow
def test_optimum_as_json():
    done = visitlab("optimum", "--json", "--gamma", "0.5")
    found = json.loads(done.stdout)
    assert found["gamma"] == 0.5
    assert {line["task"] for line in found["values"]} == {"navigation", "go_to_human", "social"}
    assert all(line["random"] < line["optimal"] for line in found["values"])


def test_a_wrong_gamma_is_wrong_usage():
    for gamma in ("1", "nan", "x"):
        assert visitlab("optimum", "--gamma", gamma).returncode == 2


LABS = """name: small
labs: {two: {map: AAabBB}, three: {map: AAabBbcCC}}
agents: {mb: {kind: model_based}}
experiments: {navigation: {task: navigation, agents: [mb], lab: two, steps: 40}}
"""


def test_a_config_of_ones_own_or_a_run_and_one_of_its_labs(tmp_path):
    (tmp_path / "small.yaml").write_text(LABS)
    done = visitlab("optimum", tmp_path / "small.yaml", "--lab", "two")
    assert done.returncode == 0, done.stderr
    head, *lines = done.stdout.splitlines()
    assert head.split()[:2] == ["task", "lab"]
    assert [line.split()[:2] for line in lines] == [["navigation", "two"]] * 2 + [["go_to_human", "two"]] * 2
    run, _ = open_run(tmp_path, load(tmp_path / "small.yaml"), {})
    of_run = visitlab("optimum", run.name, "--lab", "two", "--out", tmp_path)
    assert (of_run.returncode, of_run.stdout) == (0, done.stdout)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--lab", "tow"], "--lab tow: no lab is called so; did you mean two?"),
        (["nope.yaml"], "nope.yaml: no such file, nor a shipped config"),
    ],
)
def test_what_there_is_not_is_a_line(tmp_path, words, line):
    (tmp_path / "small.yaml").write_text(LABS)
    done = visitlab("optimum", *([tmp_path / "small.yaml"] if words[0] == "--lab" else []), *words)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (5, "", 1)
    assert line in done.stderr
