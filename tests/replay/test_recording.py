"""The recording of a trial, checked by Rerun's own tool and read back: it says what the log says."""

import dataclasses
import shutil
import subprocess

import numpy as np
import pyarrow
import pytest
import rerun.blueprint as rrb
from rerun.chunk import RrdReader

from visitlab_cli.pictures.words import width_of
from visitlab_cli.replay.blueprint import blueprint_of
from visitlab_cli.replay.drawing import GOAL_ROOM
from visitlab_cli.replay.program import program
from visitlab_cli.replay.recording import record
from visitlab_cli.scene.moments import moments
from visitlab_cli.scene.scene import ASIDE, Scene
from visitlab_cli.scene.sight import FACES, NOTHING, SEES
from visitlab_cli.scene.trial import active_in_the_end, load_trial
from visitlab_cli.scene.words import BELIEVED, GESTURES, LEVEL_NAMES, captions, option_name
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


def several_models(trial, belief=False):
    """The trial as of an agent that acts by model 1, from step 7 on by model 2."""
    n = trial.length
    steps = trial.steps | {"active_model": np.where(np.arange(n) < 7, 1, 2), "evidence": np.linspace(0, 20, n)}
    believed = dict.fromkeys(BELIEVED, np.full(n, 0.25)) if belief else {}
    return dataclasses.replace(trial, steps=steps | believed, q_of=4)


def test_it_says_by_which_of_several_models_and_how_much_evidence_is_enough(trial_of, tmp_path):
    file = tmp_path / "trial.rrd"
    file.write_bytes(record(several_models(trial_of("visit"))))
    found = {}
    for chunk in RrdReader(file).stream().to_chunks():
        batch = chunk.to_record_batch()
        for name in {"TextDocument:text", "Scalars:scalars"} & set(batch.schema.names):
            found.setdefault(str(chunk.entity_path), []).extend(batch.column(name).to_pylist())
    pages = [page for (page,) in found["/now"]]
    assert all("Best from here, by model 4 as it was in the end: " in page for page in pages)
    assert [step for step, page in enumerate(pages) if "acts by **model 1**" in page] == list(range(7))
    assert {value for (value,) in found["/evidence/for_a_model_that_is_there"]} == {30.0}
    assert {value for (value,) in found["/evidence/for_a_new_one"]} == {80.0}
    assert len(found["/evidence/nats"]) == len(pages)


@pytest.mark.parametrize("belief", [False, True])
def test_names_of_curves_fit_beside_each_other(trial_of, belief):
    """'Evidence for anothe' was what a third of the right half could show at the size of a picture."""
    blueprint = blueprint_of(Scene(several_models(trial_of("visit"), belief)))
    containers = [blueprint.root_container]
    for container in containers:  # grows
        containers += [each for each in container.contents if isinstance(each, rrb.Container)]
    (curves,) = (each for each in containers if any(isinstance(view, rrb.TimeSeriesView) for view in each.contents))
    assert len(curves.contents) == 3 + belief
    assert curves.grid_columns == 3 - belief
    assert all(width_of(view.name, 10) < width_of("Evidence for anothe", 10) for view in curves.contents)


def test_the_model_of_the_best_actions_is_read_beside_the_log(tmp_path):
    assert active_in_the_end(tmp_path / "steps.mcap") is None
    np.savez(tmp_path / "model.npz", active=np.array([3], np.int64))
    assert active_in_the_end(tmp_path / "steps.mcap") == 3


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
