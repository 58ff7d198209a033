import re

from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorSet

from visitlab_cli.log.schema import message_descriptor, proto_text, schema_bytes
from visitlab_cli.world.columns import COLUMNS, PHASES, SOME_CELLS
from visitlab_cli.world.enums import DISTANCE_NAMES, Action, Direction, InteractionLevel
from visitlab_cli.world.geometry import is_appropriate

from .blocks import message_class


def test_the_protobuf_library_accepts_the_schema_and_names_the_values():
    step = message_class("Step").DESCRIPTOR
    always = [column.name for column in COLUMNS if column.part not in SOME_CELLS]
    assert [field.name for field in step.fields] == always
    assert [field.name for field in message_descriptor("Step", (PHASES,)).field] == [*always, "phase"]
    assert all(field.has_presence for field in step.fields)
    for name, enum in [("action", Action), ("angle", Direction), ("interaction_level", InteractionLevel)]:
        values = {value.name: value.number for value in step.fields_by_name[name].enum_type.values}
        assert values == {value.name: value.value for value in enum}
    assert step.fields_by_name["action"].enum_type.values_by_number[30].name == "NO_ACTION"


def test_trial_has_the_fields_of_the_design():
    trial = message_class("Trial").DESCRIPTOR
    assert [field.name for field in trial.fields] == ["trial", "first_step_time", "reward", "steps", "goals"]


def test_schema_bytes_hold_one_self_contained_file():
    files = FileDescriptorSet.FromString(schema_bytes()).file
    assert all(field.proto3_optional for message in files[0].message_type for field in message.field)
    assert [(file.package, file.syntax, list(file.dependency)) for file in files] == [("visitlab", "proto3", [])]


def test_the_proto_file_for_people_says_what_the_descriptor_says():
    text = proto_text()
    for name in ("Step", "Trial"):
        body = re.search(rf"message {name} {{\n(.*?)\n}}", text, re.DOTALL)
        assert body
        written = re.findall(r"optional (\w+) (\w+) = (\d+);  // .+", body[1])
        kinds = FieldDescriptorProto.Type
        assert written == [
            (
                field.type_name.rpartition(".")[2] or kinds.Name(field.type).removeprefix("TYPE_").lower(),
                field.name,
                str(field.number),
            )
            for field in message_descriptor(name, SOME_CELLS).field
        ]
    assert "NO_ACTION = 30;" in text


def test_the_log_and_the_viewer_have_one_word_for_each_distance():
    (distance,) = (column for column in COLUMNS if column.name == "distance")
    assert distance.meaning == "category of the distance: 0 too close, 1 close, 2 right, 3 wide, 4 too far"
    for category, name in enumerate(DISTANCE_NAMES):
        assert is_appropriate(category) == (not name.startswith("too"))
