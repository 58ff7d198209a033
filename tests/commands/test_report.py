"""`visitlab report` as a user meets it: the file, what is printed, exit codes, one clear line for what goes wrong."""

import json
import os
import shutil

import pytest

from tests.program import visitlab


@pytest.fixture
def copy(tiny_run, tmp_path):
    run = tmp_path / "runs" / tiny_run.name
    shutil.copytree(tiny_run, run)
    return run


def test_it_writes_into_the_run_and_again(copy):
    for _ in range(2):
        done = visitlab("report", copy)
        assert (done.returncode, done.stdout, done.stderr) == (0, f"{copy}/report.html\n", "")
    assert (copy / "report.html").read_text().startswith("<!doctype html>")


def test_to_a_file_of_the_users_choice_with_json(tiny_run, tmp_path):
    target = tmp_path / "für Ada.html"
    done = visitlab("report", "tiny", "--out", tiny_run.parent, "-o", target, "--json")
    told = {"run": str(tiny_run), "file": str(target), "bytes": target.stat().st_size}
    assert (json.loads(done.stdout), done.stderr) == (told, "")
    assert not (tiny_run / "report.html").exists()


def test_somebody_elses_file_is_not_overwritten(tiny_run, tmp_path):
    target = tmp_path / "thesis.html"
    target.write_text("<!doctype html>\n<p>three years of work")
    done = visitlab("report", tiny_run, "-o", target)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"{target}: exists and was not written by visitlab; move it away or choose another file\n"
    assert "three years" in target.read_text()


@pytest.mark.parametrize(
    ("place", "why"),
    [("no/report.html", "No such file or directory"), ("file/x.html", "Not a directory")],
)
def test_what_cannot_be_written(tiny_run, tmp_path, place, why):
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").touch()
    done = visitlab("report", tiny_run, "-o", tmp_path / place)
    assert (done.returncode, done.stdout) == (4, "")
    assert done.stderr == f"{tmp_path / place}: can't be written: {why}\n"
    assert sorted(os.listdir(tmp_path)) == ["file", "folder"]


def test_no_such_run_and_a_damaged_one(copy, tmp_path):
    done = visitlab("report", "nowhere", "--out", tmp_path)
    assert (done.returncode, done.stderr) == (5, f"nowhere: no such run in {tmp_path}\n")
    (copy / "versions.json").write_text("{")
    done = visitlab("report", copy)
    assert (done.returncode, done.stdout) == (4, "")
    assert done.stderr == f"{copy}/versions.json: damaged; delete it, and running again writes it\n"
    assert not (copy / "report.html").exists()


def test_a_damaged_log(copy):
    log = copy / "visit/fast/seed-0000/steps.mcap"
    log.write_bytes(bytes(log.stat().st_size))
    done = visitlab("report", copy)
    assert (done.returncode, len(done.stderr.splitlines())) == (4, 1)
    assert str(log) in done.stderr
    assert not (copy / "report.html").exists()
