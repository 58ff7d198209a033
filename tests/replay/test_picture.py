"""The viewer's picture, taken without a screen, shows what the log says."""

import contextlib
import os
import tempfile
from types import SimpleNamespace

import numpy as np
import pytest

from tests.replay.pixels import assert_shows, goal_is_in_sight
from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.replay import picture

needs_driver = pytest.mark.skipif(
    picture.software_driver() is None and picture.DRIVER_VARIABLE not in os.environ,
    reason="no software Vulkan; on Debian install mesa-vulkan-drivers",
)


@needs_driver
def test_the_picture_shows_the_step(trial_of, tmp_path, monkeypatch):
    trial = trial_of("visit", 0)
    step = next(step for step in range(5, trial.length) if goal_is_in_sight(trial, step))
    target = tmp_path / "picture.png"
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "temporary"))
    monkeypatch.setenv("TMPDIR", str(tmp_path / "temporary"))
    (tmp_path / "temporary").mkdir()
    picture.save_picture(trial, step, target)
    (tmp_path / "temporary").rmdir()  # which fails where something was left
    assert_shows(target, trial.steps, step)
    moved = {**trial.steps, "robot_row": (trial.steps["robot_row"] + 4) % 24}
    with pytest.raises(AssertionError, match="the robot is not in its cell"):
        assert_shows(target, moved, step)
    elsewhere = {**trial.steps, "goal_room": (trial.steps["goal_room"] + 1) % 9}
    with pytest.raises(AssertionError):
        assert_shows(target, elsewhere, step)
    assert [file.name for file in tmp_path.iterdir()] == ["picture.png"]


def test_without_a_driver(trial_of, tmp_path, monkeypatch):
    monkeypatch.setattr(picture, "DRIVER_FOLDERS", (tmp_path,))
    monkeypatch.delenv(picture.DRIVER_VARIABLE, raising=False)
    with pytest.raises(RunError) as error:
        picture.save_picture(trial_of("visit"), 1, tmp_path / "picture.png")
    assert str(error.value) == "a picture needs a Vulkan driver; on Debian install mesa-vulkan-drivers"
    assert not list(tmp_path.iterdir())


def test_a_step_that_is_not_there(trial_of, tmp_path):
    with pytest.raises(UsageError) as error:
        picture.save_picture(trial_of("visit"), np.int64(101), tmp_path / "picture.png")
    assert str(error.value) == "--step 101: the trial has steps 0 to 100"


@pytest.mark.parametrize(
    ("error", "ended", "told"),
    [
        (RunError("the viewer did not load the trial within 60 seconds"), None, "{error}"),
        (
            TimeoutError("no answer"),
            None,
            "the viewer drew no picture: {error}; it runs, but is too slow or busy; try again",
        ),
        (ConnectionError("refused"), 1, "the viewer drew no picture: {error}; " + picture.NO_DRIVER),
    ],
)
def test_only_a_viewer_that_ended_is_blamed_on_a_driver(trial_of, tmp_path, monkeypatch, error, ended, told):
    def fails(*arguments):
        raise error

    @contextlib.contextmanager
    def started(*arguments, **options):
        yield SimpleNamespace(poll=lambda: ended)

    monkeypatch.setenv(picture.DRIVER_VARIABLE, "there.json")
    monkeypatch.setattr(picture, "started", started)
    monkeypatch.setattr(picture, "answers", lambda port: True)
    monkeypatch.setattr(picture, "_take", fails)
    with pytest.raises(RunError) as raised:
        picture.save_picture(trial_of("visit"), 1, tmp_path / "picture.png")
    assert str(raised.value) == told.format(error=error)
