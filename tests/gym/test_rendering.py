"""What is rendered is the episode, drawn by what draws recorded trials."""

import gymnasium
import numpy as np
import pytest
import rerun as rr
from rerun.chunk import RrdReader

from tests.gym.test_environment import IDS, NAVIGATION, SOCIAL, VISIT, actions_of, made
from visitlab_cli.errors import UsageError
from visitlab_cli.replay.live import Growing
from visitlab_cli.replay.recording import record, recording_of
from visitlab_cli.scene.colours import GOAL_FLOOR, HUMAN, ROBOT
from visitlab_cli.scene.words import captions


def begun(name, mode, steps=6):
    environment = made(name, render_mode=mode)
    environment.reset(seed=3)
    for action in actions_of(environment, steps):
        environment.step(action)
    return environment


@pytest.mark.parametrize("name", IDS)
def test_pictures_show_who_is_there(name):
    environment = begun(name, "rgb_array")
    picture = environment.render()
    assert picture.dtype == np.uint8
    assert picture.shape == (704, 608, 3)

    def shown(colour):
        return int((abs(picture.astype(int) - np.array(colour)).max(axis=2) < 6).sum())

    assert shown(ROBOT) > 50
    assert (shown(HUMAN) > 50) == (name != NAVIGATION)
    assert (shown(GOAL_FLOOR) > 1000) == (name in (NAVIGATION, VISIT))
    assert (environment.render() == picture).all()
    environment.step(26 if name in (SOCIAL, VISIT) else 0)
    assert (environment.render() != picture).any()


@pytest.mark.parametrize("name", IDS)
def test_words_are_those_of_the_replay(name):
    environment = made(name, render_mode="ansi")
    environment.reset(seed=3)
    told = [environment.render()]
    for action in actions_of(environment, 30):
        told.append(environment.step(action) and environment.render())
        if len(told) == 21:
            break
    trial = environment.unwrapped._rendering.trial()
    expected = captions(trial.steps, trial.lab)
    assert [line.split(": ", 1)[1] for line in told] == expected
    assert [line.split(",")[0] for line in told] == [f"step {step}" for step in range(21)]


def test_lists_of_pictures_are_gymnasiums():
    environment = gymnasium.make(NAVIGATION, render_mode="ansi_list")
    environment.reset(seed=0)
    environment.step(3)
    assert len(environment.render()) == 2


def test_the_viewer_needs_a_display(monkeypatch):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    with pytest.raises(UsageError, match='no display to open the viewer on; use render_mode="rgb_array" or "ansi"'):
        gymnasium.make(NAVIGATION, render_mode="human")


def rows_of(content, file):
    """What a recording has of each entity, by step and component."""
    file.write_bytes(content)
    rows = {}
    for chunk in RrdReader(file).stream().to_chunks():
        batch = chunk.to_record_batch()
        names = [name for name in batch.schema.names if ":" in name]
        for index, step in enumerate(batch.column("step").to_pylist() if "step" in batch.schema.names else ()):
            told = rows.setdefault(str(chunk.entity_path), {}).setdefault(step, {})
            told.update({name: batch.column(name)[index].as_py() for name in names})
    return rows


def test_a_growing_recording_ends_as_the_whole_one(tmp_path):
    environment = begun(VISIT, "ansi", steps=0)
    trial = environment.unwrapped._rendering.trial
    growing = Growing(recording_of(trial()), 0)
    stream = rr.binary_stream(growing.recording)
    growing.draw(trial())
    for action in actions_of(environment, 12):
        environment.step(action)
        growing.draw(trial())
    grown = rows_of(stream.read(flush=True), tmp_path / "grown.rrd")
    whole = rows_of(record(trial()), tmp_path / "whole.rrd")
    assert set(grown) == set(whole)
    assert len(whole["/robot/place"][12]) > 1
    for entity, rows in whole.items():
        first = min(grown[entity])  # of lines nothing is sent before there are any
        assert grown[entity] == {step: told for step, told in rows.items() if step >= first}, entity
        assert all(not any(told.values()) for step, told in rows.items() if step < first), entity


def test_rendering_without_a_mode_is_warned_of():
    environment = made(SOCIAL).unwrapped
    environment.reset(seed=0)
    with pytest.warns(UserWarning, match="nothing is rendered without a render_mode"):
        assert environment.render() is None
