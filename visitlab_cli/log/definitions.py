"""The schemas and channels of a file as they hold at a place in it: each message is read by its own."""

from collections.abc import Iterable, Iterator, Mapping

from google.protobuf.descriptor_pb2 import FileDescriptorProto, FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import DecodeError
from google.protobuf.message_factory import GetMessageClass
from mcap.records import Channel, Schema
from mcap.well_known import MessageEncoding, SchemaEncoding

from visitlab_cli.log.decoding import MessageKind, RefusedError
from visitlab_cli.log.layout import STEP_CHANNEL, TRIAL_CHANNEL
from visitlab_cli.log.schema import PACKAGE, STEP, STEP_TOPIC, TRIAL, TRIAL_TOPIC, Parts, message_descriptor, parts_in
from visitlab_cli.log.source import DamagedError
from visitlab_cli.world.columns import SOME_CELLS

OURS = ((STEP_CHANNEL, STEP_TOPIC, STEP), (TRIAL_CHANNEL, TRIAL_TOPIC, TRIAL))
TOPICS = {topic: message for _, topic, message in OURS}


class Definitions:
    """Schemas and channels by their numbers, as the file has defined them so far.

    What it has not defined yet is looked up in `elsewhere`, the definitions at other places of the file.
    """

    def __init__(self, elsewhere: "Definitions | None" = None) -> None:
        self.schemas: dict[int, Schema] = {}
        self.channels: dict[int, Channel] = {}
        self._elsewhere = elsewhere
        self._kinds: dict[int, MessageKind | None] = {}
        self._made: dict[tuple[str, str, bytes], MessageKind] = elsewhere._made if elsewhere else {}
        self._ours: bool | None = None

    def copied(self, elsewhere: "Definitions") -> "Definitions":
        """The same definitions by themselves, with others to look up what they lack."""
        copy = Definitions(elsewhere)
        copy.schemas, copy.channels = dict(self.schemas), dict(self.channels)
        return copy

    def learn(self, definition: Schema | Channel) -> None:
        """Take note of a schema or channel, in the place of one of the same number."""
        known: dict[int, Schema] | dict[int, Channel]
        known = self.schemas if isinstance(definition, Schema) else self.channels
        if known.get(definition.id) != definition:
            known[definition.id] = definition  # type: ignore[assignment]
            self._kinds.clear()
            self._ours = None

    def channel(self, number: int) -> Channel | None:
        """The channel of a number."""
        found = self.channels.get(number)
        return self._elsewhere.channel(number) if found is None and self._elsewhere else found

    def schema(self, number: int) -> Schema | None:
        """The schema of a number; 0 is none."""
        found = self.schemas.get(number) if number else None
        return self._elsewhere.schema(number) if number and found is None and self._elsewhere else found

    def has_topic(self, topic: str) -> bool:
        """Whether a channel of a topic is defined whose messages are protobuf."""
        own = any(
            channel.topic == topic and channel.message_encoding == MessageEncoding.Protobuf
            for channel in self.channels.values()
        )
        return own or (self._elsewhere is not None and self._elsewhere.has_topic(topic))

    @property
    def parts(self) -> Parts:
        """Those of `SOME_CELLS` that the log has: for which its steps have fields."""
        schemas = [self.schema(channel.schema_id) for channel in self.channels.values() if channel.topic == STEP_TOPIC]
        own = parts_in([name for schema in schemas if schema is not None for name in _names_in(schema)])
        return own or (self._elsewhere.parts if self._elsewhere is not None else ())

    @property
    def are_ours(self) -> bool:
        """Whether our two channels have our numbers, and schemas with the fields that we give them."""
        if self._ours is None:
            self._ours = all(self._is_ours(*each) for each in OURS)
        return self._ours

    def _is_ours(self, number: int, topic: str, message: str) -> bool:
        channel = self.channel(number)
        if channel is None or (channel.topic, channel.message_encoding) != (topic, MessageEncoding.Protobuf):
            return False
        schema = self.schema(channel.schema_id)
        if schema is None or (schema.name, schema.encoding) != (f"{PACKAGE}.{message}", SchemaEncoding.Protobuf):
            return False
        theirs = [
            [(field.name, field.number, field.type, field.label) for field in declared.field]
            for file in _files(schema)
            for declared in file.message_type
            if f"{file.package}.{declared.name}" == schema.name
        ]
        least, most = (
            {(field.name, field.number, field.type, field.label) for field in message_descriptor(message, parts).field}
            for parts in ((), SOME_CELLS)
        )
        return len(theirs) == 1 and len(theirs[0]) == len(set(theirs[0])) and least <= set(theirs[0]) <= most

    def kind_of(self, number: int) -> MessageKind | None:
        """What the messages of a channel are, None where they are no steps and no trials.

        Raises:
            DamagedError: the channel or its schema is missing, or invalid.
            RefusedError: its messages are of another encoding, or have no schema.
        """
        if number not in self._kinds:
            self._kinds[number] = self._kind(number)
        return self._kinds[number]

    def _kind(self, number: int) -> MessageKind | None:
        channel = self.channel(number)
        if channel is None:
            raise DamagedError(f"a message is of channel {number}, which nothing declares")
        if channel.topic not in TOPICS:
            return None
        if channel.message_encoding != MessageEncoding.Protobuf:
            raise RefusedError(f"messages of {channel.topic} are {channel.message_encoding!r}, only protobuf is read")
        if not channel.schema_id:
            raise RefusedError(f"messages of {channel.topic}, on channel {number}, have no schema")
        schema = self.schema(channel.schema_id)
        if schema is None:
            raise DamagedError(f"the schema of {channel.topic} is missing")
        if schema.encoding != SchemaEncoding.Protobuf:
            raise RefusedError(f"the schema of {channel.topic} is {schema.encoding!r}, only protobuf is read")
        key = channel.topic, schema.name, schema.data
        if key not in self._made:
            try:
                pool = DescriptorPool()
                for file in _in_order(_files(schema)):
                    pool.Add(file)
                found = GetMessageClass(pool.FindMessageTypeByName(schema.name))
            except (KeyError, TypeError, RecursionError) as error:
                raise DamagedError(f"the schema of {channel.topic} is invalid") from error
            self._made[key] = MessageKind(channel.topic, found, TOPICS[channel.topic])
        return self._made[key]


def _names_in(schema: Schema) -> list[str]:
    """The names of the fields of a schema's message; none where it can't be read."""
    try:
        messages = [each for file in FileDescriptorSet.FromString(schema.data).file for each in file.message_type]
    except DecodeError:
        return []
    name = schema.name.rpartition(".")[2]
    return [field.name for message in messages if message.name == name for field in message.field]


def known_fields(data: bytes) -> int:
    """How many of the fields that we know the content of a schema has, as we have them."""
    try:
        files = FileDescriptorSet.FromString(data).file
    except DecodeError:
        return -1
    theirs = {
        (declared.name, field.name, field.number, field.type)
        for file in files
        for declared in file.message_type
        for field in declared.field
    }
    ours = ((message, field) for _, _, message in OURS for field in message_descriptor(message, SOME_CELLS).field)
    return sum((message, field.name, field.number, field.type) in theirs for message, field in ours)


def _files(schema: Schema) -> list[FileDescriptorProto]:
    try:
        return list(FileDescriptorSet.FromString(schema.data).file)
    except DecodeError as error:
        raise DamagedError(f"the schema {schema.name!r} is damaged") from error


def _in_order(files: Iterable[FileDescriptorProto]) -> Iterator[FileDescriptorProto]:
    """Each file after those that it imports, as far as these are there."""
    waiting: Mapping[str, FileDescriptorProto] = {file.name: file for file in files}
    done: set[str] = set()

    def after_imports(name: str) -> Iterator[FileDescriptorProto]:
        if name in waiting and name not in done:
            done.add(name)
            for dependency in waiting[name].dependency:
                yield from after_imports(dependency)
            yield waiting[name]

    for name in waiting:
        yield from after_imports(name)
