"""The recording of a trial, checked by Rerun's own tool and read back: it says what the log says."""

import shutil
import subprocess

import numpy as np
import pyarrow
import pytest
from rerun.chunk import RrdReader

from visitlab_cli.replay.drawing import GOAL_ROOM
from visitlab_cli.replay.program import program
from visitlab_cli.replay.recording import record
from visitlab_cli.scene.moments import moments
from visitlab_cli.scene.scene import ASIDE, Scene
from visitlab_cli.scene.sight import FACES, NOTHING, SEES
from visitlab_cli.scene.trial import load_trial
from visitlab_cli.scene.words import GESTURES, LEVEL_NAMES, captions, option_name
from visitlab_cli.storage.arrays import read_model
from visitlab_cli.world import columns as parts
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import TASK_NAMES, tasks_with

SCENE = {"/lab/floor", "/lab/walls", "/robot/body", "/robot/heading", "/robot/place", "/captions", "/now", "/reward"}
GOAL = {"/lab/goal", "/lab/flag", "/goal"}
HUMAN = {"/human/body", "/human/place", "/human/field", "/human/field/near", "/interaction_level", "/distance/cells"}
ENTITIES = {
    "navigation": SCENE | GOAL | {"/lab/names"},
    "go_to_human": SCENE | HUMAN | {"/lab/names"},
    "social": SCENE | HUMAN | {"/human/desired"},
    "visit": SCENE | HUMAN | GOAL | {"/human/desired", "/lab/names"},
}


@pytest.fixture(scope="session", params=TASK_NAMES)
def recorded(request, trial_of, tmp_path_factory):
    """A trial of each task, its .rrd, and the columns in it by entity and component."""
    trial = trial_of(request.param)
    file = tmp_path_factory.mktemp("rrd") / "trial.rrd"
    file.write_bytes(record(trial))
    columns = {}
    for chunk in RrdReader(file).stream().to_chunks():
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if pyarrow.types.is_temporal(batch.schema.field(name).type):
                continue  # Rerun's own clock, which pyarrow reads with pandas only
            columns.setdefault((str(chunk.entity_path), name), []).extend(batch.column(name).to_pylist())
    return trial, file, columns


def test_rerun_verifies_it(recorded):
    _, file, _ = recorded
    done = subprocess.run([program(), "rrd", "verify", file], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "1 file verified without error." in done.stdout + done.stderr


def test_it_has_the_scene_of_its_task(recorded):
    trial, file, columns = recorded
    entities = {entity for entity, _ in columns}
    assert ENTITIES[trial.task] <= entities
    for task, others in ENTITIES.items():
        assert task == trial.task or not entities & (others - ENTITIES[trial.task])
    assert len(RrdReader(file).blueprints()) == 1


def test_every_step_is_there(recorded):
    trial, _, columns = recorded
    for (entity, name), values in columns.items():
        if name == "step" and entity not in ("/moments", "/robot/says", "/robot/points"):
            assert values == list(range(trial.last_step + 1)), entity


def test_positions_and_headings(recorded):
    trial, _, columns = recorded
    steps = trial.steps
    for who in ("robot", "human"):
        if who == "human" and trial.task == "navigation":
            continue
        places = np.array(columns[f"/{who}/place", "Points2D:positions"])[:, 0]
        aside = np.array([ASIDE[who] * Scene(trial).share_a_cell(step) for step in range(trial.length)])
        np.testing.assert_allclose(places[:, 0], steps[f"{who}_col"] + 0.5 + aside, rtol=0, atol=1e-5)
        np.testing.assert_array_equal(places[:, 1], steps[f"{who}_row"] + 0.5)
        arrows = np.array(columns[f"/{who}/heading", "Arrows2D:vectors"])[:, 0]
        turned = np.arctan2(-arrows[:, 1], arrows[:, 0]) / (np.pi / 4) % 8
        np.testing.assert_allclose(turned, steps[f"{who}_heading"], atol=1e-5)


def test_the_best_actions_are_those_of_the_model_beside_the_log(recorded):
    trial, _, columns = recorded
    q = read_model(trial.path.with_name("model.npz"))["q"]
    for state, (page,) in zip(trial.steps["state"], columns["/now", "TextDocument:text"], strict=True):
        best = int(np.argmax(q[state]))
        assert page.endswith("**")
        assert f"learned in the end: {option_name(best)} **{q[state, best]:.2f}**, " in page


def test_a_log_alone_has_no_best_actions(trial_of, tmp_path):
    alone = tmp_path / "steps.mcap"
    shutil.copy(trial_of("social").path, alone)
    assert load_trial(alone, 1).q is None
    alone.with_name("model.npz").write_bytes(b"damaged")
    assert load_trial(alone, 1).q is None


def test_words_and_curves(recorded):
    trial, _, columns = recorded
    steps, told = trial.steps, captions(trial.steps, paper_lab())
    assert columns["/captions", "TextLog:text"] == [[words] for words in told]
    if moments(steps, paper_lab()):
        assert columns["/moments", "step"] == [moment.step for moment in moments(steps, paper_lab())]
    np.testing.assert_allclose(np.ravel(columns["/reward", "Scalars:scalars"]), np.cumsum(steps["reward"]))
    assert all(f"Step {step}: " in page[0] for step, page in enumerate(columns["/now", "TextDocument:text"]))


@pytest.mark.parametrize("recorded", tasks_with(parts.HUMAN), indirect=True)
def test_levels_and_distance(recorded):
    trial, _, columns = recorded
    steps = {name: values.astype(int) for name, values in trial.steps.items()}
    levels = [LEVEL_NAMES[level] for level in steps["interaction_level"]]
    assert columns["/interaction_level", "StateChange:state"] == [[level] for level in levels]
    apart = [abs(steps[f"robot_{axis}"] - steps[f"human_{axis}"]) for axis in ("row", "col")]
    np.testing.assert_array_equal(np.ravel(columns["/distance/cells", "Scalars:scalars"]), np.maximum(*apart))


@pytest.mark.parametrize("recorded", tasks_with(parts.GOAL), indirect=True)
def test_the_goal_room_is_coloured(recorded):
    trial, _, columns = recorded
    for buffer, goal in zip(columns["/lab/goal", "SegmentationImage:buffer"], trial.steps["goal_room"], strict=True):
        cells = np.frombuffer(bytes(buffer[0]), np.uint8).reshape(24, 24)
        row, col = divmod(int(goal), 3)
        inside = cells[8 * row : 8 * row + 8, 8 * col : 8 * col + 8]
        assert (inside == GOAL_ROOM).all()
        assert (cells == GOAL_ROOM).sum() == 64


@pytest.mark.parametrize("recorded", tasks_with(parts.HUMAN), indirect=True)
def test_the_fields_agree_with_the_logged_levels(recorded):
    trial, _, columns = recorded
    kinds = {"near": {1, 2, 3}, "elsewhere": {0, 4}}
    fields = {kind: columns[f"/human/field/{kind}", "SegmentationImage:buffer"] for kind in kinds}
    corners = np.array(columns["/human/field", "Transform3D:translation"])[:, 0]
    checked = 0
    for step in range(trial.length):
        robot = [int(trial.steps[f"robot_{axis}"][step]) for axis in ("col", "row")]
        col, row = (int(at - corner) for at, corner in zip(robot, corners[step][:2], strict=True))
        level = int(trial.steps["interaction_level"][step])
        if not (0 <= row < 17 and 0 <= col < 17) or (row, col) == (8, 8) or level > 4:
            continue
        for kind, categories in kinds.items():
            shown = np.frombuffer(bytes(fields[kind][step][0]), np.uint8).reshape(17, 17)[row, col]
            sees = {0: NOTHING, 1: SEES, 3: SEES, 2: FACES, 4: FACES}[level]
            assert shown == (sees if trial.steps["distance"][step] in categories else NOTHING), step
        checked += 1
    assert checked


def test_gestures_are_said(trial_of):
    trial = trial_of("visit", 0)
    assert set(GESTURES) & set(trial.steps["executed_action"].tolist())
