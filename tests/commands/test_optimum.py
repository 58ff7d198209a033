"""`visitlab optimum`, end to end."""

import json

import pytest

from tests.program import visitlab


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
