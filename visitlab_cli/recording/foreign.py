"""Logs of other writers: messages decoded one by one with the schemas that the file carries.

Any layout, compression and order of fields will do. A field that a message lacks has protobuf's default, 0.
"""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from google.protobuf.descriptor_pb2 import FileDescriptorProto, FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import DecodeError
from google.protobuf.message_factory import GetMessageClass
from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import breakup_chunk
from mcap.well_known import MessageEncoding, SchemaEncoding

from visitlab_cli.recording.layout import Layout, Records
from visitlab_cli.recording.schema import STEP, STEP_TOPIC, TRIAL, TRIAL_TOPIC, message_descriptor
from visitlab_cli.recording.source import PARSE_ERRORS, DamagedError
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT, columns_of

TOPICS = {STEP_TOPIC: STEP, TRIAL_TOPIC: TRIAL}


class Decoded(NamedTuple):
    """A message and the time of its record, in ns."""

    log_time: int
    message: Any


class Definitions:
    """The schemas and channels that a file defines, outside of its chunks or in them."""

    def __init__(self) -> None:
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self._classes: dict[int, Any] = {}

    def learn(self, record: object) -> None:
        """Take note of a record, if it defines something."""
        if isinstance(record, Schema):
            self.schemas[record.id] = record
        elif isinstance(record, Channel):
            self.channels[record.id] = record

    def channel_of(self, topic: str) -> Channel | None:
        """The first channel of a topic that is protobuf."""
        for channel in self.channels.values():
            if channel.topic == topic and channel.message_encoding == MessageEncoding.Protobuf:
                return channel
        return None

    def are_ours(self, message: str, channel: Channel) -> bool:
        """Whether a channel's schema gives the fields of `message` the numbers and types that we give them."""
        schema = self.schemas.get(channel.schema_id)
        if schema is None or schema.encoding != SchemaEncoding.Protobuf:
            return False
        theirs = {
            (field.name, field.number, field.type)
            for file in _files(schema)
            for declared in file.message_type
            if f"{file.package}.{declared.name}".lstrip(".") == schema.name
            for field in declared.field
        }
        return theirs == {(field.name, field.number, field.type) for field in message_descriptor(message).field}

    def message_class(self, channel: Channel) -> Any:
        """The protobuf class of a channel's messages.

        Raises:
            DamagedError: the file has no such schema, or an invalid one.
        """
        if channel.id not in self._classes:
            schema = self.schemas.get(channel.schema_id)
            try:
                if schema is None:
                    raise KeyError(channel.schema_id)
                pool = DescriptorPool()
                for file in _in_order(_files(schema)):
                    pool.Add(file)
                found = pool.FindMessageTypeByName(schema.name)
            except (KeyError, TypeError) as error:
                raise DamagedError(f"the schema of {channel.topic} is missing or invalid") from error
            self._classes[channel.id] = GetMessageClass(found)
        return self._classes[channel.id]


def _files(schema: Schema) -> list[FileDescriptorProto]:
    try:
        return list(FileDescriptorSet.FromString(schema.data).file)
    except DecodeError as error:
        raise DamagedError(f"the schema {schema.name} is damaged") from error


def _in_order(files: Iterable[FileDescriptorProto]) -> Iterator[FileDescriptorProto]:
    """Each file after those that it imports, as far as these are there."""
    waiting = {file.name: file for file in files}

    def after_imports(name: str) -> Iterator[FileDescriptorProto]:
        file = waiting.pop(name, None)
        if file is not None:
            for dependency in file.dependency:
                yield from after_imports(dependency)
            yield file

    while waiting:
        yield from after_imports(next(iter(waiting)))


def decode(content: bytes, definitions: Definitions) -> dict[str, list[Decoded]]:
    """The messages of `content`, the records of a chunk, by topic; what the chunk defines is learnt.

    Raises:
        DamagedError: a record or message is invalid.
    """
    found: dict[str, list[Decoded]] = {topic: [] for topic in TOPICS}
    try:
        for record in breakup_chunk(Chunk("", content, 0, 0, 0, len(content))):
            definitions.learn(record)
            if isinstance(record, Message) and (channel := definitions.channels.get(record.channel_id)):
                is_protobuf = channel.message_encoding == MessageEncoding.Protobuf
                if channel.topic in found and is_protobuf:
                    message = definitions.message_class(channel)()
                    message.ParseFromString(record.data)
                    found[channel.topic].append(Decoded(record.log_time, message))
    except (*PARSE_ERRORS, DecodeError) as error:
        raise DamagedError("a message is damaged") from error
    return found


def as_records(decoded: list[Decoded], layout: Layout) -> Records:
    """Messages as records of our `layout`.

    Raises:
        DamagedError: a value is none that the field can have.
    """
    records = layout.blank(len(decoded))
    if not decoded:
        return records
    records["log_time"] = [each.log_time for each in decoded]
    present = {field.name for field in type(decoded[0].message).DESCRIPTOR.fields}
    for name in layout.fields:
        if name in present:
            try:
                records[name] = [getattr(each.message, name) for each in decoded]
            except (OverflowError, ValueError, TypeError) as error:
                raise DamagedError(f"a message has an impossible {name}") from error
    return records


def task_of(messages: Iterable[Any]) -> str:
    """The task whose columns the steps of a log without metadata have."""
    names = {field.name for message in messages for field, _ in message.ListFields()}
    for task, less in ((VISIT, SOCIAL), (SOCIAL, GO_TO_HUMAN), (GO_TO_HUMAN, NAVIGATION)):
        if names & (_names(task) - _names(less) - _names(NAVIGATION)):
            return task
    return NAVIGATION


def _names(task: str) -> set[str]:
    return {column.name for column in columns_of(task)}
