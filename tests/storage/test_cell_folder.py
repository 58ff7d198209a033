"""A cell appears whole or not at all."""

import json
import os
import subprocess
import sys

import pytest

from visitlab_cli.errors import RunError
from visitlab_cli.storage.cell_folder import NewCell, describe, lock_of, read_cell
from visitlab_cli.storage.leftovers import remove_leftovers

FACTS = {
    "cell": "a/b/seed-0000",
    "seed": 0,
    "steps": 1,
    "trials": 1,
    "mean_reward_last_hundredth": 0.5,
    "mean_reward_last_tenth": 0,
    "config_hash": "00000000",
    "versions": {},
}
TIMING = {"seconds": 2}


def write(run, path="a/b/seed-0000", text="data"):
    with NewCell(run, path) as new:
        (new.folder / "model.npz").write_text(text)
        new.commit(FACTS, TIMING)


def names(run):
    return sorted(path.relative_to(run).as_posix() for path in run.rglob("*") if path.is_file())


def test_committed_it_is_there_and_says_what_it_holds(tmp_path):
    write(tmp_path)
    assert names(tmp_path) == [f"a/b/seed-0000/{name}" for name in ("cell.json", "model.npz", "timing.json")]
    cell = read_cell(tmp_path / "a/b/seed-0000")
    assert cell["steps"] == 1
    assert cell["files"] == {
        "model.npz": {
            "size": 4,
            "sha256": "3a6eb0790f39ac87c94f3856b2dd2c5d110e6811602261a9a923d3bb23adc8b7",
        }
    }


def test_what_is_described_as_it_was_written_is_not_read_again(tmp_path):
    described = {"size": 4, "sha256": "0" * 64}
    with NewCell(tmp_path, "a/b/seed-0000") as new:
        for name in ("model.npz", "steps.mcap"):
            (new.folder / name).write_text("data")
        new.commit(FACTS, TIMING, {"steps.mcap": described})
    files = read_cell(tmp_path / "a/b/seed-0000")["files"]
    assert files["steps.mcap"] == described
    assert files["model.npz"] == describe(tmp_path / "a/b/seed-0000/model.npz")


def test_an_exception_leaves_nothing(tmp_path):
    with pytest.raises(ValueError, match="midway"), NewCell(tmp_path, "a/b") as new:
        (new.folder / "model.npz").write_text("data")
        raise ValueError("midway")
    assert list(tmp_path.iterdir()) == []


def test_an_os_error_is_one_clear_line(tmp_path):
    with pytest.raises(RunError) as caught, NewCell(tmp_path, "a/b"):
        raise OSError(28, "No space left on device")
    assert str(caught.value) == f"{tmp_path}/a/b: can't be written: No space left on device"
    assert list(tmp_path.iterdir()) == []


def test_the_first_to_finish_wins(tmp_path):
    with NewCell(tmp_path, "a/b/seed-0000") as late:
        (late.folder / "model.npz").write_text("late")
        write(tmp_path, text="first")
        late.commit(FACTS, TIMING)
    assert (tmp_path / "a/b/seed-0000/model.npz").read_text() == "first"
    assert len(names(tmp_path)) == 3


def cut(file):
    file.write_bytes(file.read_bytes()[:-1])


def without_a_fact(cell):
    facts = json.loads((cell / "cell.json").read_text())
    facts["mean_reward_last_tenth"] = "high"
    (cell / "cell.json").write_text(json.dumps(facts))


DAMAGE = {
    "a fact of another type": without_a_fact,
    "too deep": lambda cell: (cell / "cell.json").write_text("[" * 100_000),
    "no cell.json": lambda cell: (cell / "cell.json").unlink(),
    "cell.json cut": lambda cell: (cell / "cell.json").write_text('{"format": 1, "fi'),
    "cell.json empty": lambda cell: (cell / "cell.json").write_text(""),
    "cell.json a list": lambda cell: (cell / "cell.json").write_text("[]"),
    "another format": lambda cell: (cell / "cell.json").write_text('{"format": 99, "files": {}}'),
    "files not a map": lambda cell: (cell / "cell.json").write_text('{"format": 1, "files": 3}'),
    "a file cut": lambda cell: cut(cell / "model.npz"),
    "a file gone": lambda cell: (cell / "model.npz").unlink(),
}


@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_cell_is_not_done_and_is_replaced(tmp_path, damage):
    write(tmp_path)
    cell = tmp_path / "a/b/seed-0000"
    damage(cell)
    assert read_cell(cell) is None
    write(tmp_path, text="again")
    assert (cell / "model.npz").read_text() == "again"
    assert read_cell(cell) is not None


def test_files_of_the_users_stay_in_a_cell_that_is_replaced(tmp_path):
    write(tmp_path)
    cell = tmp_path / "a/b/seed-0000"
    cut(cell / "model.npz")
    (cell / "notes.txt").write_text("mine")
    (cell / "plots").mkdir()
    (cell / "plots" / "one.svg").write_text("mine, too")
    (cell / "steps.mcap").write_text("of the damaged cell")
    (cell / "cell.json").rename(cell / "cell.json.damaged")
    write(tmp_path, text="again")
    assert read_cell(cell) is not None
    kept = {name: (cell / name).read_text() for name in ("model.npz", "notes.txt", "plots/one.svg")}
    assert kept == {"model.npz": "again", "notes.txt": "mine", "plots/one.svg": "mine, too"}
    assert sorted(os.listdir(cell)) == ["cell.json", "model.npz", "notes.txt", "plots", "timing.json"]
    assert os.listdir(tmp_path) == ["a"]


def test_a_cell_that_is_replaced_is_whole_at_the_end_only(tmp_path, monkeypatch):
    write(tmp_path)
    cell = tmp_path / "a/b/seed-0000"
    cut(cell / "model.npz")
    seen = []
    replace = os.replace
    monkeypatch.setattr(os, "replace", lambda *files: (seen.append(read_cell(cell)), replace(*files)))
    write(tmp_path)
    assert seen == [None] * 3
    assert read_cell(cell) is not None


def test_what_the_dead_left_is_removed_and_what_the_living_write_is_not(tmp_path):
    program = (
        "import os, pathlib, sys\n"
        "from visitlab_cli.storage.cell_folder import NewCell\n"
        "NewCell(pathlib.Path(sys.argv[1]), 'dead').__enter__()\n"
        "os._exit(9)\n"
    )
    subprocess.run([sys.executable, "-c", program, str(tmp_path)], check=False, env=os.environ)
    assert len(list(tmp_path.glob(".tmp-dead-*"))) == 2  # the folder and its lock file
    with NewCell(tmp_path, "alive") as new:
        remove_leftovers(tmp_path)
        assert set(tmp_path.iterdir()) == {new.folder, lock_of(new.folder)}
    assert list(tmp_path.iterdir()) == []


def test_the_same_facts_are_the_same_text(tmp_path):
    write(tmp_path / "one")
    write(tmp_path / "two")
    cells = [(tmp_path / run / "a/b/seed-0000/cell.json").read_bytes() for run in ("one", "two")]
    assert cells[0] == cells[1]
    assert json.loads(cells[0])["format"] == 1
