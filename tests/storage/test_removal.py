"""Nothing is removed but what is no use, or the run that was named; never through a link."""

import os
import shutil
import time

import pytest
from matplotlib.figure import Figure

from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.figures.making import NAMES
from visitlab_cli.origin import HTML
from visitlab_cli.pictures.style import FORMATS, save
from visitlab_cli.storage.cell_folder import NewCell
from visitlab_cli.storage.leftovers import YOUNG, remove_leftovers
from visitlab_cli.storage.locks import being_written
from visitlab_cli.storage.removal import foreign_files, prune, remove_run

RUN = "lab-01234567"
SVG = '<?xml version="1.0"?>\n<svg><dc:title>visitlab</dc:title></svg>'
CELL = "navigation/mf/seed-0000"
FACTS = {
    "cell": CELL,
    "seed": 0,
    "steps": 1,
    "trials": 1,
    "config_hash": "01234567",
    "versions": {},
    "mean_reward_last_hundredth": 0.0,
    "mean_reward_last_tenth": 0.0,
}


@pytest.fixture
def run(tmp_path):
    """A run with one whole cell, and beside it something precious."""
    folder = tmp_path / "runs" / RUN
    folder.mkdir(parents=True)
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "data").write_text("x")
    for name in ("config.yaml", "versions.json"):
        (folder / name).write_text("{}")
    write(folder, CELL)
    return folder


def write(run, path):
    with NewCell(run, path) as new:
        (new.folder / "model.npz").write_text("data")
        new.commit(FACTS, {})


def names(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if not path.is_dir())


def test_prune_removes_leftovers_and_damaged_cells_only(run):
    whole = names(run)
    for damaged in ("navigation/mf/seed-0001", "evaluations/01234567/visit/fast/model-0000/seed-0002"):
        write(run, damaged)
        (run / damaged / "cell.json").rename(run / damaged / "cell.json.damaged")
    (run / ".tmp-navigation-mf-seed-0001-01234567").mkdir()
    (run / ".tmp-navigation-mf-seed-0001-01234567" / "steps.mcap").touch()
    os.utime(run / ".tmp-navigation-mf-seed-0001-01234567", (1, 1))
    (run / ".tmp-01234567-config.yaml").touch()
    os.utime(run / ".tmp-01234567-config.yaml", (1, 1))
    (run / "versions.json.damaged").touch()
    everything = names(run)
    told = prune(run, dry_run=True)
    assert names(run) == everything
    assert prune(run) == told
    assert set(told.removed) == {
        ".tmp-navigation-mf-seed-0001-01234567",
        ".tmp-01234567-config.yaml",
        "versions.json.damaged",
        "navigation/mf/seed-0001",
        "evaluations/01234567/visit/fast/model-0000/seed-0002",
    }
    assert told.kept == {}
    assert names(run) == whole


def test_prune_keeps_what_only_ends_like_something_that_was_set_aside(run):
    (run / "robot.damaged").touch()
    (run / "thesis.damaged").mkdir()
    (run / "thesis.damaged" / "cell.json").touch()
    (run / "config.yaml.damaged").symlink_to(run.parent.parent / "precious" / "data")
    everything = names(run)
    assert prune(run).removed == []
    assert names(run) == everything


@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("name", [*NAMES, "matrix", "matrix-visit.on-2"])
def test_every_picture_that_is_drawn_into_a_run_is_known_as_ours(run, name, kind):
    save(Figure(), run / "figures" / f"{name}.{kind}")
    assert list(foreign_files(run)) == []


def test_prune_keeps_what_is_being_written_and_what_is_not_ours(run):
    (run / ".tmp-01234567-config.yaml").touch()
    mine = run / "navigation" / "mf" / "seed-0001"
    mine.mkdir()
    for name in ("model.npz", "steps.recovered.mcap"):
        (mine / name).touch()
    with NewCell(run, "navigation/mf/seed-0002") as new:
        told = prune(run)
        assert new.folder.exists()
        assert told.removed == []
        assert told.kept == {
            new.folder.name: "is being written",
            f"{new.folder.name}.lock": "is being written",
            ".tmp-01234567-config.yaml": "is being written",
            "navigation/mf/seed-0001": "holds steps.recovered.mcap, which is not visitlab's",
        }
        with pytest.raises(RunError, match="is being written"):
            remove_run(run)
    assert (mine / "model.npz").exists()


@pytest.mark.parametrize("place", [".", "figures", "evaluations/told"])
def test_what_was_being_written_in_a_run_that_is_gone_on_with_goes_once_it_is_old(run, place):
    (run / place).mkdir(parents=True, exist_ok=True)
    young, old = (run / place / f".tmp-0123456{digit}-config.yaml" for digit in "78")
    for file, age in ((young, YOUNG / 2), (old, YOUNG + 1)):
        file.touch()
        os.utime(file, (time.time() - age,) * 2)
    remove_leftovers(run)
    assert (young.exists(), old.exists()) == (True, False)
    prune(run)
    assert young.exists()


@pytest.mark.parametrize("place", [".tmp-mine/data", ".tmp-mine-01234567/data", ".tmp-data", ".tmp-mine-01234567"])
def test_what_only_looks_temporary_is_left_by_all_that_clear_up(run, place):
    foreign(place)(run)
    for path in (run / place, run / place.split("/")[0]):
        os.utime(path, (1, 1))
    everything = names(run)
    remove_leftovers(run)
    told = prune(run)
    assert (told.removed, told.kept) == ([], {})
    assert names(run) == everything


def test_links_are_removed_and_never_followed(run, tmp_path):
    precious = tmp_path / "precious"
    (run / ".tmp-link-01234567").symlink_to(precious)
    os.utime(run / ".tmp-link-01234567", (1, 1), follow_symlinks=False)
    (run / "social").symlink_to(precious)
    (run / "notes").symlink_to(precious / "data")
    (run / CELL / "steps.mcap").symlink_to(precious / "data")
    assert prune(run).removed == []
    remove_run(run)
    assert not run.exists()
    assert (precious / "data").read_text() == "x"


def test_a_run_with_all_that_visitlab_writes_is_removed(run, tmp_path):
    (run / "figures").mkdir()
    (run / "figures" / "fig6.svg").write_text(SVG)
    (run / "report.html").write_bytes(HTML.encode() + b"<html>")
    (run / ".lock").touch()
    (run / ".tmp-left-01234567").mkdir()
    os.utime(run / ".tmp-left-01234567", (1, 1))
    (run / "evaluations" / "01234567").mkdir(parents=True)
    (run / "evaluations" / "01234567" / "matrix.svg").write_text(SVG)
    for folder in (run, run / "figures", run / "evaluations" / "01234567"):  # of a process that was killed
        (folder / ".tmp-01234567-fig6.svg").touch()
    remove_run(run)
    assert names(tmp_path) == ["precious/data"]


def remove_versions(run):
    (run / "versions.json").unlink()
    return run


def link_to(run):
    link = run.with_name("link-01234567")
    link.symlink_to(run)
    return link


def foreign(path):
    def add(run):
        (run / path).parent.mkdir(parents=True, exist_ok=True)
        (run / path).touch()
        return run

    return add


REFUSED = {
    "no versions": (remove_versions, NotFoundError, "not a run"),
    "another name": (lambda run: run.rename(run.with_name("project")), NotFoundError, "not a run"),
    "a link": (link_to, UsageError, "a link to .*lab-01234567; remove that"),
    "a file of mine": (foreign("notes.txt"), RunError, "holds notes.txt, which is not visitlab's"),
    "a folder of mine": (foreign("thesis/chapter.tex"), RunError, "holds thesis/chapter.tex"),
    "mine in a cell": (foreign(f"{CELL}/notes.txt"), RunError, f"holds {CELL}/notes.txt"),
    "a picture of mine": (foreign("figures/mine.svg"), RunError, "holds figures/mine.svg"),
    "a drawing of mine, called as one of yours": (foreign("figures/fig6.svg"), RunError, "holds figures/fig6.svg"),
    "a matrix of mine": (foreign("evaluations/01234567/matrix.svg"), RunError, "holds evaluations/01234567/matrix.svg"),
    "a temporary folder of mine": (foreign(".tmp-mine/data"), RunError, "holds .tmp-mine/data"),
    "mine, called as one of yours": (foreign(".tmp-mine-01234567/data"), RunError, "holds .tmp-mine-01234567/data"),
    "a temporary file of mine": (foreign(".tmp-data"), RunError, "holds .tmp-data"),
    "a temporary file in a cell": (foreign(f"{CELL}/.tmp-01234567-a"), RunError, f"holds {CELL}/.tmp-01234567-a"),
    "a page of mine": (foreign("report.html"), RunError, "holds report.html"),
    "a model of mine": (foreign("navigation/model.npz"), RunError, "holds navigation/model.npz"),
}


@pytest.mark.parametrize(("change", "error", "line"), REFUSED.values(), ids=REFUSED)
def test_what_is_not_only_a_run_is_refused(run, change, error, line, tmp_path):
    folder = change(run)
    before = names(tmp_path)
    with pytest.raises(error, match=line):
        remove_run(folder)
    assert names(tmp_path) == before


def test_what_cannot_be_removed_is_one_line_and_still_a_run(run, monkeypatch):
    def refuse(path):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(shutil, "rmtree", refuse)
    with pytest.raises(RunError, match="navigation: can't be removed: Permission denied$"):
        remove_run(run)
    assert (run / "config.yaml").exists()


@pytest.mark.parametrize("remove", [remove_run, prune])
def test_a_run_that_somebody_writes_in_is_not_touched_even_between_two_cells(run, remove):
    before = names(run)
    with being_written(run), being_written(run):
        with pytest.raises(RunError, match="is being written; stop that first"):
            remove(run)
        assert set(before) <= set(names(run))
    assert names(run) == before
    remove(run)
