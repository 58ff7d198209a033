"""The comic strip: its formats, its panels, and the same bytes for the same trial."""

import dataclasses
import sys

import numpy as np
import pytest

from tests.pictures.within import beyond, upon_another, words_of
from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.pictures.style import STRIP_STYLE, styled
from visitlab_cli.replay.strip import draw_strip, save_strip
from visitlab_cli.scene.moments import left_out, moments, strip_steps
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import LEVEL_NAMES, direction_name
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import TASK_NAMES

BEGINNINGS = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


@pytest.mark.parametrize("ending", BEGINNINGS)
def test_formats_and_bytes(trial_of, tmp_path, ending):
    pytest.importorskip("matplotlib")
    files = [tmp_path / f"{name}{ending}" for name in "ab"]
    for file in files:
        save_strip(trial_of("visit"), file)
    assert files[0].read_bytes().startswith(BEGINNINGS[ending])
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize("task", TASK_NAMES)
def test_a_panel_for_each_moment(trial_of, task):
    pytest.importorskip("matplotlib")
    trial = trial_of(task)
    steps = strip_steps(trial.steps, paper_lab())
    panels = [axes for axes in draw_strip(trial, steps).axes if axes.axison]
    assert len(panels) == len(steps)
    for axes, step in zip(panels, steps, strict=True):
        title = axes.get_title(loc="left")
        assert title.startswith(f"{step}: ")
        if trial.has_engagement:
            assert direction_name(trial.steps["desired_direction"][step]) in title
            assert LEVEL_NAMES[trial.steps["interaction_level"][step]] in title
        drawn = [text.get_text() for text in axes.texts]
        assert ", ".join(kind for at, kind in moments(trial.steps, paper_lab()) if at == step) in drawn


def test_only_a_strip_is_replaced(trial_of, tmp_path):
    pytest.importorskip("matplotlib")
    strip = tmp_path / "strip.svg"
    save_strip(trial_of("visit"), strip)
    save_strip(trial_of("social"), strip)
    strip.write_text("name: mine")
    with pytest.raises(UsageError) as error:
        save_strip(trial_of("visit"), strip)
    assert str(error.value) == f"{strip}: exists and was not written by visitlab; move it away or choose another file"
    assert strip.read_text() == "name: mine"


@pytest.mark.parametrize("task", ["social", "visit"])
def test_what_the_human_sees_stays_in_the_panel(trial_of, task):
    pytest.importorskip("matplotlib")
    trial = trial_of(task)
    figure = draw_strip(trial, strip_steps(trial.steps, paper_lab()))
    figure.canvas.draw()
    for axes in [axes for axes in figure.axes if axes.axison]:
        (field,) = axes.images
        clipped, inside = field.get_clip_box(), axes.bbox.padded(1)
        assert inside.x0 <= clipped.x0 < clipped.x1 <= inside.x1
        assert inside.y0 <= clipped.y0 < clipped.y1 <= inside.y1


def test_both_are_seen_where_they_share_a_cell(trial_of):
    pytest.importorskip("matplotlib")
    trial = trial_of("visit")
    steps = {name: values.copy() for name, values in trial.steps.items()}
    for axis in ("row", "col"):
        steps[f"robot_{axis}"][1] = steps[f"human_{axis}"][1]
        steps[f"robot_{axis}"][2] = (steps[f"human_{axis}"][2] + 5) % 24
    trial = Trial(trial.path, trial.cell, trial.task, trial.number, steps, trial.lab, trial.distances)
    figure = draw_strip(trial, [1, 2])
    figure.canvas.draw()
    for axes, shared in zip(figure.axes, (True, False), strict=True):
        boxes = {line.get_gid(): line.get_window_extent() for line in axes.lines if line.get_gid()}
        middles = {who: (box.x0 + box.x1) / 2 for who, box in boxes.items()}
        assert set(boxes) == {"robot", "human"}
        assert abs(middles["robot"] - middles["human"]) > 0.5 * boxes["human"].width
        assert ("both in one cell" in [text.get_text() for text in axes.texts]) == shared


@pytest.mark.parametrize("panels", [3, None])
def test_it_says_what_is_left_out(trial_of, panels):
    pytest.importorskip("matplotlib")
    trial = trial_of("visit", 0)
    every = sorted({0, *(moment.step for moment in moments(trial.steps, paper_lab()))})
    shown = every[:panels]
    figure = draw_strip(trial, shown)
    said = [text.get_text() for text in figure.texts]
    assert said == ([f"Not shown: {left_out(trial.steps, shown, paper_lab())}."] if panels else [])
    assert len(every) > 3


def test_it_says_by_which_of_several_models(trial_of):
    pytest.importorskip("matplotlib")
    trial = trial_of("visit", 0)
    active = np.repeat([0, 3, 1], [5, 20, trial.length - 25])
    trial = dataclasses.replace(trial, steps=trial.steps | {"active_model": active})
    with styled(STRIP_STYLE):
        figure = draw_strip(trial, [0, 1])
        words = words_of(figure)
    (said,) = (text.get_text() for text in figure.texts)
    expected = "Acts by model 0, from step 5 on by model 3, from step 25 on by model 1. Not shown: "
    assert said.replace("\n", " ").startswith(expected)
    assert beyond(figure, words) == []
    assert upon_another(words) == []


@pytest.mark.parametrize("panels", [1, 2, 3])
def test_the_key_fits_under_few_panels(trial_of, panels):
    pytest.importorskip("matplotlib")
    figure = draw_strip(trial_of("visit"), list(range(panels)))
    figure.canvas.draw()
    (key,) = figure.legends
    box = key.get_window_extent()
    assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
    assert figure.bbox.y0 <= box.y0 < box.y1 < min(axes.bbox.y0 for axes in figure.axes)


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
