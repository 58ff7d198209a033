"""The export for Foxglove: read back by the stock reader, its schemas those that Foxglove publishes."""

import importlib
from pathlib import Path

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import DescriptorProto
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from tests.log.blocks import random_steps
from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.export.foxglove import write_foxglove
from visitlab_cli.export.foxglove_schema import file_descriptor
from visitlab_cli.log.reader import Columns
from visitlab_cli.scene.colours import GOAL_FLOOR
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import caption
from visitlab_cli.world.enums import Action, Direction
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import columns_of

STEPS, SIZE, ROOM = 20, 24, 8


def shown(task: str, number: int = 0) -> Trial:
    """A trial of random values, in which every other step is a hello."""
    steps, rows = random_steps(1, STEPS, seed=number)
    columns: Columns = {column.name: getattr(steps, column.name) for column in columns_of(task)}
    for name, values in columns.items():
        if values.dtype != np.bool_:
            values %= SIZE if name.endswith(("_row", "_col")) else 9 if name == "goal_room" else 8
    columns["step"][:] = np.arange(rows)
    if "executed_action" in columns:
        columns["executed_action"][1::2] = Action.HELLO
    return Trial(
        Path(), "cell", task, number, columns, paper_lab(), DISTANCES, arena=SIZE if task == "social" else None
    )


def read(path):
    """For each topic the times and decoded messages."""
    found = {}
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            found.setdefault((channel.topic, schema.name), []).append((message.log_time, decoded))
    return found


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    trials = [shown("visit"), shown("visit", 5)]
    path = tmp_path_factory.mktemp("foxglove") / "a.mcap"
    assert write_foxglove(path, trials) == 2 * (STEPS + 1)
    return trials, read(path)


def test_topics_schemas_and_times(exported):
    _, found = exported
    each = [row * 10**9 for row in range(2 * (STEPS + 1))]
    assert {key: [time for time, _ in messages] for key, messages in found.items()} == {
        ("/tf", "foxglove.FrameTransforms"): each,
        ("/lab", "foxglove.SceneUpdate"): [each[0], each[STEPS + 1]],
        ("/scene", "foxglove.SceneUpdate"): each,
        ("/caption", "foxglove.Log"): each,
        ("/step", "visitlab.Step"): each,
    }
    for (topic, _), messages in found.items():
        for time, message in messages if topic != "/step" else ():
            stamped = {"/tf": "transforms", "/lab": "entities", "/scene": "entities"}.get(topic)
            for part in getattr(message, stamped) if stamped else [message]:
                assert part.timestamp.ToNanoseconds() == time


def test_steps_are_those_of_the_log(exported):
    trials, found = exported
    messages = [message for _, message in found["/step", "visitlab.Step"]]
    for name in trials[0].steps:
        expected = np.concatenate([trial.steps[name] for trial in trials])
        assert [getattr(message, name) for message in messages] == expected.tolist()


def test_robot_and_human_are_where_the_steps_say(exported):
    trials, found = exported
    for (_, message), row in zip(found["/tf", "foxglove.FrameTransforms"], range(STEPS + 1), strict=False):
        for transform in message.transforms:
            who = transform.child_frame_id
            assert transform.parent_frame_id == "lab"
            assert transform.translation.x - 0.5 == trials[0].steps[f"{who}_col"][row]
            assert SIZE - transform.translation.y - 0.5 == trials[0].steps[f"{who}_row"][row]
            turned = 2 * np.arctan2(transform.rotation.z, transform.rotation.w) / (np.pi / 4)
            assert round(turned, 9) % 8 == trials[0].steps[f"{who}_heading"][row]
        assert [transform.child_frame_id for transform in message.transforms] == ["robot", "human"]


def test_the_goal_room_lies_where_its_name_stands(exported):
    trials, found = exported
    [(_, lab), *_] = found["/lab", "foxglove.SceneUpdate"]
    names = {text.text: text.pose.position for entity in lab.entities for text in entity.texts}
    assert len(names) == 9
    assert (names["Room 0"].x, names["Room 0"].y) == (4, 23)  # in the north-west
    for (_, scene), row in zip(found["/scene", "foxglove.SceneUpdate"], range(STEPS + 1), strict=False):
        [goal] = [cube for entity in scene.entities if entity.id == "goal room" for cube in entity.cubes]
        name = names[f"Room {trials[0].steps['goal_room'][row]}"]
        assert (goal.pose.position.x, goal.size.x, goal.size.y) == (name.x, ROOM, ROOM)
        assert goal.pose.position.y == name.y - 3
        assert goal.color.r == pytest.approx(GOAL_FLOOR[0] / 255)


def test_what_is_said_shown_and_told(exported):
    trials, found = exported
    logs = [message.message for _, message in found["/caption", "foxglove.Log"]]
    assert logs[3] == f"trial 0, step 3: {caption(trials[0].steps, 3, paper_lab())}"
    assert logs[STEPS + 1] == f"trial 5, step 0: {caption(trials[1].steps, 0, paper_lab())}"
    for (_, scene), row in zip(found["/scene", "foxglove.SceneUpdate"], range(STEPS + 1), strict=False):
        entities = {entity.id: entity for entity in scene.entities}
        assert [text.text for text in entities["robot"].texts] == ["HELLO!"] * (row % 2)
        assert len(entities["human's way"].lines[0].points) == row + 1
        [arrow] = entities["desired direction"].arrows
        turned = 2 * np.arctan2(arrow.pose.orientation.z, arrow.pose.orientation.w) / (np.pi / 4)
        assert Direction(round(turned) % 8) == trials[0].steps["desired_direction"][row]


@pytest.mark.parametrize(
    ("task", "entities"),
    [
        ("navigation", {"robot", "robot's way", "goal room"}),
        ("go_to_human", {"robot", "robot's way", "human", "human's way"}),
        ("social", {"robot", "robot's way", "human", "human's way", "desired direction"}),
    ],
)
def test_each_task_shows_what_it_has(tmp_path, task, entities):
    write_foxglove(tmp_path / "a.mcap", [shown(task)])
    found = read(tmp_path / "a.mcap")
    _, scene = found["/scene", "foxglove.SceneUpdate"][0]
    assert {entity.id for entity in scene.entities} == entities
    [(_, lab)] = found["/lab", "foxglove.SceneUpdate"]
    assert len(lab.entities[0].texts) == (0 if task == "social" else 9)


def test_schemas_are_those_that_foxglove_publishes():
    package = "foxglove_schemas_protobuf"
    pytest.importorskip(package)
    for ours in file_descriptor().message_type:
        theirs = DescriptorProto()
        module = importlib.import_module(f"{package}.{ours.name}_pb2")
        module.DESCRIPTOR.message_types_by_name[ours.name].CopyToProto(theirs)
        for found in (ours, theirs):
            for field in found.field:
                field.ClearField("json_name")
        assert list(ours.field) == list(theirs.field)
        assert list(ours.enum_type) == list(theirs.enum_type)


def test_nothing_is_overwritten_and_a_failure_leaves_nothing(tmp_path):
    path = tmp_path / "a.mcap"
    path.write_text("mine")
    with pytest.raises(UsageError, match=r"a.mcap: exists; choose another file with -o$"):
        write_foxglove(path, [shown("visit")])
    assert path.read_text() == "mine"
    with pytest.raises(RunError, match=r"can't be written: [^\n]+$"):
        write_foxglove(tmp_path / "missing" / "a.mcap", [shown("visit")])

    def fails():
        yield shown("visit")
        raise RunError("the second is damaged")

    with pytest.raises(RunError, match="second"):
        write_foxglove(tmp_path / "b.mcap", fails())
    assert [path.name for path in tmp_path.iterdir()] == ["a.mcap"]
