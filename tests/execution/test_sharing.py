"""Several runners of one run: they share its cells, say so, and do what one of them leaves."""

import io
import json
import os
import signal
import subprocess
import sys
import threading

import pytest
from rich.console import Console

from tests.program import TINY, hashes, only_cells, the_run, visitlab
from visitlab_cli.config.loading import load
from visitlab_cli.execution import cell_runner, runner, workers
from visitlab_cli.execution.progress import Progress
from visitlab_cli.execution.runner import missing_cells, run_cells
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage import claims
from visitlab_cli.storage.claims import Claims, claim_file

FOUR = "experiments={navigation: {task: navigation, agents: [mf], steps: 40}}"
HOLDS = (
    "import pathlib, sys\n"
    "from visitlab_cli.storage.claims import Claims\n"
    "Claims(pathlib.Path(sys.argv[1])).take(sys.argv[2])\n"
    "print(flush=True)\n"
    "input()\n"
)


@pytest.fixture(scope="module")
def cells():
    return plan(load(TINY, [FOUR, "seeds=6"]))


class Runner(threading.Thread):
    """A runner in a thread, and what it tells."""

    def __init__(self, run, cells, **options):
        super().__init__(daemon=True)
        self.told, self.failures, self.error = io.StringIO(), None, None
        self.work = run, cells, 1, Progress(console=Console(file=self.told, width=300), **options)
        self.start()

    def run(self):
        try:
            self.failures = run_cells(*self.work)
        except Exception as error:
            self.error = error

    def end(self, seconds=60):
        """What it told, once it has ended well."""
        self.join(seconds)
        assert (self.is_alive(), self.error, self.failures) == (False, None, {})
        return self.told.getvalue()


def test_two_runners_do_each_cell_once_and_say_that_they_share(cells, tmp_path, monkeypatch):
    both, done = threading.Barrier(2, timeout=30), []

    def one_each_at_least(run, cell, slot):
        if len(done) < 2:
            done.append(cell.path)
            both.wait()
        else:
            done.append(cell.path)
        cell_runner.run_cell(run, cell, lambda steps: None)

    monkeypatch.setattr(workers, "_run_in_slot", one_each_at_least)
    told = [each.end() for each in [Runner(tmp_path, cells), Runner(tmp_path, cells)]]
    assert sorted(done) == sorted(cell.path for cell in cells)
    assert all("runs it, too: each does the cells that the other does not" in text for text in told)
    lines = [{line.split(":")[0] for line in text.splitlines() if "reward" in line} for text in told]
    assert not lines[0] & lines[1]
    assert lines[0] | lines[1] == {cell.path for cell in cells}
    assert missing_cells(tmp_path, cells) == []
    assert not list(tmp_path.glob(".tmp-*"))


@pytest.fixture
def other(cells, tmp_path):
    """Another process that has claimed a cell, and does nothing."""
    arguments = [sys.executable, "-c", HOLDS, str(tmp_path), cells[2].path]
    process = subprocess.Popen(arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    process.stdout.readline()
    yield process
    process.kill()
    process.communicate()


def everything_but(cells, tmp_path):
    while [cell.path for cell in missing_cells(tmp_path, cells)] != [cells[2].path]:
        pass


@pytest.mark.parametrize("quiet", [False, True])
def test_one_is_killed_and_the_other_takes_over(cells, other, tmp_path, quiet):
    ours = Runner(tmp_path, cells, quiet=quiet)
    everything_but(cells, tmp_path)
    ours.join(0.3)
    assert ours.is_alive()
    other.send_signal(signal.SIGKILL)
    other.wait()
    assert ours.end().count(f"process {other.pid} on ") == (not quiet)
    assert missing_cells(tmp_path, cells) == []
    assert not list(tmp_path.glob(".tmp-*"))


def test_what_another_does_is_waited_for_and_not_done_again(cells, other, tmp_path):
    ours = Runner(tmp_path, cells)
    everything_but(cells, tmp_path)
    cell_runner.run_cell(tmp_path, cells[2], lambda steps: None)
    file = tmp_path / cells[2].path / "cell.json"
    made = file.stat().st_mtime_ns
    assert cells[2].path not in ours.end()
    assert file.stat().st_mtime_ns == made


def test_a_silent_claim_of_another_machine_is_taken_over(cells, tmp_path, monkeypatch):
    monkeypatch.setattr(claims, "DEAD_SECONDS", 0.5)
    monkeypatch.setattr(runner, "LOOK_SECONDS", 0.1)
    told = {"machine": "node7 boot pid", "process": 4321, "started": "1", "cell": cells[0].path}
    claim_file(tmp_path, cells[0].path).write_text(json.dumps(told))
    assert "process 4321 on node7 runs it, too" in Runner(tmp_path, cells).end()
    assert missing_cells(tmp_path, cells) == []
    assert not list(tmp_path.glob(".tmp-*"))


def test_the_claims_of_a_runner_that_is_asked_to_stop_are_let_go(cells, other, tmp_path, monkeypatch):
    held = []
    monkeypatch.setattr(Claims, "close", lambda self, close=Claims.close: held.append(dict(self._held)) or close(self))
    process = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGTERM))
    process.start()
    with pytest.raises(runner.Interrupted):
        run_cells(tmp_path, cells, 1, Progress(quiet=True))
    assert held == [{}]
    assert [file.name for file in tmp_path.glob(".tmp-*")] == [claim_file(tmp_path, cells[2].path).name]


def test_a_cell_that_failed_elsewhere_is_tried_here(cells, other, tmp_path):
    """Whoever fails lets the cell go; that it is not done is for each runner to find out."""
    ours = Runner(tmp_path, cells)
    everything_but(cells, tmp_path)
    other.communicate(b"\n")
    ours.end()
    assert missing_cells(tmp_path, cells) == []


def test_shards_one_after_the_other_give_the_same_bytes(tiny_run, tmp_path):
    told = []
    for shard in ("2/3", "3/3", "1/3"):
        done = visitlab("run", TINY, "--out", tmp_path, "--workers", 1, "--shard", shard)
        assert done.returncode == 0, done.stderr
        told.append(done.stdout)
    assert only_cells(hashes(the_run(tmp_path))) == only_cells(hashes(tiny_run))
    assert len(told[0].splitlines()) < len(told[2].splitlines())
    assert "0/1" not in told[0]
    assert not list(the_run(tmp_path).glob(".*"))


@pytest.mark.parametrize("word", ["", "0/2", "3/2", "2", "1/0", "1/2/3", "-1/2", "1/ 2", "x", "1/9999999", "٣/٤"])
@pytest.mark.parametrize("command", ["run", "train", "eval"])
def test_a_shard_that_is_none_is_one_line(word, command, tmp_path):
    done = visitlab(command, TINY, "--out", tmp_path, f"--shard={word}")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert "must be I/N, such as 2/8, with I from 1 to N" in done.stderr


def test_nothing_is_expected_of_a_group_that_other_shards_have_yet_to_finish(tmp_path):
    never = "expected={navigation/mf: {value: 1000, tolerance: 1}}"
    arguments = "run", TINY, FOUR, never, "seeds=2", "--out", tmp_path, "--workers", 1, "--shard"
    first = visitlab(*arguments, "1/2")
    assert (first.returncode, "1/2" in first.stdout, "MISSED" in first.stdout) == (0, True, False), first.stderr
    second = visitlab(*arguments, "2/2")
    assert (second.returncode, "2/2" in second.stdout, "MISSED" in second.stdout) == (4, True, True)


def test_a_dry_run_of_a_shard_tells_its_cells(tmp_path):
    def cells_of(shard):
        done = visitlab("run", TINY, FOUR, "seeds=6", "--out", tmp_path, "--dry-run", "--json", "--shard", shard)
        return json.loads(done.stdout)["cells"]

    assert [cells_of(f"{number}/4") for number in (1, 2, 3, 4)] == [2, 2, 1, 1]
