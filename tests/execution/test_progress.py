"""What is seen while cells run: bars on a terminal, lines elsewhere, and what each option leaves of them."""

import io
import os
import pty
import re
import subprocess
import threading

import pytest
from rich.console import Console

from tests.program import COMMAND, TINY, visitlab
from visitlab_cli.config.loading import load
from visitlab_cli.execution.progress import Progress
from visitlab_cli.plan.cells import plan

ONE_CELL = "experiments={navigation: {task: navigation, agents: [mf], steps: 40}}"
TWO_CELLS = "experiments={social: {task: social, agents: [mb, rmax], humans: [fast], steps: 200000}}"
FACTS = {"mean_reward_last_hundredth": 1.5, "trials": 60}


def on_a_terminal(*arguments, **environment):
    """What the program writes to stderr where that is a terminal of 150 columns."""
    leader, follower = pty.openpty()
    variables = {name: value for name, value in os.environ.items() if name != "NO_COLOR"}
    process = subprocess.Popen(
        [*COMMAND, *map(str, arguments)],
        stdout=subprocess.PIPE,
        stderr=follower,
        env=variables | {"COLUMNS": "150", "TERM": "xterm-256color"} | environment,
    )
    os.close(follower)
    told = []

    def read():
        try:
            while piece := os.read(leader, 65536):
                told.append(piece)
        except OSError:  # how Linux says that the other end is closed
            pass

    reader = threading.Thread(target=read)
    reader.start()
    process.communicate(timeout=600)
    reader.join()
    os.close(leader)
    assert process.returncode == 0, b"".join(told)
    return b"".join(told).decode()


def test_two_workers_on_a_terminal_have_a_bar_each_and_a_total(tmp_path):
    told = on_a_terminal("run", TINY, TWO_CELLS, "--out", tmp_path, "--workers", "2")
    frames = re.split(r"\x1b\[\d*A|\x1b\[2K", told)
    assert "steps/s" in told
    assert "0/2 cells" in told
    for agent in ("mb", "rmax"):
        assert any(re.search(rf"social/{agent}/fast/seed-0000 .*━", frame) for frame in frames)
    assert "\x1b[3" in told  # a colour


def test_no_color_leaves_the_bars_without_colours(tmp_path):
    for words, variables in ((["--no-color"], {}), ([], {"NO_COLOR": "1"})):
        told = on_a_terminal("train", TINY, ONE_CELL, *words, "--out", tmp_path / str(len(words)), **variables)
        assert "1 of 1 cells to do" in told
        assert not re.search(r"\x1b\[[\d;]*3[0-9][\d;]*m", told)


def test_force_color_colours_lines_but_draws_no_bars_into_a_file(tmp_path):
    done = visitlab("train", TINY, ONE_CELL, "--out", tmp_path, env={"FORCE_COLOR": "1", "NO_COLOR": ""})
    assert done.returncode == 0
    assert "━" not in done.stderr
    assert len(done.stderr.splitlines()) == 3
    told = failure_on(Console(file=io.StringIO(), force_terminal=True, highlight=False))
    assert "\x1b[31mnavigation/mf/seed-0000: failed: it broke\x1b[0m" in told


def failure_on(console, **options):
    cell = plan(load(TINY))[0]
    progress = Progress(console=console, **options)
    progress.say("hello")
    with progress.over([cell]):
        progress.failed(cell, "it broke")
    return console.file.getvalue()


def test_quiet_tells_failures_only():
    told = failure_on(Console(file=io.StringIO(), soft_wrap=True), quiet=True)
    assert told == "navigation/mf/seed-0000: failed: it broke\n"


def test_quiet_and_verbose(tmp_path):
    quiet = visitlab("train", TINY, ONE_CELL, "--out", tmp_path / "quiet", "-q")
    assert (quiet.returncode, quiet.stderr) == (0, "")
    verbose = visitlab("train", TINY, ONE_CELL, "--out", tmp_path / "verbose", "-v")
    assert "navigation/mf/seed-0000: begins, 40 steps\n" in verbose.stderr
    assert re.search(r"of 2 trials; \d+\.\d s, [\d,]+ steps/s\n", verbose.stderr)
    both = visitlab("train", TINY, ONE_CELL, "--out", tmp_path / "both", "-q", "-v")
    assert (both.returncode, both.stderr) == (2, "--quiet and --verbose: choose one\n")


@pytest.mark.parametrize(("seconds", "lines"), [(9, 0), (31, 3)])
def test_without_a_terminal_a_line_now_and_then_says_how_far_it_is(seconds, lines):
    now = 0.0
    cells = plan(load(TINY))[:2]
    console = Console(file=io.StringIO(), width=200)
    progress = Progress(console=console, clock=lambda: now)
    with progress.over(cells):
        for steps in (300, 600, 900):
            now += seconds
            progress.update(cells[0], steps)
            now += 1e-3
            progress.update(cells[1], 0)
        progress.finished(cells[0], FACTS)
    told = console.file.getvalue().splitlines()
    assert told[-1] == f"{cells[0].path}: 1.50 reward a trial in the last 1% of 60 trials"
    assert len(told) == lines + 1
    if lines:
        assert told[0] == "0/2 cells, 12% of the steps, 10 steps/s, about 217 s left"
