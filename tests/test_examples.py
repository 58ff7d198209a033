"""The packages in `examples/`, installed: listed, checked, trained, visited, resumed, frozen, compared, replayed."""

import json
import os
import subprocess
import sys

import pytest

from tests.packages import EXAMPLES, installed
from tests.program import hashes, the_run, visitlab

KINDS = {
    "visitlab-sarsa": ({"sarsa_plain": False}, {}),
    "visitlab-more": ({"double_q": True}, {"tiring": True, "curious": True}),
}
CONFIG = {"visitlab-sarsa": "sarsa.yaml", "visitlab-more": "more.yaml"}
SMALL = [f"experiments.{name}.steps=2000" for name in ("navigation", "go_to_human", "social")]
SMALL += ["experiments.visit.trials=2", "seeds=1"]


@pytest.fixture(scope="module", params=["visitlab-sarsa", pytest.param("visitlab-more", marks=pytest.mark.slow)])
def example(request, tmp_path_factory):
    """An example's name and the environment in which it is installed."""
    return request.param, installed(EXAMPLES / request.param, tmp_path_factory.mktemp("packages"))


@pytest.fixture(scope="module")
def run(example, tmp_path_factory):
    name, env = example
    out = tmp_path_factory.mktemp("runs")
    done = visitlab("run", EXAMPLES / name / CONFIG[name], *SMALL, "--out", out, "--workers", 2, env=env)
    assert done.returncode == 0, done.stderr
    return the_run(out)


@pytest.mark.parametrize("number", [0, 1], ids=["agents", "humans"])
def test_its_kinds_are_listed(example, number):
    name, env = example
    section = ("agents", "humans")[number]
    listed = json.loads(visitlab(section, "--json", env=env).stdout)[section]
    assert {each["kind"]: each["compiled"] for each in listed if each["package"] == name} == KINDS[name][number]
    assert all(each["error"] is None for each in listed)


def test_its_own_tests_pass(example):
    name, env = example
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", EXAMPLES / name / "tests"],
        cwd=EXAMPLES / name,
        env=os.environ | env,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_it_is_read_without_the_package_and_goes_on_with_it(example, run):
    name, env = example
    for command in (["runs", "verify"], ["runs", "show"], ["steps"], ["compare", "--by", "agent"], ["report"]):
        done = visitlab(*command, run)
        assert done.returncode == 0, (command, done.stderr)
    assert visitlab("replay", run, "--save", run.parent / "trial.rrd").returncode == 0
    assert json.loads((run / "versions.json").read_text())[name] == "0.1.0"
    before = hashes(run)
    again = visitlab("run", EXAMPLES / name / CONFIG[name], *SMALL, "--out", run.parent, env=env)
    assert again.returncode == 0
    cell = next(run.glob("social/*/*/seed-0000"))
    (cell / "cell.json").unlink()
    again = visitlab("run", EXAMPLES / name / CONFIG[name], *SMALL, "--out", run.parent, "--workers", 1, env=env)
    assert again.returncode == 0
    assert {path: each for path, each in hashes(run).items() if "seed-" in path} == {
        path: each for path, each in before.items() if "seed-" in path
    }
    assert visitlab("eval", run, "--frozen", "--trials", 2, env=env).returncode == 0
