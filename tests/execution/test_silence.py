"""A cell that hangs is told, once; what takes its time for a reason is not."""

import io
import time

import pytest
from rich.console import Console

from tests.program import TINY
from visitlab_cli.config.loading import load
from visitlab_cli.execution import cell_runner, silence, workers
from visitlab_cli.execution.progress import Progress
from visitlab_cli.execution.runner import run_cells
from visitlab_cli.execution.silence import SECONDS_ASIDE, SECONDS_OF_SILENCE, SECONDS_UNWATCHED, Silence
from visitlab_cli.plan.cells import plan

NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf], steps: 1200}}"
CELL, OTHER = plan(load(TINY, [NAVIGATION, "seeds=2"]))
LIMIT = 0.5


def told(*heard, look=1.0):
    """At which times something is told of a cell, looked at every `look` seconds, that had done so many steps then."""
    listener, clock, found = Silence(), 0.0, []
    listener.looks(clock)
    listener.begins(CELL)
    for now, steps in heard:
        while clock + look < now:
            clock += look
            listener.looks(clock)
        clock = now
        listener.looks(clock)
        if listener.heard(CELL, steps):
            found.append(now)
    return found


def test_a_silence_is_told_once_and_the_next_one_again():
    long = SECONDS_OF_SILENCE
    assert told((0, 0), (long - 1, 0), (long, 0), (long + 1, 0), (9 * long, 0)) == [long]
    assert told((0, 0), (long, 0), (long + 1, 9), (9 * long, 9), (10 * long, 9)) == [long, 9 * long]


def test_a_cell_with_slow_blocks_is_not_accused():
    long = SECONDS_OF_SILENCE
    assert told((0, 0), (50, 9), (100, 18), (240, 18), (100 + 2.9 * 50, 18), (251, 18)) == [251]
    assert told((0, 0), (1, 9), (1 + long, 9)) == [1 + long]


@pytest.mark.parametrize("aside", [workers.NOT_BEGUN, CELL.steps])
def test_compiling_and_writing_are_no_silence(aside):
    assert told((0, aside), (SECONDS_ASIDE - 1, aside)) == []
    assert told((0, aside), (SECONDS_ASIDE + 1, aside)) == [SECONDS_ASIDE + 1]
    assert told((0, workers.NOT_BEGUN), (SECONDS_ASIDE - 1, 0), (SECONDS_ASIDE, 0)) == []


def test_a_machine_that_slept_is_no_silence():
    asleep = 9 * SECONDS_OF_SILENCE
    assert told((0, 0), (asleep, 0), look=asleep) == []
    assert told((0, 0), (asleep, 0), look=SECONDS_UNWATCHED) == [asleep]


def hangs(run, cell, slot):
    """Stand in for a cell that does a block and then, for a while, no more."""
    report = workers._report_to(slot)
    report(1)
    time.sleep(4 * LIMIT if cell.path == OTHER.path else 0)
    cell_runner.run_cell(run, cell, report)


@pytest.mark.parametrize("count", [1, 2])
def test_the_run_says_which_cell_hangs(count, tmp_path, monkeypatch):
    monkeypatch.setattr(silence, "SECONDS_OF_SILENCE", LIMIT)
    monkeypatch.setattr(workers, "_run_in_slot", hangs)
    console = Console(file=io.StringIO(), width=200, soft_wrap=True)
    assert run_cells(tmp_path, [CELL, OTHER], count, Progress(quiet=True, console=console)) == {}
    lines = console.file.getvalue().splitlines()  # on a machine under load the other cell may be told, too
    (line,) = (line for line in lines if line.startswith(f"{OTHER.path}: no block of 8,192 steps for "))
    assert "1 of 1,200 steps are done; does it hang? (worker " in line
