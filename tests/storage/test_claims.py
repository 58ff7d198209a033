"""Who does a cell is claimed, and a claim is taken over only where its runner is gone, whatever the clocks say."""

import errno
import fcntl
import json
import os
import signal
import subprocess
import sys
import time

import pytest

from visitlab_cli.storage import locks
from visitlab_cli.storage.cell_folder import NewCell
from visitlab_cli.storage.claims import BEAT_SECONDS, DEAD_SECONDS, Claims, Owner, claim_file
from visitlab_cli.storage.leftovers import remove_leftovers
from visitlab_cli.storage.under_way import under_way

CELL = "social/mb/fast/seed-0000"
ELSEWHERE = {"machine": "elsewhere boot pid", "process": 4321, "started": "1", "cell": CELL}
KILLED = (
    "import os, pathlib, sys\n"
    "from visitlab_cli.storage.claims import Claims\n"
    "Claims(pathlib.Path(sys.argv[1])).take(sys.argv[2])\n"
    "os.kill(os.getpid(), 9)\n"
)


class Clock:
    """A clock that goes when it is told to."""

    now = 0.0

    def __call__(self):
        return self.now


def claimed_by(run, told, mtime=None):
    """A claim that nobody locks."""
    file = claim_file(run, CELL)
    file.write_text(told if isinstance(told, str) else json.dumps(told))
    if mtime is not None:
        os.utime(file, (mtime, mtime))
    return file


def watched(claims, clock, seconds, each=lambda: None):
    """Look every second for so long: who has the cell at the end."""
    for _ in range(int(seconds)):
        clock.now += 1
        each()
        if (owner := claims.take(CELL)) is None:
            return None
    return owner


def test_one_has_a_cell_until_it_lets_it_go(tmp_path):
    ours, theirs = Claims(tmp_path), Claims(tmp_path)
    assert ours.take(CELL) is None
    assert theirs.take(CELL) == Owner(locks._machine().split(" ")[0], os.getpid())
    assert theirs.take("another") is None
    remove_leftovers(tmp_path)
    assert len(list(tmp_path.iterdir())) == 2
    ours.release(CELL)
    assert theirs.take(CELL) is None
    theirs.close()
    assert list(tmp_path.iterdir()) == []


def test_the_claim_of_a_killed_process_is_taken_over_at_once(tmp_path):
    subprocess.run([sys.executable, "-c", KILLED, str(tmp_path), CELL], check=False)
    (left,) = tmp_path.iterdir()
    claims = Claims(tmp_path)
    assert claims.take(CELL) is None
    assert json.loads(left.read_text())["process"] == os.getpid()
    claims.close()
    assert list(tmp_path.iterdir()) == []


def test_the_claim_of_a_killed_process_is_left_over(tmp_path):
    subprocess.run([sys.executable, "-c", KILLED, str(tmp_path), CELL], check=False)
    remove_leftovers(tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("mtime", [None, 1.0, time.time() + 1e9], ids=["now", "long ago", "to come"])
@pytest.mark.parametrize("told", [ELSEWHERE, {"machine": 3, "process": "x"}], ids=["elsewhere", "nonsense"])
def test_a_silent_claim_of_another_machine_is_taken_over_after_the_stated_time(tmp_path, told, mtime):
    claimed_by(tmp_path, told, mtime)
    claims = Claims(tmp_path, clock := Clock())
    assert watched(claims, clock, DEAD_SECONDS) is not None
    assert watched(claims, clock, 2) is None
    claims.close()


@pytest.mark.parametrize("step", [1.0, -3600.0, 1e8], ids=["on", "back", "ahead"])
def test_a_claim_that_changes_lives_however_the_clocks_jump(tmp_path, step):
    file = claimed_by(tmp_path, ELSEWHERE, time.time())
    claims = Claims(tmp_path, clock := Clock())

    def beats():
        if clock.now % 100 == 0:
            os.utime(file, (file.stat().st_mtime + step,) * 2)

    assert watched(claims, clock, 10 * DEAD_SECONDS, beats) == Owner("elsewhere", 4321)


def test_a_runner_that_was_stopped_itself_does_not_take_others_for_dead(tmp_path):
    claimed_by(tmp_path, ELSEWHERE)
    claims = Claims(tmp_path, clock := Clock())
    for _ in range(10):
        clock.now += 3600
        assert claims.take(CELL) == Owner("elsewhere", 4321)


def test_a_runner_that_hangs_with_its_lock_loses_it_and_takes_nothing_away_later(tmp_path):
    hung, claims = Claims(tmp_path), Claims(tmp_path, clock := Clock())
    hung.take(CELL)
    assert watched(claims, clock, DEAD_SECONDS) is not None
    assert watched(claims, clock, 2) is None
    hung.close()
    assert claim_file(tmp_path, CELL).exists()
    assert Claims(tmp_path).take(CELL) is not None
    claims.close()


def test_claims_are_touched_while_cells_run(tmp_path):
    claims = Claims(tmp_path, clock := Clock())
    claims.take(CELL)
    file = claim_file(tmp_path, CELL)
    os.utime(file, (1, 1))
    clock.now += BEAT_SECONDS - 1
    claims.beat()
    assert file.stat().st_mtime == 1
    clock.now += 1
    claims.beat()
    assert file.stat().st_mtime > time.time() - 60
    claims.close()


def test_where_nothing_can_be_locked_a_living_process_of_this_machine_still_has_its_cells(tmp_path, monkeypatch):
    def refuse(descriptor, how):
        raise OSError(errno.ENOLCK, "no locks")

    monkeypatch.setattr(fcntl, "flock", refuse)
    ours, theirs = Claims(tmp_path), Claims(tmp_path)
    assert ours.take(CELL) is None
    assert theirs.take(CELL) is not None
    ours.release(CELL)
    assert theirs.take(CELL) is None
    theirs.close()
    claimed_by(tmp_path, locks._me() | {"process": 2**22 + 1})
    assert ours.take(CELL) is None
    ours.close()


@pytest.mark.parametrize(
    "make", [os.mkfifo, os.mkdir, lambda path: os.symlink("/dev/zero", path)], ids=["pipe", "folder", "link"]
)
def test_what_is_no_claim_keeps_nobody_from_a_cell(tmp_path, make):
    make(claim_file(tmp_path, CELL))
    claims = Claims(tmp_path)
    assert claims.take(CELL) is None
    claims.close()
    assert list(tmp_path.iterdir()) == [claim_file(tmp_path, CELL)]


def test_a_folder_that_cannot_be_written_keeps_nobody_from_trying(tmp_path):
    assert Claims(tmp_path / "not-there").take(CELL) is None


def test_what_is_under_way_is_seen_from_its_locks_alone(tmp_path, monkeypatch):
    monkeypatch.setattr(locks, "BEAT", 0.0)
    claims = Claims(tmp_path)
    claims.take(CELL)
    claims.take("navigation/mf/seed-0001")
    here = locks._machine().split(" ")[0]
    with NewCell(tmp_path, CELL) as new:
        new.beat(12_345)
        new.beat(6)
        told = {each.cell: (each.owner.host, each.owner.process, each.steps) for each in under_way(tmp_path)}
        assert told == {CELL: (here, os.getpid(), 6), "navigation/mf/seed-0001": (here, os.getpid(), 0)}
    claims.close()
    assert under_way(tmp_path) == []


def test_what_a_killed_process_left_is_not_under_way(tmp_path):
    waits = KILLED.replace("os.kill(os.getpid(), 9)", "print(flush=True); input()")
    command = [sys.executable, "-c", waits, str(tmp_path), CELL]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stdin=subprocess.PIPE)
    process.stdout.readline()
    (each,) = under_way(tmp_path)
    assert (each.cell, each.owner.process) == (CELL, process.pid)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    assert under_way(tmp_path) == []


@pytest.mark.parametrize("told", ["[" * 5000, '{"cell": 3, "steps": true}', '{"cell": "x", "steps": -1e400}', "\0"])
def test_nonsense_in_a_lock_file_is_passed_over(tmp_path, told):
    claimed_by(tmp_path, told)
    assert [(each.cell, each.steps) for each in under_way(tmp_path)] in ([], [("x", 0)])
