"""Logs with the schema of visitlab that other programs wrote, as they write them."""

import io

import numpy as np
import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from mcap.writer import CompressionType, IndexType
from mcap.writer import Writer as PlainWriter
from mcap_protobuf.schema import register_schema
from mcap_protobuf.writer import Writer

from visitlab_cli.errors import NotFoundError, RunError
from visitlab_cli.log.reader import iter_steps, read_metadata, read_steps, read_trial, trials
from visitlab_cli.log.recovery.recovery import recover
from visitlab_cli.log.schema import file_descriptor
from visitlab_cli.world.tasks import TASK_NAMES, columns_of

from .blocks import ATTRIBUTES, message_class, random_steps, record

TRIALS, TRIAL_STEPS = 6, 20
ROWS = TRIALS * (TRIAL_STEPS + 1)
SECOND = 10**9
WAYS = {
    "chunks": {},
    "small chunks, lz4": {"chunk_size": 900, "compression": CompressionType.LZ4},
    "not compressed": {"chunk_size": 900, "compression": CompressionType.NONE},
    "no chunks": {"use_chunking": False},
    "no index": {"chunk_size": 900, "index_types": IndexType.NONE},
    "nothing repeated": {"repeat_channels": False, "repeat_schemas": False, "use_statistics": False},
    "no CRCs, no offsets": {"enable_crcs": False, "use_summary_offsets": False},
    "data CRC": {"enable_data_crcs": True},
}


@pytest.fixture(scope="module")
def steps():
    return random_steps(TRIALS, TRIAL_STEPS)[0]


def other_class(change):
    """The class `Step` of a schema that was changed before it was compiled."""
    descriptor = file_descriptor()
    change(descriptor)
    pool = DescriptorPool()
    pool.Add(descriptor)
    return GetMessageClass(pool.FindMessageTypeByName("visitlab.Step"))


class ProtobufWriter:
    """What `mcap_protobuf.writer.Writer` does, with all the options of the writer below it."""

    def __init__(self, file, **options):
        self.plain = PlainWriter(file, **options)
        self.plain.start()
        self.channels = {}

    def write_message(self, topic, message, log_time):
        if topic not in self.channels:
            schema = register_schema(self.plain, type(message))
            self.channels[topic] = self.plain.register_channel(topic, "protobuf", schema)
        self.plain.add_message(self.channels[topic], log_time, message.SerializeToString(), log_time)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.plain.finish()


def write(path, steps, task, step=None, with_trials=False, metadata=None, missing=(), **options):
    step, trial = step or message_class("Step"), message_class("Trial")
    names = [column.name for column in columns_of(task) if column.name not in missing]
    with path.open("wb") as file, ProtobufWriter(file, **options) as writer:
        for row in range(ROWS):
            values = {name: getattr(steps, name)[row].item() for name in names}
            writer.write_message("/step", step(**values), row * SECOND)
            if with_trials and values["step"] == TRIAL_STEPS:
                of_trial = steps.reward[row - TRIAL_STEPS : row + 1].sum()
                first = (row - TRIAL_STEPS) * SECOND
                message = trial(trial=values["trial"], first_step_time=first, reward=of_trial, steps=TRIAL_STEPS)
                writer.write_message("/trial", message, row * SECOND)
        if metadata:
            writer.plain.add_metadata("visitlab", metadata)
    return path


def check(path, steps, task, missing=()):
    found = read_steps(path)
    assert list(found) == [column.name for column in columns_of(task)]
    for name, values in found.items():
        expected = 0 * getattr(steps, name) if name in missing else getattr(steps, name)
        np.testing.assert_array_equal(values, expected, err_msg=name)
    np.testing.assert_array_equal(np.concatenate([part["step"] for part in iter_steps(path, ["step"])]), steps.step)
    np.testing.assert_array_equal(read_trial(path, 4, ["state"])["state"], steps.state[steps.trial == 4])
    with pytest.raises(NotFoundError, match=rf"trial 9 is not recorded; the log holds 0 to {TRIALS - 1}$"):
        read_trial(path, 9)
    table = trials(path)
    assert table["trial"].tolist() == list(range(TRIALS))
    assert table["steps"].tolist() == [TRIAL_STEPS] * TRIALS
    assert table["first_step_time"].tolist() == [trial * (TRIAL_STEPS + 1) * SECOND for trial in range(TRIALS)]
    assert table["reward"].tolist() == steps.reward.reshape(TRIALS, -1).sum(axis=1).tolist()


@pytest.mark.parametrize("task", TASK_NAMES)
@pytest.mark.parametrize("with_trials", [False, True])
def test_the_task_is_seen_in_the_fields_where_no_metadata_tells(tmp_path, steps, task, with_trials):
    path = write(tmp_path / "a.mcap", steps, task, with_trials=with_trials)
    assert read_metadata(path) == {"format": "1", "task": task, "cell": "", "one_trial_in": "1"}
    check(path, steps, task)


@pytest.mark.parametrize("with_trials", [False, True])
@pytest.mark.parametrize("way", WAYS)
def test_a_file_of_any_make(tmp_path, steps, way, with_trials):
    check(write(tmp_path / "a.mcap", steps, "visit", with_trials=with_trials, **WAYS[way]), steps, "visit")


@pytest.mark.parametrize("way", WAYS)
def test_a_file_of_any_make_that_was_cut_is_recovered(tmp_path, steps, way):
    path = write(tmp_path / "a.mcap", steps, "social", **WAYS[way])
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) - 10])
    with pytest.raises(RunError, match="visitlab recover"):
        read_steps(path)
    saved = recover(path)
    assert saved.trials == TRIALS
    check(saved.path, steps, "social")


def test_a_file_of_the_protobuf_writer_itself(tmp_path, steps):
    step, path = message_class("Step"), tmp_path / "a.mcap"
    with path.open("wb") as file, Writer(file) as writer:
        for row in range(ROWS):
            values = {column.name: getattr(steps, column.name)[row].item() for column in columns_of("visit")}
            writer.write_message("/step", step(**values), log_time=row * SECOND, publish_time=row * SECOND)
    check(path, steps, "visit")


def test_metadata_of_another_writer_counts(tmp_path, steps):
    attributes = ATTRIBUTES | {"task": "social"}
    path = write(tmp_path / "a.mcap", steps, "social", missing=["human_action"], metadata=attributes)
    assert read_metadata(path) == attributes
    check(path, steps, "social", missing=["human_action"])


def test_other_numbers_and_order_of_fields(tmp_path, steps):
    def other_numbers(descriptor):
        fields = descriptor.message_type[0].field
        numbers = [field.number for field in fields]
        for field, number in zip(fields, reversed(numbers), strict=True):
            field.number = number + 20

    check(write(tmp_path / "a.mcap", steps, "visit", step=other_class(other_numbers)), steps, "visit")


def test_a_schema_whose_field_numbers_are_exchanged_is_not_taken_for_ours(tmp_path, steps):
    def exchanged(descriptor):
        fields = {field.name: field for field in descriptor.message_type[0].field}
        row, col = fields["robot_row"], fields["robot_col"]
        row.number, col.number = col.number, row.number

    path = write(tmp_path / "a.mcap", steps, "visit", step=other_class(exchanged), with_trials=True)
    check(path, steps, "visit")


def test_fields_that_are_not_optional_or_wider(tmp_path, steps):
    def plain(descriptor):
        message = descriptor.message_type[0]
        del message.oneof_decl[:]
        for field in message.field:
            field.ClearField("proto3_optional")
            field.ClearField("oneof_index")
            if field.name == "distance":
                field.type = field.TYPE_INT64

    check(write(tmp_path / "a.mcap", steps, "visit", step=other_class(plain)), steps, "visit")


def test_a_field_that_is_left_out_reads_as_zero(tmp_path, steps):
    path = write(tmp_path / "a.mcap", steps, "visit", missing=["explored", "robot_heading"])
    check(path, steps, "visit", missing=["explored", "robot_heading"])


def test_an_impossible_value_is_one_line(tmp_path, steps):
    def wider(descriptor):
        next(field for field in descriptor.message_type[0].field if field.name == "distance").type = 3

    wrong = steps._replace(distance=steps.distance.astype(np.int64) - 1000)
    path = write(tmp_path / "a.mcap", wrong, "visit", step=other_class(wider))
    with pytest.raises(RunError, match=r"^[^\n]+a.mcap: step 0 of trial 0 has distance -876, which there is not$"):
        read_steps(path)


def test_trials_in_any_order_are_found(tmp_path, steps):
    order = np.concatenate([np.flatnonzero(steps.trial == trial) for trial in (3, 0, 5, 1, 4, 2)])
    shuffled = type(steps)(*(values[order] for values in steps))
    path = write(tmp_path / "a.mcap", shuffled, "visit", chunk_size=900)
    np.testing.assert_array_equal(read_trial(path, 4)["state"], steps.state[steps.trial == 4])


def test_our_messages_chunked_by_another_writer(tmp_path, steps):
    """What `mcap filter` and the like do: the same messages, their records in other chunks and another order."""
    from mcap.reader import make_reader

    ours = record(tmp_path / "ours.mcap", "visit", steps, ROWS)
    theirs = tmp_path / "theirs.mcap"
    with ours.open("rb") as source, theirs.open("wb") as target:
        writer = PlainWriter(target, chunk_size=1500)
        writer.start()
        channels = {}
        for schema, channel, message in make_reader(source).iter_messages(log_time_order=True):
            if channel.id not in channels:
                known = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, "protobuf", known)
            own = channels[channel.id]
            writer.add_message(own, message.log_time, message.data, message.publish_time, message.sequence)
        writer.finish()
    check(theirs, steps, "visit")


@pytest.mark.parametrize("messages", [0, 3])
def test_an_mcap_file_of_something_else_is_one_line(tmp_path, messages):
    content = io.BytesIO()
    writer = PlainWriter(content)
    writer.start()
    channel = writer.register_channel("/other", "json", 0)
    for number in range(messages):
        writer.add_message(channel, number, b"{}", number)
    writer.finish()
    path = tmp_path / "a.mcap"
    path.write_bytes(content.getvalue())
    with pytest.raises(RunError, match=r"^[^\n]+a.mcap: not a log of visitlab$"):
        read_steps(path)


def test_a_schema_that_imports_is_decoded(tmp_path, steps):
    """The enums in a file of their own, as other people lay out their .proto files."""
    whole = file_descriptor()
    enums, messages = type(whole)(), type(whole)()
    enums.CopyFrom(whole)
    messages.CopyFrom(whole)
    enums.name, messages.name = "enums.proto", "messages.proto"
    del enums.message_type[:]
    del messages.enum_type[:]
    messages.dependency.append(enums.name)
    step = message_class("Step")
    path = tmp_path / "a.mcap"
    with path.open("wb") as file:
        writer = PlainWriter(file)
        writer.start()
        data = FileDescriptorSet(file=[messages, enums]).SerializeToString()
        channel = writer.register_channel(
            "/step", "protobuf", writer.register_schema("visitlab.Step", "protobuf", data)
        )
        for row in range(ROWS):
            values = {column.name: getattr(steps, column.name)[row].item() for column in columns_of("visit")}
            writer.add_message(channel, row * SECOND, step(**values).SerializeToString(), row * SECOND)
        writer.finish()
    check(path, steps, "visit")
