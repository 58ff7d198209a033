"""The comic strip: its formats, its panels, and the same bytes for the same trial."""

import sys

import pytest

from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.replay.strip import draw_strip, save_strip
from visitlab_cli.story import LEVEL_NAMES, direction_name, moments, strip_steps
from visitlab_cli.world.columns import TASKS

BEGINNINGS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


@pytest.mark.parametrize("ending", BEGINNINGS)
def test_formats_and_bytes(trial_of, tmp_path, ending):
    pytest.importorskip("matplotlib")
    files = [tmp_path / f"{name}{ending}" for name in "ab"]
    for file in files:
        save_strip(trial_of("visit"), file)
    assert files[0].read_bytes().startswith(BEGINNINGS[ending])
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize("task", TASKS)
def test_a_panel_for_each_moment(trial_of, task):
    pytest.importorskip("matplotlib")
    trial = trial_of(task)
    steps = strip_steps(trial.steps)
    panels = [axes for axes in draw_strip(trial, steps).axes if axes.axison]
    assert len(panels) == len(steps)
    for axes, step in zip(panels, steps, strict=True):
        title = axes.get_title(loc="left")
        assert title.startswith(f"{step}: ")
        if trial.has_engagement:
            assert direction_name(trial.steps["desired_direction"][step]) in title
            assert LEVEL_NAMES[trial.steps["interaction_level"][step]] in title
        drawn = [text.get_text() for text in axes.texts]
        assert ", ".join(kind for at, kind in moments(trial.steps) if at == step) in drawn


def test_another_ending(trial_of, tmp_path):
    with pytest.raises(UsageError) as error:
        save_strip(trial_of("visit"), tmp_path / "strip.gif")
    assert str(error.value) == f"--strip {tmp_path}/strip.gif: must end in .png, .svg, .pdf"


def test_without_matplotlib(trial_of, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(RunError) as error:
        save_strip(trial_of("visit"), tmp_path / "strip.png")
    assert str(error.value) == "a strip needs matplotlib; install it with pip install matplotlib"
    assert not list(tmp_path.iterdir())
