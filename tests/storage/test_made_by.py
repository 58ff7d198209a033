"""Which code made a cell: stated, told where it is another, and never taken for granted."""

import json
import shutil

import pytest

import visitlab_cli
from tests.program import TINY, copy_package, hashes, the_run, visitlab
from visitlab_cli.report.making import gather
from visitlab_cli.report.page import render
from visitlab_cli.sources import PACKAGE, sources
from visitlab_cli.storage.cell_folder import SOURCES, read_cell, to_json
from visitlab_cli.storage.verify import verify
from visitlab_cli.storage.verify_cell import cell_faults
from visitlab_cli.storage.verify_notes import notes

NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf, mb], steps: 200}}"
UNCOMPILED = {"NUMBA_DISABLE_JIT": "1"}
CELL = "navigation/mf/seed-0000"


@pytest.fixture
def edited(tmp_path):
    """The environment in which the program is one with an edited rule."""
    clone = tmp_path / "clone" / "visitlab_cli"
    copy_package(clone)
    shutil.copytree(PACKAGE.parent / "configs", clone / "shipped_configs")
    file = clone / "world" / "navigation.py"
    text = file.read_text()
    assert text.count("reward = 1.0 if") == 1
    file.write_text(text.replace("reward = 1.0 if", "reward = 2.0 if"))
    return UNCOMPILED | {"PYTHONPATH": str(clone.parent)}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A run of two cells."""
    out = tmp_path_factory.mktemp("runs")
    done = visitlab("run", TINY, NAVIGATION, "--out", out, env=UNCOMPILED)
    assert done.returncode == 0
    assert "other code" not in done.stderr
    return the_run(out)


@pytest.fixture
def run(made, tmp_path):
    """A copy of it."""
    return shutil.copytree(made, tmp_path / "runs" / made.name)


def test_a_run_that_other_code_goes_on_with_is_told_by_all_that_read_it(run, edited):
    done = visitlab("run", TINY, NAVIGATION, "seeds=2", "--out", run.parent, "--quiet", cwd=run.parent, env=edited)
    assert done.returncode == 0
    cells = visitlab_cli.load(run).cells
    (theirs,) = {cell.sources for cell in cells} - {sources()}
    made = f"2 cells made by other code ({sources()}; this program is {theirs})"
    (line,) = done.stderr.splitlines()
    assert line == f"{run}: {made}; what is missing is made by this one; another --out begins a run of its own"
    (note,) = notes(run, [cell.path for cell in cells], None)
    assert note.startswith("made by different code: 2 cells by ")
    assert note in visitlab("compare", run, "--by", "agent", env=UNCOMPILED).stdout.replace(f"{run.name}/", "")
    shown = visitlab("runs", "show", run, "--json", env=UNCOMPILED)
    assert note in shown.stderr
    assert json.loads(shown.stdout)["results"][0]["sources"] == sorted([sources(), theirs])
    assert "made by different code" in render(*gather(run))
    assert set(visitlab_cli.load(run).results()["sources"]) == {" and ".join(sorted([sources(), theirs]))}


def test_a_cell_from_before_is_whole_and_unknown(run):
    for file in run.rglob("cell.json"):
        facts = json.loads(file.read_text())
        del facts[SOURCES]
        file.write_text(to_json(facts))
    assert verify(run, {}, {}).faults == []
    assert list(notes(run, [CELL], None)) == []
    before = hashes(run)
    again = visitlab("run", TINY, NAVIGATION, "--out", run.parent, env=UNCOMPILED)
    assert f"2 cells made by other code (unknown; this program is {sources()}); nothing is made anew" in again.stderr
    assert hashes(run) == before
    assert {cell.sources for cell in visitlab_cli.load(run).cells} == {"unknown"}


@pytest.mark.parametrize("wrong", ["", "0" * 16, sources()[:-1], 7, None, [sources()]])
def test_sources_that_can_be_none_are_damage(run, wrong):
    file = run / CELL / "cell.json"
    file.write_text(to_json({**json.loads(file.read_text()), SOURCES: wrong}))
    assert read_cell(run / CELL) is None
    assert cell_faults(run / CELL, CELL, None, None) == [("cell.json", "damaged: sources is no hash of sources")]
