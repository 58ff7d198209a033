"""`doctor`: what it finds here, and what it says where something is wrong."""

import json
import os

import pytest

from tests.program import visitlab
from visitlab_cli import __version__


def findings(*arguments, **options):
    done = visitlab("doctor", "--json", *arguments, **options)
    return done, {each["name"]: each for each in json.loads(done.stdout)}


def test_a_healthy_machine(tmp_path):
    done, found = findings(cwd=tmp_path, env={"VISITLAB_CACHE": str(tmp_path / "cache"), "DISPLAY": ":0"})
    assert done.returncode == 0, done.stdout
    assert found["visitlab"]["value"] == __version__
    assert {"python", "numba", "rerun-sdk", "cores", "cache", "runs", "viewer"} <= set(found)
    assert {each["state"] for name, each in found.items() if name != "runs"} == {"ok"}
    assert str(tmp_path / "cache") in found["cache"]["value"]
    assert "first run compiles" in found["cache"]["value"]
    assert not (tmp_path / "runs").exists()


def test_no_display_and_no_cache_are_notes(tmp_path):
    (tmp_path / "file").touch()
    without = {"VISITLAB_CACHE": str(tmp_path / "file" / "below"), "DISPLAY": "", "WAYLAND_DISPLAY": ""}
    done, found = findings(cwd=tmp_path, env=without)
    assert done.returncode == 0
    assert (found["cache"]["state"], found["viewer"]["state"]) == ("note", "note")
    assert "VISITLAB_CACHE" in found["cache"]["value"]
    assert "--save" in found["viewer"]["value"]


def test_what_is_in_the_way_of_a_run_is_a_problem(tmp_path):
    (tmp_path / "file").touch()
    done, found = findings("--out", tmp_path / "file" / "runs")
    assert (done.returncode, found["runs"]["state"]) == (4, "problem")
    assert done.stderr == "in the way of a run: runs\n"


def test_what_a_folder_of_runs_can_do(tmp_path):
    done, found = findings("--runs", tmp_path / "runs")
    assert done.returncode == 0, done.stdout
    assert {"creates", "locks", "renames", "times", "syncs", "speed", "files"} <= set(found)
    assert "visitlab" not in found
    assert all(found[name]["value"] == f"{tmp_path}: works" for name in ("creates", "locks", "renames", "times"))
    assert list(tmp_path.iterdir()) == []
    assert found["runs"]["value"].endswith(f"; it is not there yet, and a run makes it: this is of {tmp_path}")
    (tmp_path / "runs").mkdir()
    assert "not there" not in findings("--runs", tmp_path / "runs")[1]["runs"]["value"]


def test_where_no_folder_of_runs_can_be_made(tmp_path):
    (tmp_path / "file").touch()
    (tmp_path / "link").symlink_to(tmp_path / "nothing")
    file, link = "is a file, not a folder", "is a link to nothing"
    for place, why in {
        "file": file,
        "file/runs": f"{tmp_path / 'file'} {file}",
        "link": link,
        "link/runs": f"{tmp_path / 'link'} {link}",
    }.items():
        done, found = findings("--runs", tmp_path / place)
        assert (done.returncode, found["runs"]["state"]) == (4, "problem")
        assert found["runs"]["value"].startswith(f"{tmp_path / place}: can't be written: {why}; ")
    done = visitlab("doctor", "--runs", tmp_path / ("x" * 300))
    assert (done.returncode, done.stderr.count("\n")) == (4, 1)


@pytest.mark.parametrize("package", ["pyarrow", "matplotlib"])
def test_a_broken_package_is_named(package, tmp_path):
    broken = tmp_path / "site" / package
    broken.mkdir(parents=True)
    (broken / "__init__.py").write_text("raise ImportError('libbroken.so is missing\\nand more')")
    path = os.pathsep.join(filter(None, (str(tmp_path / "site"), os.environ.get("PYTHONPATH"))))
    done = visitlab("doctor", env={"PYTHONPATH": path})
    assert done.returncode == 4
    (line,) = [line for line in done.stdout.splitlines() if line.startswith(f"{package} ")]
    assert line.split(maxsplit=1)[1] == "problem: can't be imported: libbroken.so is missing; install it anew"
