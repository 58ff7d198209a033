"""A long cell that was stopped goes on from its checkpoint, to the bytes of an undisturbed one, or begins anew."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.agents.plain_q import PlainQParameters
from tests.execution.stopped_cells import digests, stopping_after, went
from tests.program import TINY, hashes, only_cells, the_run, visitlab
from visitlab_cli.agents.base import Setting
from visitlab_cli.config.loading import load, load_text
from visitlab_cli.errors import RunError
from visitlab_cli.execution import cell_runner, checkpoints
from visitlab_cli.execution.progress import Progress
from visitlab_cli.execution.runner import run_cells
from visitlab_cli.execution.versions import decided_by
from visitlab_cli.plan.cells import plan
from visitlab_cli.simulation.memory import ElsewhereError, Memory
from visitlab_cli.storage import checkpoint_file, key
from visitlab_cli.storage.cell_folder import lock_of
from visitlab_cli.storage.checkpoint_file import NAMES
from visitlab_cli.storage.leftovers import remove_leftovers
from visitlab_cli.storage.removal import prune, remove_run

CONFIG = """
name: long
agents: {mf: {kind: q_learning}}
experiments: {navigation: {task: navigation, agents: [mf], steps: 3000}}
"""
ROWS = 250


@pytest.fixture(autouse=True)
def often(monkeypatch, tmp_path):
    """A checkpoint after each block of 250 rows, chunks of 400, and a secret that is not the user's."""
    monkeypatch.setattr(cell_runner, "BLOCK_ROWS", ROWS)
    monkeypatch.setattr(checkpoints, "EVERY", 0.0)
    monkeypatch.setattr(checkpoints, "SHARE", float("inf"))
    monkeypatch.setattr("visitlab_cli.log.writer.CHUNK_STEPS", 400)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))


@pytest.fixture
def cell():
    (cell,) = plan(load_text(CONFIG, "long.yaml"))
    return cell


@pytest.fixture
def run(tmp_path, cell):
    """A run in which the cell was stopped after 1,500 steps; the newest checkpoint is the second of the two."""
    assert went(tmp_path / "run", cell, stopping_after(1500)) is None
    return tmp_path / "run"


@pytest.fixture
def expected(tmp_path, cell):
    assert went(tmp_path / "whole", cell) == 0
    return digests(tmp_path / "whole", cell)


def hidden(run):
    (folder,) = (path for path in run.glob(".tmp-*") if path.is_dir())
    return folder


def newest_first(run):
    folder = hidden(run)
    return sorted((folder / name for name in NAMES), key=lambda file: -checkpoint_file.stated(file)["steps"])


def test_every_task_kind_of_agent_controller_and_belief(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "tests.execution.stopped_cells", tmp_path],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == f"{len(plan(load(tmp_path / 'stopped.yaml')))} cells\n", done.stdout + done.stderr


@pytest.mark.slow
def test_compiled_and_with_more_in_the_log_than_the_checkpoint_knows(tiny_run, tmp_path, monkeypatch):
    """As a kill leaves it: every second block has a checkpoint."""
    after_block, blocks = checkpoints.Checkpoints.after_block, []

    def every_second(self, standing):
        blocks.append(standing)
        if len(blocks) % 2:
            after_block(self, standing)

    monkeypatch.setattr(checkpoints.Checkpoints, "after_block", every_second)
    monkeypatch.setattr(checkpoints.Checkpoints, "interrupted", lambda self: None)
    played = "navigation/rmax", "go_to_human/mb", "social/mb/fast", "visit/fast"
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    for cell in [cell for cell in plan(load(TINY)) if cell.path.removesuffix("/seed-0000") in played]:
        stop, blocks[:] = cell.steps * 2 // 3, []
        assert went(whole, cell) == 0
        blocks[:] = []
        assert went(stopped, cell, stopping_after(stop)) is None
        begun = went(stopped, cell)
        assert 0 < begun < stop
        assert digests(stopped, cell) == digests(whole, cell)
        assert digests(stopped, cell)["model.npz"] == digests(tiny_run, cell)["model.npz"]


def test_what_is_not_recorded_goes_on_too(tmp_path, cell):
    (unrecorded,) = plan(load_text(CONFIG + "record: {steps: none}\n", "long.yaml"))
    assert went(tmp_path / "whole", unrecorded) == 0
    assert went(tmp_path / "run", unrecorded, stopping_after(1500)) is None
    assert went(tmp_path / "run", unrecorded) > 0
    assert digests(tmp_path / "run", unrecorded) == digests(tmp_path / "whole", unrecorded)


def test_a_short_cell_keeps_none_and_leaves_nothing(tmp_path, cell, monkeypatch):
    monkeypatch.setattr(checkpoints, "EVERY", 60.0)
    assert went(tmp_path / "run", cell, stopping_after(1500)) is None
    assert not list((tmp_path / "run").iterdir())
    assert not (tmp_path / "state").exists()


def cut(file):
    file.write_bytes(file.read_bytes()[:-1000])


def flip(file):
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def empty(file):
    file.write_bytes(b"")


def hostile(file):
    file.write_bytes(b"[" * 100_000 + b"\n" + b"\0" * 100)


DAMAGE = {"cut": cut, "flipped": flip, "empty": empty, "hostile": hostile, "gone": Path.unlink}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_one_gives_way_to_the_other_and_that_to_the_beginning(run, cell, expected, damage):
    newest, other = newest_first(run)
    steps = checkpoint_file.stated(other)["steps"]
    damage(newest)
    assert went(run, cell, stopping_after(steps + 1)) is None
    assert checkpoint_file.stated(newest_first(run)[1])["steps"] == steps, "from which it went on"
    for file in newest_first(run):
        damage(file)
    assert went(run, cell) == 0
    assert digests(run, cell) == expected
    assert not list(run.glob(".tmp-*"))


@pytest.mark.parametrize("damage", [flip, empty, Path.unlink])
def test_a_damaged_log_can_not_be_gone_on_with(run, cell, expected, damage):
    damage(hidden(run) / "steps.mcap")
    assert went(run, cell) == 0
    assert digests(run, cell) == expected


def other_versions(monkeypatch, tmp_path):
    others = {"versions": {"visitlab": "0.0"}}
    monkeypatch.setattr(checkpoints, "decided_by", lambda cell: {**decided_by(cell), **others})


def other_sources(monkeypatch, tmp_path):
    monkeypatch.setattr(checkpoints, "decided_by", lambda cell: {**decided_by(cell), "sources": "0" * 16})


def other_user(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "other"))
    assert key.own_key(make=True)


@pytest.mark.parametrize("change", [other_versions, other_sources, other_user])
def test_of_other_code_or_another_user_it_is_not_believed(run, cell, expected, tmp_path, monkeypatch, change):
    change(monkeypatch, tmp_path)
    assert went(run, cell) == 0
    assert digests(run, cell) == expected


def test_of_another_config_it_is_not_taken(run, tmp_path):
    (other,) = plan(load_text(CONFIG.replace("3000", "4000"), "long.yaml"))
    assert went(run, other) == 0


def test_where_no_secret_can_be_kept_there_are_no_checkpoints(tmp_path, cell, monkeypatch):
    (tmp_path / "state").mkdir()
    (tmp_path / "state").chmod(0o777)
    assert key.own_key(make=True) is None
    assert went(tmp_path / "run", cell, stopping_after(1500)) is None
    assert not list((tmp_path / "run").iterdir())


def test_a_secret_is_made_once_and_only_when_asked(tmp_path):
    assert key.own_key() is None
    made = key.own_key(make=True)
    assert made == key.own_key() == key.own_key(make=True)
    (file,) = (tmp_path / "state").rglob("key")
    assert file.stat().st_mode & 0o777 == 0o600
    file.write_bytes(b"short")
    assert key.own_key(make=True) is None


def test_two_runners_at_once(run, cell, expected):
    """The second finds the cell abandoned, or begins anew: in the end there is one, of the same bytes."""
    seen = []

    def and_another(steps):
        if not seen:
            seen.append(steps)
            assert went(run, cell) == 0, "the first one has taken over what there was"
            assert digests(run, cell) == expected

    assert went(run, cell, and_another) > 0
    assert digests(run, cell) == expected
    assert not list(run.glob(".tmp-*"))


def test_what_another_still_writes_is_not_taken(run, cell, tmp_path):
    folder = hidden(run)
    lock_of(folder).write_text(json.dumps({"machine": "elsewhere", "process": 1}))
    remove_leftovers(run)
    assert went(run, cell) == 0
    assert folder.exists()
    os.utime(lock_of(folder), (1, 1))
    remove_leftovers(run)
    assert not folder.exists()


def test_an_agent_in_plain_python_begins_anew(tmp_path):
    record = PlainQParameters(kind="plain_q").create(Setting("navigation", 4, 3, 100, seed=1, cell="a/b"))
    with pytest.raises(ElsewhereError):
        Memory([(1, record)])


def test_the_user_is_told_in_a_line(run, cell, capsys):
    told = []
    progress = Progress(quiet=True)
    progress.say = lambda line, style=None: told.append(line)
    remove_leftovers(run)
    assert run_cells(run, [cell], 1, progress) == {}
    assert told[0].startswith("navigation/mf/seed-0000: goes on from step 1,")
    assert told[0].endswith(" of 3,000")


def test_a_full_disk_leaves_what_can_be_gone_on_with(tmp_path, cell, expected, monkeypatch):
    run = tmp_path / "run"

    def full(self, *chunk):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("visitlab_cli.log.writer.CHUNK_STEPS", 2000)
    with monkeypatch.context() as patched, pytest.raises(RunError, match="No space left"):
        patched.setattr("visitlab_cli.log.mcap_file.McapFile.write_chunk", full)
        went(run, cell)
    assert went(run, cell) > 1000


def test_one_that_can_not_be_written_is_none_and_the_cell_goes_on(tmp_path, cell, expected, monkeypatch):
    def full(folder, name, content):
        (folder / checkpoint_file.UNFINISHED).write_bytes(b"")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(checkpoints, "write", full)
    assert went(tmp_path / "run", cell) == 0
    assert digests(tmp_path / "run", cell) == expected


def test_prune_and_rm_know_the_files(run):
    for name in ("config.yaml", "versions.json"):
        (run / name).write_text("{}")
    named = run.rename(run.with_name("long-01234567"))
    left = {path.name for path in named.glob(".tmp-*")}
    assert set(prune(named, dry_run=True).removed) == left
    remove_run(named)
    assert not named.exists()


PROGRAM = """
from visitlab_cli.execution import cell_runner, checkpoints
checkpoints.EVERY, checkpoints.SHARE = 0.05, float("inf")
from visitlab_cli.__main__ import main
main()
"""
LONG = """
name: killed
agents: {mb: {kind: model_based, plan_every: 400}}
experiments: {navigation: {task: navigation, agents: [mb], steps: 600000}}
"""


def test_kill_9_of_the_program(tmp_path, tiny_run):
    config = tmp_path / "killed.yaml"
    config.write_text(LONG)
    command = [sys.executable, "-c", PROGRAM, "run", str(config), "--out", str(tmp_path / "runs")]
    program = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while len(list(tmp_path.glob(f"runs/*/.tmp-*/{NAMES[1]}"))) == 0 and time.monotonic() < deadline:
        time.sleep(0.01)
    program.kill()
    program.communicate()
    run = the_run(tmp_path / "runs")
    assert not list(run.rglob("cell.json"))
    again = visitlab("run", config, "--out", tmp_path / "runs")
    assert again.returncode == 0, again.stderr
    assert "navigation/mb/seed-0000: goes on from step " in again.stderr
    assert not list(run.glob(".tmp-*"))
    assert visitlab("run", config, "--out", tmp_path / "whole").returncode == 0
    assert only_cells(hashes(run)) == only_cells(hashes(the_run(tmp_path / "whole")))
