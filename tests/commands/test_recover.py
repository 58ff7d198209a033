"""`visitlab recover` as a user meets it, and what the other commands say of a broken log."""

import json
import shutil

import pytest

from tests.log.blocks import random_steps, record
from tests.program import visitlab
from visitlab_cli.storage.cell_folder import is_temporary

CELL = "visit/fast/seed-0000"
TRIALS, TRIAL_STEPS = 4, 100


@pytest.fixture
def log(tiny_run, tmp_path):
    """A copy of a log of the tiny run, in a folder with a space in its name."""
    folder = tmp_path / "a folder"
    folder.mkdir()
    return shutil.copy(tiny_run / CELL / "steps.mcap", folder / "steps.mcap")


def cut(log, size):
    whole = log.read_bytes()
    log.write_bytes(whole[:size])
    return whole


def test_a_log_without_an_end_is_recovered_and_shown(log):
    whole = cut(log, -100)
    broken = visitlab("steps", log)
    assert broken.returncode == 4
    assert broken.stderr.count("\n") == 1
    assert broken.stderr.endswith(f"visitlab recover '{log}' saves what is whole\n")
    done = visitlab("recover", "steps.mcap", cwd=log.parent)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "steps.recovered.mcap: 400 steps, 4 whole trials\n"
    line = "steps.mcap was cut or damaged, but every record that is in it is whole and saved; it was not changed\n"
    assert done.stderr == line  # only the summary was cut
    assert (log.parent / "steps.recovered.mcap").read_bytes() == whole
    assert log.read_bytes() == whole[:-100]
    assert visitlab("steps", log.parent / "steps.recovered.mcap", "--trial", 3).returncode == 0


def test_json(log, tmp_path):
    cut(log, -1)
    done = visitlab("recover", log, "-o", tmp_path / "fixed.mcap", "--json")
    told = json.loads(done.stdout)
    lost = told.pop("lost_bytes")
    assert told == {
        "file": str(tmp_path / "fixed.mcap"),
        "steps": TRIALS * TRIAL_STEPS,
        "trials": TRIALS,
        "parts_of_trials": 0,
        "was_whole": False,
    }
    assert lost >= 0


def test_a_whole_log_is_copied(log):
    done = visitlab("recover", log)
    assert done.returncode == 0
    assert done.stderr == f"{log} was whole: this is a copy\n"


@pytest.mark.parametrize(
    ("output", "code", "message"),
    [
        ("steps.mcap", 2, "steps.mcap: is the file to recover; choose another with -o"),
        ("there.mcap", 2, "there.mcap: exists; choose another file with -o"),
        ("no/folder.mcap", 4, "no/folder.mcap: can't be written: No such file or directory"),
    ],
)
def test_what_is_refused_is_one_line_and_changes_nothing(log, output, code, message):
    (log.parent / "there.mcap").write_text("mine")
    before = {file.name: file.read_bytes() for file in log.parent.iterdir()}
    done = visitlab("recover", "steps.mcap", "-o", output, cwd=log.parent)
    assert (done.returncode, done.stdout, done.stderr) == (code, "", f"{message}\n")
    assert {file.name: file.read_bytes() for file in log.parent.iterdir()} == before


def test_nothing_to_save_and_nothing_there(log):
    cut(log, 40)
    done = visitlab("recover", log)
    assert done.returncode == 4
    assert done.stderr == f"{log}: nothing in it can be saved: what is whole of it is no log\n"
    assert not log.with_name("steps.recovered.mcap").exists()
    done = visitlab("recover", log.with_name("other.mcap"))
    assert (done.returncode, done.stderr) == (5, f"{log.with_name('other.mcap')}: no such file\n")


def test_a_log_in_a_hidden_folder_is_saved_beside_the_run_and_the_folder_stays_one(tiny_run, tmp_path):
    run = tmp_path / "runs" / tiny_run.name
    for place in (run, run / "evaluations" / "01234567"):
        hidden = place / ".tmp-visit-fast-seed-0001-89abcdef"
        hidden.mkdir(parents=True)
        cut(shutil.copy(tiny_run / CELL / "steps.mcap", hidden / "steps.mcap"), -100)
    shutil.copy(tiny_run / "config.yaml", run)
    saved = run.parent / "visit-fast-seed-0001-89abcdef.recovered.mcap"
    for where, log in ((run, ".tmp-visit-fast-seed-0001-89abcdef/steps.mcap"), (hidden, "steps.mcap")):
        done = visitlab("recover", log, cwd=where)
        assert (done.returncode, done.stdout) == (0, f"{saved}: 400 steps, 4 whole trials\n"), done.stderr
        assert is_temporary((where / log).parent)
        saved.unlink()


@pytest.mark.parametrize(("end", "words"), [(-8, "no step had been written to it"), (0, "it is empty")])
def test_a_log_to_which_no_step_was_written_says_so(tmp_path, end, words):
    columns, _ = random_steps(trials=1, trial_steps=2)
    log = record(tmp_path / "steps.mcap", "social", columns, rows=0)
    cut(log, end)
    done = visitlab("recover", log)
    assert (done.returncode, done.stdout) == (4, "")
    assert done.stderr == f"{log}: nothing in it can be saved: {words}\n"


@pytest.mark.parametrize("path", [".", "/", "folder"])
def test_what_is_no_file_is_one_line(tmp_path, path):
    (tmp_path / "folder").mkdir()
    done = visitlab("recover", path, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (4, "", f"{path}: cannot read the log: is no file\n")


def test_a_link_that_nobody_chose_is_not_followed(log, tmp_path):
    (log.parent / "steps.recovered.mcap").symlink_to(tmp_path / "outside")
    done = visitlab("recover", log)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert "steps.recovered.mcap: is a link" in done.stderr
    assert not (tmp_path / "outside").exists()
