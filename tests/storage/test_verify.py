"""`verify` names whatever is not as it was written, and sets it aside."""

import json
import os
import shutil

import pytest

from visitlab_cli.config.loading import load
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage import verify as room
from visitlab_cli.storage.cell_folder import read_cell, to_json
from visitlab_cli.storage.verify import set_faults_aside, verify
from visitlab_cli.storage.verify_cell import cell_faults

CELL = "visit/fast/seed-0000"
OTHER = "navigation/mf/seed-0000"


@pytest.fixture
def run(tiny_run, tmp_path):
    """A copy of the tiny run that a test may change."""
    return shutil.copytree(tiny_run, tmp_path / tiny_run.name)


def check(run):
    cells = {cell.path: cell.steps for cell in plan(load(run / "config.yaml"))}
    return verify(run, cells, {})


def faults(run):
    return {(fault.cell, fault.file) for fault in check(run).faults}


def flip(file):
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


DAMAGE = {
    "flipped": flip,
    "cut": lambda file: os.truncate(file, file.stat().st_size - 1),
    "longer": lambda file: file.write_bytes(file.read_bytes() + b"\n"),
    "emptied": lambda file: file.write_bytes(b""),
    "deleted": lambda file: file.unlink(),
}


def test_a_whole_run_has_no_faults(tiny_run):
    found = check(tiny_run)
    assert found.faults == []
    assert found.whole == found.found == sorted(cell.path for cell in plan(load(tiny_run / "config.yaml")))


@pytest.mark.parametrize("name", ["steps.mcap", "trials.parquet", "model.npz", "cell.json"])
@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_damage_is_named_and_then_counts_as_missing(run, name, damage):
    damage(run / CELL / name)
    assert faults(run) == {(CELL, name)}
    assert set_faults_aside(run, check(run).faults) == {}
    assert read_cell(run / CELL) is None
    assert read_cell(run / OTHER) is not None
    assert faults(run) == {(CELL, "cell.json")}
    assert len(check(run).whole) == 16


def test_every_part_of_a_cell_json_counts(run):
    file = run / CELL / "cell.json"
    whole = file.read_bytes()
    versions = whole.index(b'"versions"')
    for place in range(0, len(whole), 2):
        content = bytearray(whole)
        content[place] ^= 1 << place // 2 % 7
        file.write_bytes(content)
        if place < versions:
            digest = run.name.rpartition("-")[2]
            assert cell_faults(run / CELL, CELL, digest, 400), content[max(0, place - 20) : place + 20]
        elif place % 20 == 0:
            assert faults(run) == {(CELL, "cell.json")}, content[place - 20 : place + 20]


LIES = {
    "seed": 1,
    "steps": 401,
    "trials": 5,
    "cell": OTHER,
    "config_hash": "00000000",
    "mean_reward_last_tenth": 9.0,
    "mean_reward_last_hundredth": 9.0,
    "format": 2,
    "versions": {"visitlab": 1},
    "files": {},
}


@pytest.mark.parametrize("key", LIES)
@pytest.mark.parametrize("missing", [False, True])
def test_a_cell_json_that_lies_is_seen(run, key, missing):
    file = run / CELL / "cell.json"
    cell = json.loads(file.read_text())
    cell = {name: value for name, value in cell.items() if name != key} if missing else cell | {key: LIES[key]}
    file.write_text(to_json(cell))
    assert faults(run) == {(CELL, "cell.json")}


def test_files_outside_of_the_cell_are_not_looked_at(run):
    file = run / CELL / "cell.json"
    cell = json.loads(file.read_text())
    cell["files"]["../../../config.yaml"] = cell["files"]["model.npz"]
    file.write_text(to_json(cell))
    (fault,) = check(run).faults
    assert "lists a file '../../../config.yaml', which no cell has" in str(fault)


def test_an_edited_config_is_the_runs_fault_not_the_cells(run):
    config = run / "config.yaml"
    config.write_text(config.read_text().replace("alpha: 0.5", "alpha: 0.25", 1))
    found = check(run)
    assert [(fault.cell, fault.file) for fault in found.faults] == [("", "config.yaml")]
    set_faults_aside(run, found.faults)
    assert config.exists()
    renamed = run.rename(run.with_name("best"))
    assert faults(renamed) == {("", "config.yaml")}


def test_a_run_may_be_renamed(run):
    renamed = run.rename(run.with_name("the best one"))
    assert check(renamed).faults == []
    cell = json.loads((renamed / CELL / "cell.json").read_text())
    (renamed / CELL / "cell.json").write_text(to_json(cell | {"config_hash": "0" * 8}))
    assert faults(renamed) == {(CELL, "cell.json")}


def test_unreadable_configs_and_versions(run):
    (run / "config.yaml").write_text("[")
    (run / "versions.json").write_text("[")
    found = verify(run, {}, {})
    assert {(fault.cell, fault.file) for fault in found.faults} == {("", "config.yaml"), ("", "versions.json")}
    assert len(found.whole) == 17
    set_faults_aside(run, found.faults)
    assert not (run / "versions.json").exists()


def test_cells_of_another_program_are_whole(run):
    for path in (CELL, OTHER):
        cell = json.loads((run / path / "cell.json").read_text())
        (run / path / "cell.json").write_text(to_json(cell | {"versions": {"visitlab": "0.0.9"}}))
    assert faults(run) == set()
    cell = json.loads((run / CELL / "cell.json").read_text())
    (run / CELL / "cell.json").write_text(to_json(cell | {"versions": {"visitlab": "0.0.8"}}))
    assert faults(run) == {(CELL, "cell.json"), (OTHER, "cell.json")}
    assert verify(run, {}, {"visitlab": "0.0.8"}).whole.count(CELL) == 1


def test_folders_of_people_called_like_cells_are_none(run):
    (run / "social" / "mb" / "seed-0001").mkdir()
    (run / "social" / "mb" / "seed-0001" / "notes.txt").touch()
    assert check(run).faults == []


def test_what_cannot_be_set_aside_is_said(run, monkeypatch):
    def refuse(file):
        raise PermissionError(13, "Permission denied")

    flip(run / CELL / "model.npz")
    monkeypatch.setattr(room, "set_aside", refuse)
    assert set_faults_aside(run, check(run).faults) == {f"{run}/{CELL}/cell.json": "Permission denied"}
