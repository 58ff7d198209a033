"""Nothing is written through a link, whatever it stands in the place of, and nobody waits on a pipe."""

import os
import shutil

import pytest

from tests.program import TINY, visitlab
from visitlab_cli.errors import RunError
from visitlab_cli.storage.cell_folder import NewCell
from visitlab_cli.storage.inside import check_inside


def link(place, target):
    shutil.rmtree(place, ignore_errors=True)
    place.symlink_to(target)


@pytest.mark.parametrize("part", ["a", "a/b", "a/b/seed-0000"])
@pytest.mark.parametrize("kind", ["link", "dangling", "pipe", "file"])
def test_a_cell_is_written_to_no_place_outside(tmp_path, part, kind):
    run, outside = tmp_path / "run", tmp_path / "outside"
    outside.mkdir()
    place = run / part
    place.parent.mkdir(parents=True)
    if kind == "pipe":
        os.mkfifo(place)
    elif kind == "file":
        place.touch()
    else:
        place.symlink_to(outside if kind == "link" else tmp_path / "nowhere")
    if (part, kind) == ("a/b/seed-0000", "file"):
        check_inside(run, place)  # a file may be written again
        return
    with pytest.raises(RunError, match="; move it away$"), NewCell(run, "a/b/seed-0000") as new:
        new.commit({}, {})
    assert list(outside.iterdir()) == []
    assert not list(run.glob(".tmp-*"))


def test_the_run_itself_may_be_a_link(tmp_path):
    (tmp_path / "real").mkdir()
    (tmp_path / "run").symlink_to("real")
    check_inside(tmp_path / "run", tmp_path / "run" / "a" / "seed-0000")


COMMANDS = {
    "navigation/mf/seed-0000": [("run", TINY), ("runs", "verify")],
    "visit": [("run", TINY), ("runs", "verify")],
    "evaluations": [("eval", "--human", "fast", "--trials", 1), ("runs", "verify")],
    "figures": [("figures",)],
    "figures/fig6.svg": [("figures", "--only", "fig6")],
    "report.html": [("report",)],
}


@pytest.mark.parametrize("place", COMMANDS)
def test_no_command_follows_a_link_out_of_a_run(tiny_run, tmp_path, place):
    run, outside = tmp_path / "runs" / tiny_run.name, tmp_path / "outside"
    shutil.copytree(tiny_run, run)
    outside.mkdir()
    (run / place).parent.mkdir(exist_ok=True)
    if (run / place).is_dir():
        shutil.move(run / place, outside / "moved")
    elif place == "report.html":
        shutil.copy(_report(run), outside / "moved")
    elif place.endswith(".svg"):
        (outside / "moved").touch()
    else:
        (outside / "moved").mkdir()
    (run / place).unlink(missing_ok=True)
    (run / place).symlink_to(outside / "moved")
    before = snapshot(outside)
    for command, *options in COMMANDS[place]:
        words = (
            options if command == "run" else [*options[:1], run, *options[1:]] if command == "runs" else [run, *options]
        )
        done = visitlab(command, *words, *(("--out", run.parent) if command != "figures" else ()))
        assert done.returncode == 4, (command, done.stdout, done.stderr)
        assert "is a link" in done.stderr
        assert len(done.stderr.splitlines()) == 1
    assert snapshot(outside) == before


def _report(run):
    assert visitlab("report", run).returncode == 0
    return run / "report.html"


def snapshot(folder):
    return {
        path.relative_to(folder): (path.lstat().st_mtime_ns, path.is_file() and path.read_bytes())
        for path in folder.rglob("*")
    }
