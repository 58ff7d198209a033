"""Who speaks: what the human says is told as the human's, beside what the robot says, in each drawer."""

import numpy as np
import pytest
from rerun.chunk import RrdReader

from tests.scene.test_words import BEGIN, visit
from visitlab_cli.export.foxglove_scene import scene_entities
from visitlab_cli.replay.recording import record
from visitlab_cli.replay.strip import draw_strip
from visitlab_cli.report.best_trial import plain_scene
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Role, Speech
from visitlab_cli.scene.trial import Trial
from visitlab_cli.world.enums import Action, Direction
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import VISIT


@pytest.fixture
def trial(monkeypatch, tmp_path):
    """The robot says hello, and somebody added to the scene that the human answers."""
    before = Scene.moment

    def moment(self, step):
        answer = Speech(Role.HUMAN_SAYS, tuple(map(float, self._places["human"][step])), "HI!", above=True)
        return [*before(self, step), *([answer] if step == 1 else [])]

    monkeypatch.setattr(Scene, "moment", moment)
    steps = visit(BEGIN, {"action": Action.HELLO, "robot_row": 12})
    headings = {f"{who}_heading": np.full(len(steps["step"]), Direction.WEST) for who in ("robot", "human")}
    return Trial(tmp_path, "visit", VISIT, 0, {**steps, **headings}, paper_lab(), DISTANCES)


def test_the_report_keeps_them_apart(trial):
    told = plain_scene(trial)
    assert (told[Role.ROBOT_SAYS], told[Role.HUMAN_SAYS]) == ({"1": "HELLO!"}, {"1": "HI!"})


def test_foxglove_puts_each_at_its_speaker(trial):
    said = {
        entity["id"]: [text["text"] for text in entity.get("texts", ())] for entity in scene_entities(Scene(trial), 1)
    }
    assert (said["robot"], said["human"]) == (["HELLO!"], ["HI!"])


def test_the_viewer_has_an_entity_for_each(trial, tmp_path):
    file = tmp_path / "a.rrd"
    file.write_bytes(record(trial))
    entities = {str(chunk.entity_path) for chunk in RrdReader(file).stream().to_chunks()}
    assert {"/robot/says", "/human/says"} <= entities


def test_the_strip_draws_both(trial):
    words = {text.get_text() for text in draw_strip(trial, [1]).findobj() if hasattr(text, "get_text")}
    assert {"Hello!", "Hi!"} <= words
