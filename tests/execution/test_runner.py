"""What the runner does when cells fail or workers die."""

import os
import signal

import pytest

from visitlab_cli.config.loading import load
from visitlab_cli.execution import cell_runner, workers
from visitlab_cli.execution.progress import Progress
from visitlab_cli.execution.runner import missing_cells, run_cells
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage.cell_folder import NewCell

CONFIG = """
name: failing
seeds: 4
agents: {mf: {kind: q_learning}}
experiments: {navigation: {task: navigation, agents: [mf], steps: 40}}
"""


@pytest.fixture
def cells(tmp_path):
    file = tmp_path / "failing.yaml"
    file.write_text(CONFIG)
    return plan(load(file))


def dies_on_seed_1(run, cell, slot):
    """Stand in for a worker that the system kills: importable, so that processes can run it."""
    if cell.seed == 1:
        os._exit(9)
    cell_runner.run_cell(run, cell, lambda steps: None)


def dies_while_writing_seed_1(run, cell, slot):
    if cell.seed == 1:
        NewCell(run, cell.path).__enter__()
    dies_on_seed_1(run, cell, slot)


def kills_what_starts_workers(run, cell, slot):
    """Stand in for a cell of a worker whose server somebody kills, once."""
    if not (run / "killed").exists():
        (run / "killed").touch()
        os.kill(os.getppid(), 9)
    cell_runner.run_cell(run, cell, lambda steps: None)


def raises_on_seed_1(run, cell, slot):
    if cell.seed == 1:
        raise ZeroDivisionError("no such thing")
    cell_runner.run_cell(run, cell, lambda steps: None)


@pytest.mark.parametrize("count", [1, 2])
def test_an_exception_fails_its_cell_alone(cells, tmp_path, monkeypatch, count):
    monkeypatch.setattr(workers, "_run_in_slot", raises_on_seed_1)
    failures = run_cells(tmp_path, cells, count, Progress(quiet=True))
    assert failures == {"navigation/mf/seed-0001": "ZeroDivisionError: no such thing"}
    assert [cell.seed for cell in missing_cells(tmp_path, cells)] == [1]


def test_a_worker_that_always_dies_costs_only_its_cell(cells, tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "_run_in_slot", dies_on_seed_1)
    failures = run_cells(tmp_path, cells, 2, Progress(quiet=True))
    assert failures == {"navigation/mf/seed-0001": "its worker process died 3 times (out of memory?)"}
    assert [cell.seed for cell in missing_cells(tmp_path, cells)] == [1]


def segfaults_on_seed_1(run, cell, slot):
    if cell.seed == 1:
        signal.raise_signal(signal.SIGSEGV)
    cell_runner.run_cell(run, cell, lambda steps: None)


def test_a_signal_that_a_worker_dies_of_is_told(cells, tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "_run_in_slot", segfaults_on_seed_1)
    (line,) = run_cells(tmp_path, cells[:2], 2, Progress(quiet=True)).values()
    assert line == "its worker process died 3 times (SIGSEGV: Segmentation fault)"


def test_the_server_of_the_workers_is_killed(cells, tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "_run_in_slot", kills_what_starts_workers)
    assert run_cells(tmp_path, cells, 2, Progress(quiet=True)) == {}
    assert missing_cells(tmp_path, cells) == []


def test_a_server_that_dies_at_each_start_ends_the_run_in_a_line(cells, tmp_path, monkeypatch):
    def refuse(*anything):
        raise EOFError

    monkeypatch.setattr(workers.Workers, "submit", refuse)
    assert set(run_cells(tmp_path, cells, 2, Progress(quiet=True)).values()) == {
        "its worker process died 3 times (out of memory?)"
    }


def test_what_killed_workers_left_is_gone_at_the_end(cells, tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "_run_in_slot", dies_while_writing_seed_1)
    assert len(run_cells(tmp_path, cells, 2, Progress(quiet=True))) == 1
    assert not list(tmp_path.glob(".tmp-*"))


def test_rewards_that_are_no_numbers_fail_the_cell(cells, tmp_path, monkeypatch):
    monkeypatch.setattr(cell_runner, "last_mean", lambda rewards, part: float("nan"))
    failures = run_cells(tmp_path, cells[:1], 1, Progress(quiet=True))
    assert list(failures) == ["navigation/mf/seed-0000"]
    assert not list(tmp_path.glob("navigation/*/*"))
