"""The same config and seed give the same bytes, whatever happens around them."""

import os
import signal
import time

import pytest

from tests.program import TINY, hashes, new_process, only_cells, start, the_run, visitlab

LONG = """
name: long
seeds: 3
agents:
  mf: {kind: q_learning}
  mb: {kind: model_based}
experiments:
  navigation: {task: navigation, agents: [mf], steps: 400000}
  go_to_human: {task: go_to_human, agents: [mb], steps: 200000}
"""


def test_two_workers(tiny_run, tmp_path):
    done = new_process("run", TINY, "--out", tmp_path, "--workers", 2)  # whose hashes are others than of what forks
    assert done.returncode == 0, done.stderr
    assert hashes(the_run(tmp_path)) == hashes(tiny_run)


def test_other_seeds_beside_and_added_later(tiny_run, tmp_path):
    assert new_process("run", TINY, "seeds=2", "--out", tmp_path).returncode == 0
    beside = only_cells(hashes(the_run(tmp_path)))
    first = only_cells(hashes(tiny_run))
    assert {path: digest for path, digest in beside.items() if "seed-0000" in path} == first
    assert len(beside) == 2 * len(first)
    later = tmp_path.with_name("later")
    assert visitlab("run", TINY, "--out", later).returncode == 0
    assert visitlab("run", TINY, "seeds=2", "--out", later).returncode == 0
    assert hashes(the_run(later)) == hashes(the_run(tmp_path))


def test_uncompiled(tiny_run, tmp_path):
    done = visitlab("run", TINY, "--out", tmp_path, env={"NUMBA_DISABLE_JIT": "1"})
    assert done.returncode == 0, done.stderr
    assert hashes(the_run(tmp_path)) == hashes(tiny_run)


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("long")
    config = folder / "long.yaml"
    config.write_text(LONG)
    done = visitlab("run", config, "--out", folder / "runs")
    assert done.returncode == 0, done.stderr
    return config, hashes(the_run(folder / "runs"))


def wait_for_first_cell(program):
    for line in program.stderr:
        if "reward a trial" in line:
            return
    raise AssertionError("ended without a result")


@pytest.mark.parametrize(
    ("number", "workers"),
    [
        pytest.param(signal.SIGINT, 1, marks=pytest.mark.slow),
        (signal.SIGINT, 2),
        (signal.SIGTERM, 1),
        pytest.param(signal.SIGHUP, 2, marks=pytest.mark.slow),
    ],
)
def test_interrupted_and_resumed(undisturbed, tmp_path, workers, number):
    config, expected = undisturbed
    program = start("run", config, "--out", tmp_path, "--workers", workers)
    wait_for_first_cell(program)
    program.send_signal(number)
    _, stderr = program.communicate(timeout=60)
    assert program.returncode == 130
    assert "interrupted; what was finished is kept" in stderr
    run = the_run(tmp_path)
    left = only_cells(hashes(run))
    assert 0 < len(left) < len(only_cells(expected))
    assert not list(run.glob(".tmp-*"))
    before = {path: (run / path).stat().st_mtime_ns for path in left}
    assert visitlab("run", config, "--out", tmp_path).returncode == 0
    assert hashes(run) == expected
    assert {path: (run / path).stat().st_mtime_ns for path in left} == before


@pytest.mark.parametrize("workers", [1, 2])
def test_killed_and_resumed_without_orphans(undisturbed, tmp_path, workers):
    config, expected = undisturbed
    program = start("run", config, "--out", tmp_path, "--workers", workers)
    wait_for_first_cell(program)
    program.kill()
    program.wait()
    deadline = time.monotonic() + 20
    while orphans := members_of(program.pid):
        assert time.monotonic() < deadline, orphans
        time.sleep(0.1)
    assert visitlab("run", config, "--out", tmp_path).returncode == 0
    run = the_run(tmp_path)
    assert hashes(run) == expected
    assert not list(run.glob(".tmp-*"))


def members_of(session):
    """The living processes of a session."""
    found = []
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat") as file:
                fields = file.read().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            found.append(name)
    return found
