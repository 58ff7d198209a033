"""What `verify` says where two things contradict each other: which of them is wrong; and what it only notes."""

import json
import shutil

import pytest

from tests.results.runs_by_hand import VERSIONS, open_lab, reach
from visitlab_cli.storage.cell_folder import to_json
from visitlab_cli.storage.run_folder import open_run, read_config, read_versions
from visitlab_cli.storage.verify import set_faults_aside, verify
from visitlab_cli.storage.verify_notes import notes

CELLS = [f"navigation/mb/seed-000{seed}" for seed in range(3)]
NEWER = {"visitlab": "1", "python": "3"}


@pytest.fixture
def run(tmp_path):
    """A run by hand with three finished cells."""
    run, cells = open_lab(tmp_path)
    reach(run, cells, dict.fromkeys(CELLS, 1))
    return run


def faults(run, versions=NEWER):
    return [str(fault) for fault in verify(run, {}, versions).faults]


def edit(file, old, new):
    text = file.read_text()
    assert text.count(old) >= 1
    file.write_text(text.replace(old, new, 1))


def test_versions_that_fit_no_cell(run):
    edit(run / "versions.json", '"3"', '"4"')
    assert faults(run) == ['versions.json: fits no cell: python is "4", not "3"']
    assert verify(run, {}, {}).whole == CELLS


def test_versions_of_a_run_that_fit_no_cell_are_written_again_as_the_cells_say(run):
    edit(run / "versions.json", '"3"', '"4"')
    set_faults_aside(run, verify(run, {}, NEWER).faults)
    open_run(run.parent, read_config(run), NEWER)
    assert read_versions(run) == VERSIONS
    assert faults(run) == []


def test_a_single_cell_with_other_versions_than_run_and_program_is_what_is_wrong(run):
    for path in CELLS[1:]:
        shutil.rmtree(run / path)
    edit(run / CELLS[0] / "cell.json", '"python": "3"', '"python": "4"')
    assert faults(run) == [
        f"{CELLS[0]}/cell.json: has versions that neither the run, nor another cell, nor this program has"
    ]


def test_a_run_without_a_finished_cell_begins_with_the_program_that_goes_on(run):
    for path in CELLS:
        shutil.rmtree(run / path)
    open_run(run.parent, read_config(run), NEWER)
    assert read_versions(run) == NEWER


def test_versions_stay_where_only_the_config_is_missing(run):
    config = read_config(run)
    (run / "config.yaml").unlink()
    open_run(run.parent, config, NEWER)
    assert read_versions(run) == VERSIONS
    assert faults(run) == []


@pytest.mark.parametrize("digits", [1, 16])
def test_digits_of_a_hash_that_changed_are_the_fault_of_cell_json(run, digits):
    file = run / CELLS[0] / "cell.json"
    cell = json.loads(file.read_text())
    digest = cell["files"]["model.npz"]["sha256"]
    cell["files"]["model.npz"]["sha256"] = digest[:-digits] + "x" * digits
    file.write_text(to_json(cell))
    assert faults(run) == [f"{file.parent.relative_to(run)}/cell.json: {stated('model.npz', digits)}"]


def stated(name, digits):
    return f"the sha256 that it states of {name} is damaged, in {digits} of 64 digits"


def test_another_file_has_another_hash_nearly_everywhere(run):
    model = run / CELLS[0] / "model.npz"
    model.write_bytes(model.read_bytes()[:-1] + b"x")
    (fault,) = faults(run)
    assert fault.startswith(f"{CELLS[0]}/model.npz: its sha256 is ")


def test_a_plan_that_is_in_doubt_faults_no_cell(run):
    edit(run / "config.yaml", "steps: 400", "steps: 500")
    found = verify(run, {path: 500 for path in CELLS}, NEWER)
    assert [fault.file for fault in found.faults] == ["config.yaml"]
    assert found.whole == CELLS


def told(run, planned=CELLS):
    return list(notes(run, CELLS, planned))


def test_of_a_run_as_it_was_written_there_is_nothing_to_note(tiny_run, run):
    assert told(run) == told(run, None) == []
    assert list(notes(tiny_run, [], None)) == []


def test_cells_that_are_not_in_the_plan_are_noted(run):
    assert told(run, CELLS[:2]) == [f"not in the plan of the run's config (has it less seeds than before?): {CELLS[2]}"]
    assert told(run, None) == []


@pytest.mark.parametrize("damage", [lambda file: file.unlink(), lambda file: file.write_bytes(b'{"seconds"\xff 2}')])
def test_a_timing_that_cannot_be_read_is_noted(run, damage):
    damage(run / CELLS[0] / "timing.json")
    assert told(run) == [f"missing or damaged, which changes no result: {CELLS[0]}/timing.json"]


def test_files_of_the_users_are_noted(run):
    (run / "figures").mkdir()
    (run / "evaluations/01234567/visit/fast/seed-0000").mkdir(parents=True)
    ours = ["figures/fig6.svg", "evaluations/01234567/evaluation.json"]
    ours += ["evaluations/01234567/visit/fast/seed-0000/model.npz"]
    theirs = ["ideas.md", f"{CELLS[0]}/notes.txt", "evaluations/notes.txt"]
    theirs += ["evaluations/01234567/visit/fast/seed-0000/notes.txt", "figures/mine.svg", "report.html"]
    for name in ours + theirs:
        (run / name).touch()
    (run / "figures/fig6.svg").write_text("<?xml ?><dc:title>visitlab</dc:title>")
    (note,) = told(run)
    assert note.startswith("not visitlab's: ideas.md, ")
    assert note.endswith(" and 3 more")
    for name in theirs[:1] + theirs[2:]:
        (run / name).unlink()
    assert told(run) == [f"not visitlab's: {CELLS[0]}/notes.txt"]
