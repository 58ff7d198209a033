"""What is there and can't be read is no damage: it is told, nothing is set aside, nothing is made anew."""

import errno
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.program import COMMAND, TINY
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.reading import NOT_NOW, UnreadableError, read_bytes

CELL = "navigation/mf/seed-0000"
POWERS = "-dac_override,-dac_read_search,-fowner"
"""What root must lose to be refused like everybody else."""


@pytest.fixture
def run(tiny_run, tmp_path):
    """A copy of the tiny run that a test may change, whatever it forbids on the way."""
    copy = shutil.copytree(tiny_run, tmp_path / "runs" / tiny_run.name)
    yield copy
    for here, folders, _ in os.walk(copy.parent):
        for name in folders:
            os.chmod(os.path.join(here, name), 0o755)


def ordinary(*arguments):
    """The program, run without root's powers."""
    command = [*COMMAND, *map(str, arguments)]
    if os.geteuid() == 0:
        if shutil.which("setpriv") is None:
            pytest.skip("root may read everything, and there is no setpriv")
        command = ["setpriv", "--bounding-set", POWERS, "--inh-caps", POWERS, *command]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def contents(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*"))


@pytest.mark.parametrize("name", ["model.npz", "trials.parquet", "steps.mcap", "cell.json"])
def test_a_file_is_told_and_left_as_it_is_by_whoever_meets_it(run, name):
    file = run / CELL / name
    before = contents(run)
    file.chmod(0)
    line = f"{file}: can't be read: Permission denied\n"
    done = ordinary("runs", "verify", run, "--json")
    told = json.loads(done.stdout)
    assert (done.returncode, done.stderr) == (4, line)
    assert (told["faults"], told["whole"], told["cells"]) == ([], 16, 17)
    assert told["unread"] == {CELL: line[:-1]}
    if name == "cell.json":
        for command in (["run", run / "config.yaml", "--out", run.parent], ["runs", "show", run], ["report", run]):
            done = ordinary(*command)
            assert (done.returncode, done.stderr.splitlines()[-1]) == (4, line[:-1]), command
    assert contents(run) == before


@pytest.mark.parametrize("name", ["config.yaml", "versions.json"])
def test_a_runs_own_file_is_not_written_anew(run, name):
    before = contents(run)
    (run / name).chmod(0)
    line = f"{run / name}: can't be read: Permission denied"
    done = ordinary("runs", "verify", run)
    assert (done.returncode, done.stderr.splitlines()) == (4, [line])
    done = ordinary("run", TINY, "--out", run.parent)  # which need not look into versions.json once a cell is done
    assert (done.returncode, done.stderr.splitlines()[-1:]) == ((4, [line]) if name == "config.yaml" else (0, []))
    assert contents(run) == before


def test_a_folder_is_told_by_list_beside_the_others_and_removed_by_nobody(run):
    other = shutil.copytree(run, run.with_name("other-01234567"))
    before = contents(other)
    for folder, problem in ((other / "visit", "visit/fast/seed-0000"), (other, "config.yaml")):
        folder.chmod(0)
        done = ordinary("runs", "list", "--out", run.parent, "--json")
        lines = {line["name"]: line for line in json.loads(done.stdout)["runs"]}
        assert done.returncode == 0
        assert lines[run.name]["state"] == "done"
        assert lines[other.name]["state"] == "unreadable"
        assert lines[other.name]["problem"] == f"{other / problem}: can't be read: Permission denied"
        done = ordinary("runs", "rm", other, "--yes")
        assert (done.returncode, done.stderr.count("\n")) == (4, 1), done.stderr
        folder.chmod(0o755)
        assert contents(other) == before


def test_a_folder_that_may_not_be_written_in_is_known_before_anything_is_removed(run):
    before = contents(run)
    (run / "visit").chmod(0o555)
    done = ordinary("runs", "rm", run, "--yes")
    assert (done.returncode, done.stderr) == (4, f"{run}: can't be removed: {run / 'visit'} may not be written in\n")
    assert contents(run) == before


@pytest.mark.parametrize("number", NOT_NOW, ids=lambda number: errno.errorcode[number])
def test_whatever_the_system_says_that_is_no_word_on_the_content(run, monkeypatch, number):
    def refuse(*_arguments, **_options):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, "open", refuse)
    for look in (read_cell, lambda folder: read_bytes(folder / "model.npz")):
        with pytest.raises(UnreadableError, match="can't be read: "):
            look(run / CELL)


@pytest.mark.skipif(sys.platform != "linux", reason="needs a file whose reading fails")
def test_a_disk_that_fails_while_it_is_read():
    with pytest.raises(UnreadableError, match="/proc/self/mem: can't be read: Input/output error$"):
        read_bytes(Path("/proc/self/mem"))
