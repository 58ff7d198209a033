"""`plugin new`: the package works when it is installed, in a fresh folder of packages, with nothing of ours touched."""

import json
import os
import subprocess
import sys

import pytest

from tests import packages
from tests.program import the_run, visitlab

TAKEN = ("numpy", "visitlab_cli", "json", "print", "tests")


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("new")
    done = visitlab("plugin", "new", "my_agent", "--folder", folder, "--json")
    assert done.returncode == 0, done.stderr
    assert {os.path.relpath(file, folder) for file in json.loads(done.stdout)["files"]} == {
        "my_agent/README.md",
        "my_agent/my_agent.yaml",
        "my_agent/my_agent/__init__.py",
        "my_agent/pyproject.toml",
        "my_agent/tests/test_my_agent.py",
    }
    return folder / "my_agent"


@pytest.fixture(scope="module")
def installed(package, tmp_path_factory):
    """What to add to the environment so that the package is installed."""
    return packages.installed(package, tmp_path_factory.mktemp("packages"))


def test_its_project_file_declares_what_it_is(package):
    import tomllib

    project = tomllib.loads((package / "pyproject.toml").read_text())["project"]
    assert project["name"] == "visitlab-my-agent"
    assert project["entry-points"]["visitlab.agents"] == {"my_agent": "my_agent:Parameters"}


def test_it_is_listed_checked_trained_and_visited(package, installed, tmp_path):
    listed = json.loads(visitlab("agents", "--json", env=installed).stdout)["agents"]
    (own,) = [each for each in listed if each["kind"] == "my_agent"]
    assert (own["package"], own["version"], own["compiled"]) == ("visitlab-my-agent", "0.1.0", False)
    done = visitlab("plugin", "check", "my_agent", env=installed)
    assert (done.returncode, done.stderr) == (0, "")
    few = [f"experiments.{name}.steps=2000" for name in ("navigation", "go_to_human", "social")]
    config = [package / "my_agent.yaml", "seeds=1", "experiments.visit.trials=2", *few, "--workers", "1"]
    done = visitlab("run", *config, "--out", tmp_path, env=installed)
    assert done.returncode == 0, done.stderr
    run = the_run(tmp_path)
    assert json.loads((run / "versions.json").read_text())["visitlab-my-agent"] == "0.1.0"
    for command in (["runs", "verify"], ["runs", "show"], ["steps"], ["compare"]):
        more = ["--by", "agent"] if command == ["compare"] else []
        assert visitlab(*command, run, *more).returncode == 0  # without the package


def test_its_own_test_passes(package, installed):
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "tests"],
        cwd=package,
        env=os.environ | installed,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("name", ["class", "My", "q_learning", "../x", "a b", "x\x1b[1m", *TAKEN])
def test_a_name_that_can_not_be(tmp_path, name):
    done = visitlab("plugin", "new", name, "--folder", tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "\x1b" not in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_overwritten(tmp_path):
    (tmp_path / "mine").mkdir()
    done = visitlab("plugin", "new", "mine", "--folder", tmp_path)
    assert (done.returncode, done.stderr) == (2, f"{tmp_path / 'mine'}: exists; choose another name or --folder\n")
