"""Who is writing is known, and what is left over is removed only where its owner is surely gone."""

import errno
import fcntl
import json
import os
import subprocess
import sys
import time

import pytest

from visitlab_cli.errors import RunError
from visitlab_cli.storage import locks
from visitlab_cli.storage.cell_folder import NewCell, lock_of
from visitlab_cli.storage.file_system import what_works
from visitlab_cli.storage.leftovers import remove_leftovers
from visitlab_cli.storage.locks import HeldError, being_written, is_abandoned, lock, to_remove


def left_by(run, owner, seconds_ago=0.0):
    """A hidden folder and its lock file, which nobody locks, as `owner` left it."""
    folder = run / ".tmp-cell-01234567"
    folder.mkdir(parents=True)
    file = lock_of(folder)
    file.write_text(owner if isinstance(owner, str) else json.dumps(owner))
    os.utime(file, (time.time() - seconds_ago,) * 2)
    return folder


def here(**changes):
    return locks._me() | changes


GONE = {
    "a process that is no more": (here(process=2**22 + 1), 0),
    "a process of that number, begun at another time": (here(started="1"), 0),
    "a boot before": (here(machine=" ".join([locks._machine().split(" ")[0], "other", "pid"])), 0),
    "silent for more than an hour elsewhere": (here(machine="elsewhere boot pid"), 3700),
    "nobody knows who, for more than an hour": ("{", 3700),
}
PERHAPS_ALIVE = {
    "this very process": (here(), 1e6),
    "another machine, lately": (here(machine="elsewhere boot pid"), 3500),
    "nobody knows who, lately": ("[[[", 0),
}


@pytest.mark.parametrize(("owner", "seconds"), GONE.values(), ids=GONE)
def test_what_the_dead_left_is_removed(tmp_path, owner, seconds):
    left_by(tmp_path, owner, seconds)
    remove_leftovers(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("owner", "seconds"), PERHAPS_ALIVE.values(), ids=PERHAPS_ALIVE)
def test_what_somebody_may_be_writing_stays(tmp_path, owner, seconds):
    folder = left_by(tmp_path, owner, seconds)
    remove_leftovers(tmp_path)
    assert set(tmp_path.iterdir()) == {folder, lock_of(folder)}


def test_what_is_locked_stays_whatever_its_file_says(tmp_path):
    folder = left_by(tmp_path, here(process=2**22 + 1), 1e6)
    with lock_of(folder).open("r+") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        remove_leftovers(tmp_path)
        assert folder.exists()
    remove_leftovers(tmp_path)
    assert not folder.exists()


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL, errno.EACCES])
def test_where_nothing_can_be_locked_it_is_said_once_and_goes_on(tmp_path, monkeypatch, number):
    def refuse(descriptor, how):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(fcntl, "flock", refuse)
    said = []
    with being_written(tmp_path, said.append), NewCell(tmp_path, "a/seed-0000") as new:
        (new.folder / "model.npz").write_text("x")
        remove_leftovers(tmp_path)
        assert new.folder.exists()
        new.commit({"cell": "a"}, {})
    assert len(said) == 1
    assert (tmp_path / "a/seed-0000/model.npz").exists()
    assert "no locks are to be had" in what_works(tmp_path)["locks"]


@pytest.mark.parametrize("said", ["", "{", "[]"])
def test_who_was_killed_before_it_said_who_it_was_is_gone(tmp_path, said):
    file = tmp_path / ".tmp-x-01234567.lock"
    file.write_text(said)
    with file.open("r+") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        remove_leftovers(tmp_path)
        assert file.exists()
    remove_leftovers(tmp_path)
    assert not file.exists()


@pytest.mark.parametrize("number", [errno.EROFS, errno.EACCES])
def test_a_run_that_can_only_be_read_is_not_held_and_nothing_is_asked_of_it(tmp_path, monkeypatch, number):
    def refuse(path, flags, *mode):
        raise OSError(number, os.strerror(number), str(path))

    monkeypatch.setattr(os, "open", refuse)
    with being_written(tmp_path):
        pass
    with pytest.raises(RunError, match="can't be written"), being_written(tmp_path / "not-there"):
        pass


def test_one_holds_alone_or_several_together(tmp_path):
    refused = pytest.raises(RunError, match="is being written")
    with being_written(tmp_path), being_written(tmp_path), refused, to_remove(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []
    with to_remove(tmp_path), pytest.raises(RunError, match="is being removed"), being_written(tmp_path):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_lock_that_its_owner_removed_meanwhile_is_made_anew(tmp_path, monkeypatch):
    file, real = tmp_path / "x.lock", fcntl.flock
    removed = []

    def removed_meanwhile(descriptor, how):
        if not removed:
            removed.append(file.unlink())
        real(descriptor, how)

    monkeypatch.setattr(fcntl, "flock", removed_meanwhile)
    held = lock(file)
    assert os.path.samestat(os.fstat(held.descriptor), file.stat())
    with pytest.raises(HeldError):
        lock(file)
    held.release(remove=True)
    assert not file.exists()


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, lambda path: os.symlink("/dev/zero", path)])
def test_what_is_no_file_is_not_waited_for(tmp_path, make):
    make(tmp_path / ".lock")
    with pytest.raises(RunError, match="can't be written"), being_written(tmp_path):
        pass


def test_a_process_that_was_killed_leaves_what_the_next_one_removes(tmp_path):
    program = (
        "import os, pathlib, sys\n"
        "from visitlab_cli.storage.cell_folder import NewCell\n"
        "NewCell(pathlib.Path(sys.argv[1]), 'dead').__enter__()\n"
        "os.kill(os.getpid(), 9)\n"
    )
    subprocess.run([sys.executable, "-c", program, str(tmp_path)], check=False)
    (file,) = tmp_path.glob("*.lock")
    assert is_abandoned(file)


def test_a_process_that_ended_and_whose_parent_never_asked_is_gone():
    process = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
    owner = {"process": process.pid, "started": locks._started(process.pid)}
    assert owner["started"]
    assert locks.lives(owner)
    process.kill()
    os.waitid(os.P_PID, process.pid, os.WEXITED | os.WNOWAIT)
    assert not locks.lives(owner)
    process.wait()
    process.stdin.close()
