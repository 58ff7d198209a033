"""Foreign logs: every message is read by the schema of its own channel, as the stock decoder reads it."""

import io
import json

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FieldDescriptorProto, FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer
from mcap_protobuf.decoder import DecoderFactory

from visitlab_cli.errors import RunError
from visitlab_cli.log.reader import read_steps, read_trial, trials
from visitlab_cli.log.recovery.recovery import recover
from visitlab_cli.log.schema import file_descriptor
from visitlab_cli.world.tasks import columns_of

from . import raw
from .blocks import message_class, random_steps, serialized

TRIALS, TRIAL_STEPS = 4, 20
ROWS = TRIALS * (TRIAL_STEPS + 1)
NAMES = [column.name for column in columns_of("visit")]
INTEGERS = [
    getattr(FieldDescriptorProto, f"TYPE_{name}") for name in ("INT64", "UINT64", "SINT64", "FIXED64", "DOUBLE")
]


@pytest.fixture(scope="module")
def steps():
    return random_steps(TRIALS, TRIAL_STEPS)[0]


def changed(change):
    """The schema after a change of its steps, and the class of these."""
    descriptor = file_descriptor()
    change(descriptor.message_type[0])
    pool = DescriptorPool()
    pool.Add(descriptor)
    found = GetMessageClass(pool.FindMessageTypeByName("visitlab.Step"))
    return FileDescriptorSet(file=[descriptor]).SerializeToString(), found


def same(message):
    pass


def reversed_numbers(message):
    numbers = [field.number for field in message.field]
    for field, number in zip(message.field, numbers[::-1], strict=True):
        field.number = number


def any_change(rng):
    """Other numbers, order and types; one field renamed, one more, values of 0 left out or not."""

    def change(message):
        numbers = rng.permutation(np.arange(1, 60))
        if rng.random() < 0.5:
            del message.oneof_decl[:]
            for field in message.field:
                field.ClearField("proto3_optional")
                field.ClearField("oneof_index")
        for field, number in zip(message.field, numbers, strict=False):
            field.number = number
            if field.type in (field.TYPE_FIXED32, field.TYPE_UINT32, field.TYPE_ENUM) and rng.random() < 0.5:
                field.type = int(rng.choice(INTEGERS))
                field.ClearField("type_name")
        old_name = str(rng.choice(NAMES[2:]))
        next(field for field in message.field if field.name == old_name).name = "renamed"
        message.field.add(name="more", number=100, label=1, type=FieldDescriptorProto.TYPE_STRING)
        if rng.random() < 0.5:
            fields = [type(message.field[0]).FromString(field.SerializeToString()) for field in message.field]
            del message.field[:]
            message.field.extend(fields[::-1])

    return change


def values_of(steps, row, step_class):
    known = set(step_class.DESCRIPTOR.fields_by_name)
    return {name: getattr(steps, name)[row].item() for name in NAMES if name in known}


def written(path, steps, changes, rng, **options):
    """A log whose steps are of one of some schemas each, at random, all of one name and on one topic."""
    with path.open("wb") as stream:
        writer = Writer(stream, **options)
        writer.start()
        channels = []
        for change in changes:
            data, step_class = changed(change)
            number = writer.register_schema("visitlab.Step", "protobuf", data)
            channels.append((writer.register_channel("/step", "protobuf", number), step_class))
        for row in range(ROWS):
            channel, step_class = channels[rng.integers(len(channels))]
            message = step_class(**values_of(steps, row, step_class))
            writer.add_message(channel, row, message.SerializeToString(), row)
        writer.finish()
    return path


def check(path):
    """What we read is what the stock decoder reads."""
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        expected = [each.decoded_message for each in reader.iter_decoded_messages(log_time_order=False)]
    for found in (read_steps(path), {name: values for name, values in read_trial(path, 2).items()}):
        rows = expected if len(found["step"]) == ROWS else [each for each in expected if each.trial == 2]
        for name, values in found.items():
            assert values.tolist() == [getattr(each, name, 0) for each in rows], name


@pytest.mark.parametrize(
    "options", [{}, {"chunk_size": 900, "compression": CompressionType.LZ4}, {"use_chunking": False}]
)
@pytest.mark.parametrize("changes", [(same, reversed_numbers), (reversed_numbers, same)])
def test_two_schemas_of_one_name_on_one_topic(tmp_path, steps, changes, options):
    path = written(tmp_path / "a.mcap", steps, changes, np.random.default_rng(0), **options)
    check(path)
    assert trials(path)["reward"].tolist() == steps.reward.reshape(TRIALS, -1).sum(axis=1).tolist()


@pytest.mark.parametrize("seed", range(8))
def test_schemas_of_any_make_are_read_as_the_stock_decoder_reads_them(tmp_path, steps, seed):
    rng = np.random.default_rng(seed)
    check(written(tmp_path / "a.mcap", steps, [any_change(rng) for _ in range(3)], rng, chunk_size=2000))


@pytest.mark.parametrize("where", ["outside", "in the chunk", "loose"])
def test_a_channel_that_is_declared_anew_has_its_new_schema_from_there_on(tmp_path, steps, where):
    ours, theirs = changed(same), changed(reversed_numbers)
    records = []
    for number, (data, step_class) in enumerate((ours, theirs, ours)):
        rows = range(number * ROWS // 3, (number + 1) * ROWS // 3)
        definitions = raw.schema(1, data=data) + raw.channel(1) + raw.channel(2, "/trial", 3)
        definitions += raw.schema(3, "visitlab.Trial")
        messages = b"".join(
            raw.message(1, step_class(**values_of(steps, row, step_class)).SerializeToString(), row) for row in rows
        )
        records.append(
            raw.chunk(definitions + messages)
            if where == "in the chunk"
            else definitions + (messages if where == "loose" else raw.chunk(messages))
        )
    path = tmp_path / "a.mcap"
    path.write_bytes(raw.whole(raw.HEADER, raw.metadata("visitlab", task="visit"), *records))
    for _ in range(2):
        for name, values in read_steps(path).items():
            np.testing.assert_array_equal(values, getattr(steps, name), err_msg=name)
        path.write_bytes(path.read_bytes()[:-20])
        path = recover(path).path


def one_step(path, definitions, data):
    path.write_bytes(raw.whole(raw.HEADER, raw.chunk(definitions + raw.message(1, data, 0))))
    return path


@pytest.mark.parametrize(
    ("definitions", "words"),
    [
        (raw.channel(1, schema_number=0), "messages of /step, on channel 1, have no schema"),
        (raw.channel(1, schema_number=0, encoding="json"), "messages of /step are 'json', only protobuf is read"),
        (
            raw.schema(1, encoding="jsonschema") + raw.channel(1),
            "schema of /step is 'jsonschema', only protobuf is read",
        ),
    ],
)
def test_messages_that_are_not_read_are_never_left_out_silently(tmp_path, steps, definitions, words):
    data = json.dumps({"trial": 0}).encode()
    with pytest.raises(RunError, match=rf"^[^\n]+a.mcap: [^\n]*{words}$"):
        read_steps(one_step(tmp_path / "a.mcap", definitions, data))


IMPOSSIBLE = [
    ("DOUBLE", 3.7, "3.7"),
    ("DOUBLE", 1e300, "1e+300"),
    ("DOUBLE", float("nan"), "nan"),
    ("DOUBLE", float("-inf"), "-inf"),
    ("SINT32", -1, "-1"),
    ("INT64", 1 << 32, "4294967296"),
    ("UINT64", (1 << 64) - 1, "18446744073709551615"),
    ("BOOL", True, "true"),
    ("STRING", "3", "'3'"),
    ("BYTES", b"3", "b'3'"),
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["robot_row", "trial", "step", "action", "distance"])
@pytest.mark.parametrize(("kind", "value", "words"), IMPOSSIBLE)
def test_what_no_integer_field_can_have_is_one_line(tmp_path, name, kind, value, words):
    def change(message):
        field = next(field for field in message.field if field.name == name)
        field.type = getattr(FieldDescriptorProto, f"TYPE_{kind}")
        field.ClearField("type_name")

    data, step_class = changed(change)
    log = one_step(
        tmp_path / "a.mcap", raw.schema(1, data=data) + raw.channel(1), step_class(**{name: value}).SerializeToString()
    )
    with pytest.raises(
        RunError, match=rf"^[^\n]+a.mcap: step \S+ of trial \S+ has {name} \S+, which there is not$"
    ) as told:
        read_steps(log)
    assert f"{name} {words}," in str(told.value)
    with pytest.raises(RunError, match=r"a.mcap: is whole, there is nothing to recover: step [^\n]+$"):
        recover(log)


@pytest.mark.filterwarnings("error")
def test_a_reward_that_no_float_holds_is_one_line(tmp_path):
    def change(message):
        next(field for field in message.field if field.name == "reward").type = FieldDescriptorProto.TYPE_DOUBLE

    data, step_class = changed(change)
    log = one_step(
        tmp_path / "a.mcap", raw.schema(1, data=data) + raw.channel(1), step_class(reward=1e300).SerializeToString()
    )
    with pytest.raises(RunError, match=r"a.mcap: step 0 of trial 0 has reward 1e\+300, which there is not$"):
        read_steps(log)


def test_a_value_in_two_bytes_is_no_value_of_our_layout(tmp_path, steps):
    """Bytes that have our length and tags, but are another message: a varint that goes on in the next tag."""
    data = serialized(message_class("Step"), "visit", steps, 0)
    place = data.index(bytes([20 << 3 & 127 | 128, 1])) + 2  # the last field's value
    log = tmp_path / "a.mcap"
    definitions = raw.schema(1) + raw.channel(1) + raw.schema(2, "visitlab.Trial") + raw.channel(2, "/trial")
    content = raw.message(1, data[:place] + b"\x85" + data[place + 1 :], 0)
    log.write_bytes(raw.whole(raw.HEADER, raw.metadata("visitlab", task="visit"), definitions, raw.chunk(content)))
    with pytest.raises(RunError, match="a message of /step is damaged"):
        read_steps(log)


def test_a_trial_that_is_there_twice_is_said_to_be(tmp_path, steps):
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start()
    channel = writer.register_channel(
        "/step", "protobuf", writer.register_schema("visitlab.Step", "protobuf", changed(same)[0])
    )
    for row in (*range(ROWS), *range(TRIAL_STEPS + 1)):
        writer.add_message(channel, row, serialized(message_class("Step"), "visit", steps, row), row)
    writer.finish()
    log = tmp_path / "a.mcap"
    log.write_bytes(stream.getvalue())
    with pytest.raises(RunError, match="a.mcap: trial 0 is there 2 times, and nothing tells which is meant$"):
        read_trial(log, 0)
    assert read_trial(log, 1)["step"].tolist() == list(range(TRIAL_STEPS + 1))
