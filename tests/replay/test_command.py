"""`visitlab replay` as a user meets it: files, exit codes, one clear line for what goes wrong."""

import json
import subprocess

import pytest

from tests.program import visitlab
from visitlab_cli.replay.choice import CHOOSE
from visitlab_cli.replay.program import program

NO_DISPLAY = {"DISPLAY": "", "WAYLAND_DISPLAY": ""}
INSTEAD = "use --save FILE.rrd, --web, --png FILE.png --step N or --strip FILE.svg instead"
CELL = "visit/fast/seed-0000"


@pytest.fixture
def replay(tiny_run, tmp_path):
    """A function: replay the tiny run's first visit with these arguments, in an empty folder, without a display."""

    def run(*arguments, of=None):
        where = of if of is not None else tiny_run / CELL / "steps.mcap"
        return visitlab("replay", where, *arguments, cwd=tmp_path, env=NO_DISPLAY)

    return run


def test_save(replay, tiny_run, tmp_path):
    done = replay("--trial", 3, "--save", "x.rrd", of=tiny_run)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{CELL}, trial 3: x.rrd\n"
    assert done.stderr == f"chose {CELL} of 3 cells; the next is visit/slow/seed-0000; {CHOOSE}\n"
    assert [file.name for file in tmp_path.iterdir()] == ["x.rrd"]
    verified = subprocess.run([program(), "rrd", "verify", tmp_path / "x.rrd"], capture_output=True, check=False)
    assert verified.returncode == 0


def test_json_and_a_selector(replay, tiny_run):
    done = replay("--experiment", "visit_scripted", "--trial", "best", "--save", "x.rrd", "--json", of=tiny_run)
    told = json.loads(done.stdout)
    assert told["cell"] == "visit_scripted/fast_pointing/seed-0000"
    assert done.stderr.startswith(f"the best trial is {told['cell']}, trial {told['trial']}")


@pytest.mark.parametrize(
    ("arguments", "code", "line"),
    [
        ((), 2, f"no display to open the viewer on; {INSTEAD}"),
        (("--trial", 9, "--save", "x.rrd"), 5, "{log}: trial 9 is not recorded; the log holds 0 to 3"),
        (("--save", "no/x.rrd"), 4, "no/x.rrd: can't be written: No such file or directory"),
        (("--save", "x.txt"), 2, "--save x.txt: must end in .rrd"),
        (("--save", "x.rrd", "--web"), 2, "--save, --web, --png and --strip: choose one"),
        (("--png", "x.png"), 2, "--png and --step: a picture needs both, as in --png picture.png --step 12"),
        (("--png", "x.png", "--step", 101), 2, "--step 101: the trial has steps 0 to 100"),
        (("--png", "x.gif", "--step", 1), 2, "--png x.gif: must end in .png"),
        (("--strip", "x.gif"), 2, "--strip x.gif: must end in .png, .svg, .pdf"),
    ],
)
def test_one_clear_line(replay, tiny_run, tmp_path, arguments, code, line):
    done = replay(*arguments)
    assert (done.returncode, done.stdout) == (code, "")
    assert done.stderr == line.format(log=tiny_run / CELL / "steps.mcap") + "\n"
    assert not list(tmp_path.iterdir())


def test_a_damaged_log(replay, tiny_run, tmp_path):
    broken = tmp_path / "broken.mcap"
    broken.write_bytes((tiny_run / CELL / "steps.mcap").read_bytes()[:-1000])
    done = replay("--save", "x.rrd", of=broken)
    assert (done.returncode, done.stdout) == (4, "")
    assert done.stderr.startswith(f"{broken}: ")
    assert done.stderr.count("\n") == 1
    assert [file.name for file in tmp_path.iterdir()] == ["broken.mcap"]


def test_a_display_that_does_not_work(tiny_run, tmp_path):
    log = tiny_run / CELL / "steps.mcap"
    done = visitlab("replay", log, cwd=tmp_path, env={"DISPLAY": ":77", "WAYLAND_DISPLAY": ""})
    assert (done.returncode, done.stderr) == (4, f"the viewer could not open a window; {INSTEAD}\n")
