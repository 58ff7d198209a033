"""`visitlab runs watch`: from the folder alone, once where nobody could watch, until the end where somebody can."""

import json
import os

import pytest

from tests.program import TINY, the_run, visitlab
from visitlab_cli.config.loading import load
from visitlab_cli.console import watching
from visitlab_cli.console.watching import text
from visitlab_cli.errors import Interrupted
from visitlab_cli.execution.versions import versions
from visitlab_cli.plan.cells import plan
from visitlab_cli.results.watching import Watch
from visitlab_cli.sources import sources
from visitlab_cli.storage import locks
from visitlab_cli.storage.cell_folder import NewCell
from visitlab_cli.storage.checkpoint_file import NAMES, write
from visitlab_cli.storage.claims import Claims, claim_file

CONFIG = "experiments={navigation: {task: navigation, agents: [mf, mb], steps: 2000}}"


@pytest.fixture
def run(tmp_path):
    """A run of four cells, of which two are done."""
    visitlab("run", TINY, CONFIG, "seeds=2", "--out", tmp_path, "--workers", 1, "--shard", "1/2")
    return the_run(tmp_path)


def test_it_tells_what_is_done_and_what_is_being_done(run, monkeypatch):
    monkeypatch.setattr(locks, "BEAT", 0.0)
    watch = Watch(run, config := load(run / "config.yaml"))
    paths = {cell.path for cell in plan(config)}
    todo = sorted(path for path in paths if not (run / path).exists())
    assert len(todo) == 2
    before = set(run.rglob("*"))
    look = watch.look()
    assert set(run.rglob("*")) == before
    assert (look.whole.cells, look.whole.done, look.whole.steps, look.whole.steps_done) == (4, 2, 8000, 4000)
    assert look.cells == []
    claims = Claims(run)
    claims.take(todo[0])
    with NewCell(run, todo[0]) as new:
        new.beat(1500)
        told = json.loads(visitlab("runs", "watch", run, "--json").stdout)
        (each,) = told["under_way"]
        assert 0 <= each.pop("seconds_silent") < 60
        assert each == {
            "cell": todo[0],
            "host": locks._machine().split(" ")[0],
            "process": os.getpid(),
            "steps": 2000,
            "steps_done": 1500,
        }
        assert told["steps_done"] == 5500
        assert {group["name"]: group["cells"] for group in told["groups"]} == {"navigation/mf": 2, "navigation/mb": 2}
        lines = visitlab("runs", "watch", run).stdout.splitlines()
    assert lines[:2] == [str(run), "2 of 4 cells, 1 under way, 69% of the steps"]
    assert [line.split()[0] for line in lines[2:4]] == ["navigation/mf", "navigation/mb"]
    assert lines[-1].split()[0] == todo[0]
    assert lines[-1].endswith(f"process {os.getpid()}  75%  1,500 of 2,000 steps")
    claims.close()
    assert watch.look().cells == []


def test_a_cell_that_was_left_counts_as_it_would_be_gone_on_from(run):
    config = load(run / "config.yaml")
    cell, other = [cell for cell in plan(config) if not (run / cell.path).exists()]
    ours = {"config_hash": cell.run_hash, "sources": sources(config.kinds), "versions": versions(config.kinds)}
    for each, facts in ((cell, ours), (other, ours | {"sources": "of another version"})):
        with pytest.raises(Interrupted), NewCell(run, each.path) as new:
            for name, steps in zip(NAMES, (1200, 900), strict=True):
                write(new.folder, name, json.dumps(facts | {"cell": each.path, "steps": steps}).encode() + b"\n")
            raise Interrupted("stopped")
    told = json.loads(visitlab("runs", "watch", run, "--json").stdout)
    assert (told["steps_done"], told["under_way"]) == (5200, [])
    assert told["left"] == [{"cell": cell.path, "steps": 2000, "steps_done": 1200}]
    lines = visitlab("runs", "watch", run).stdout.splitlines()
    assert lines[1] == "2 of 4 cells, 0 under way, 1 to go on with, 65% of the steps"
    assert lines[-1] == f"{cell.path}  nobody now, to be gone on with  60%  1,200 of 2,000 steps"
    claims = Claims(run)  # who goes on has told no steps yet
    claims.take(cell.path)
    (each,) = Watch(run, config).look().as_json()["under_way"]
    assert each["steps_done"] == 1200
    claims.close()


def test_who_is_long_silent_is_told(run):
    (cell, *_) = [cell for cell in plan(load(run / "config.yaml")) if not (run / cell.path).exists()]
    told = {"machine": "node7\x1b[2J boot pid", "process": 4321, "started": "1", "cell": cell.path}
    file = claim_file(run, cell.path)
    file.write_text(json.dumps(told))
    os.utime(file, (file.stat().st_mtime - 600,) * 2)
    last = visitlab("runs", "watch", run, "--once").stdout.splitlines()[-1]
    assert r"node7\x1b[2J process 4321, no sign of life for 10 min" in last


def test_many_groups_and_cells_fit_the_screen(run):
    look = Watch(run, load(run / "config.yaml")).look()
    part = look.whole
    many = look._replace(groups={f"group-{number}": part for number in range(100)})
    lines = text(many, 90.0, 24).splitlines()
    assert len(lines) <= 24
    assert lines[1].endswith("about 90 s left")
    assert lines[-1] == "... and 80 more groups"
    assert len(text(many).splitlines()) == 102


def test_on_a_terminal_it_ends_when_the_run_is_done(run, monkeypatch, capsys):
    looks = []

    class Looking(Watch):
        def look(self):
            looks.append(1)
            if len(looks) == 3:
                visitlab("run", run / "config.yaml", "--out", run.parent, "--workers", 1)
            return super().look()

    monkeypatch.setattr(watching, "SECONDS_BETWEEN", 0.01)
    watching.follow(Looking(run, load(run / "config.yaml")))
    assert len(looks) == 3
    assert "4 of 4 cells, 0 under way, 100% of the steps" in capsys.readouterr().out


def test_what_is_no_run_is_one_line(tmp_path):
    done = visitlab("runs", "watch", "nothing", "--out", tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (5, 1)
