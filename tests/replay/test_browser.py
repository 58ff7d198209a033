"""`--web` in a real browser: served on this machine only, and showing what the log says."""

import re
import signal
import time
from pathlib import Path

import pytest

from tests.browser import needs_browser, opened
from tests.program import start
from tests.replay.pixels import assert_shows, goal_is_in_sight
from visitlab_cli.scene.trial import load_trial

LISTENS, LOOPBACK = "0A", "0100007F"
WITHIN = 120.0


@pytest.fixture(params=[signal.SIGTERM, signal.SIGHUP], ids=["terminated", "terminal-closed"])
def serving(tiny_run, request):
    """A trial that begins with the goal in sight, and the program that serves it, with its address."""
    every = [load_trial(log, number) for log in sorted(tiny_run.glob("visit*/*/*/steps.mcap")) for number in range(4)]
    trial = next(trial for trial in every if goal_is_in_sight(trial, 0))
    server = start("replay", trial.path, "--trial", trial.number, "--web")
    yield trial, server, server.stdout.readline().strip()
    server.send_signal(request.param)
    assert server.wait(20) == 130


def test_it_listens_on_this_machine_only(serving):
    _, _, address = serving
    ports = {int(port) for port in re.findall(r"127\.0\.0\.1:(\d+)", address)}
    assert len(ports) == 2, address
    tables = [Path("/proc/net/tcp"), Path("/proc/net/tcp6")]
    if not tables[0].exists():
        pytest.skip("no /proc/net/tcp to see who listens")
    rows = [line.split() for table in tables if table.exists() for line in table.read_text().splitlines()[1:]]
    places = [row[1].split(":") for row in rows if row[3] == LISTENS]
    assert {place for place, port in places if int(port, 16) in ports} == {LOOPBACK}


@pytest.mark.slow
@needs_browser
def test_the_browser_shows_the_trial(serving, tmp_path):
    trial, _, address = serving
    target = tmp_path / "web.png"
    end = time.monotonic() + WITHIN
    with opened() as browser:
        page = browser.new_page(viewport={"width": 1600, "height": 1000})
        page.goto(f"{address}&renderer=webgl")
        while time.monotonic() < end:
            page.wait_for_timeout(2000)
            page.screenshot(path=target)
            if shows_all(target, trial):
                break
    assert_shows(target, trial.steps, 0)


def shows_all(picture, trial):
    """Whether all of it has arrived: what the viewer is sent it draws one after the other."""
    try:
        assert_shows(picture, trial.steps, 0)
    except AssertionError:
        return False
    return True
