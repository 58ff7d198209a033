"""Salvage: the whole records of a damaged file, copied into a new one.

Records are copied as they are, messages outside of chunks are put into chunks; what can be derived (indexes, times of
chunks, summary, CRCs) is made anew. Schemas and channels are taken from the summary where that is whole.
"""

import struct
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from mcap.opcode import Opcode
from mcap.records import AttachmentIndex, Channel, Chunk, Footer, Metadata, Schema

from visitlab_cli.log.attachments import Attached
from visitlab_cli.log.chunks import Record, definition_in, records_in
from visitlab_cli.log.definitions import Definitions, known_fields
from visitlab_cli.log.foreign import MESSAGE_HEAD
from visitlab_cli.log.log import RUN_OF_MESSAGES, TASK, readable
from visitlab_cli.log.mcap_file import INDEX_ENTRY, IndexEntries, McapFile
from visitlab_cli.log.recovery.whole_records import ANOTHER_FILE, KINDS, Whole, whole_records
from visitlab_cli.log.schema import METADATA_NAME, PACKAGE, STEP, TRIAL
from visitlab_cli.log.source import (
    MAGIC,
    PREFIX,
    DamagedError,
    McapSource,
    NotMcapError,
    Place,
    has_data_crc,
    has_summary_crc,
    walk,
)
from visitlab_cli.world.tasks import TASK_NAMES

_FOOTER_SIZE = PREFIX.size + struct.calcsize("<QQI")
_DERIVED = {*KINDS, Opcode.MESSAGE_INDEX}


class Content(NamedTuple):
    """What a chunk holds: where its messages are, by their channel, and the schemas and channels it defines."""

    indexes: dict[int, IndexEntries]
    definitions: list[Schema | Channel]


class Salvage:
    """Copies what is whole of `source` to `target`, up to its end or to where another file begins.

    Then `lost_bytes` belong to no whole record, `was_whole` says that there was nothing to mend, `end` where it
    ended, `has_messages` whether it has any.
    `each_message`: messages that cannot be read are left out, each of them is looked at.
    """

    def __init__(self, source: McapSource, target: McapFile, *, each_message: bool = False):
        self._source, self._target, self._each_message = source, target, each_message
        self._summary, self._is_summary_right = _summary_definitions(source)
        self._redeclared, self._copies = _declared(source)
        self._defined = Definitions()
        self._late: list[Schema | Channel] = []
        self._loose = bytearray()
        self._data_ends: list[Place] = []
        self._has_footer = False
        self.lost_bytes = 0
        self.was_whole = self.has_messages = False
        self.end = source.size

    def run(self) -> None:
        """Copy everything."""
        end = len(MAGIC)
        for whole in whole_records(self._source):
            self.lost_bytes += max(whole.place.start - end, 0)
            end = whole.place.end
            if whole.place.opcode == ANOTHER_FILE:
                self.end = end
                break
            try:
                self._copy(whole)
            except DamagedError:
                self.lost_bytes += end - whole.place.start
        else:
            has_lost = not self._data_ends or self._has_footer  # else what is cut is the summary
            self.lost_bytes += max(self._source.size - end, 0) if has_lost else 0
        self._write_loose()
        for late in self._late:
            if (self._defined.schema if isinstance(late, Schema) else self._defined.channel)(late.id) is None:
                self._define(late)
        self.was_whole = self.lost_bytes == 0 and self.end == self._source.size and self._is_sound()

    def _copy(self, whole: Whole) -> None:
        """Append a record to the copy, if it is none of those that are made anew."""
        place, record = whole.place, whole.record
        if place.opcode == Opcode.MESSAGE:
            self._loose += self._source.read(place.start, place.end)
            if len(self._loose) > RUN_OF_MESSAGES:
                self._write_loose()
        elif isinstance(record, Chunk):
            self._write_loose()
            self._copy_chunk(record, whole.content)
        elif isinstance(record, Schema | Channel):
            if self._data_ends:
                self._late.append(record)  # of the summary, if no message follows
            else:
                self._write_loose()
                self._define(record)
        elif isinstance(record, Attached):
            index = AttachmentIndex(
                0, 0, record.log_time, record.create_time, record.end - record.start, record.name, record.media_type
            )
            self._target.copy(self._record(place), attachment=index)
        elif isinstance(record, Metadata):
            if record.name == METADATA_NAME and record.metadata.get(TASK) not in TASK_NAMES:
                raise DamagedError("names no task")
            self._target.copy(self._record(place), metadata=record.name)
        elif place.opcode == Opcode.DATA_END:
            self._data_ends.append(place)
        elif place.opcode == Opcode.FOOTER:
            self._has_footer = True
        elif place.opcode not in _DERIVED:
            self._target.copy(self._record(place))

    def _record(self, place: Place) -> Iterator[bytes]:
        """The bytes of a record, its length as its place has it."""
        yield PREFIX.pack(place.opcode, place.end - place.start - PREFIX.size)
        yield from self._source.windows(place.start + PREFIX.size, place.end)

    def _write_loose(self) -> None:
        if self._loose:
            content = bytes(self._loose)
            self._loose.clear()
            self._copy_chunk(None, content)

    def _copy_chunk(self, chunk: Chunk | None, content: bytes) -> None:
        """Append a chunk as it is, or else its content; everything that it needs is defined before it."""
        for late in self._late:
            self._define(late)
        self._late.clear()
        if self._each_message and not readable(content, self._next_definitions()):
            kept = self._readable_messages(content)
            self.lost_bytes += len(content) - len(kept)
            chunk, content = None, kept
        examined = _examined(content)
        self.has_messages = self.has_messages or bool(examined.indexes)
        for definition in examined.definitions:
            self._define(definition, in_chunk=True)
        for schema in self._summary.schemas.values():
            if self._defined.schema(schema.id) is None:
                self._define(schema)
        for channel in self._summary.channels.values():
            if self._defined.channel(channel.id) is None:
                self._define(channel)
        if chunk is not None:
            self._target.copy_chunk(chunk, examined.indexes)
        elif content:
            self._target.write_content(content, examined.indexes)

    def _next_definitions(self) -> Definitions:
        """What is defined before the next chunk, to be changed by it."""
        return self._defined.copied(self._summary)

    def _readable_messages(self, content: bytes) -> bytes:
        """The records of a chunk without the messages that cannot be read."""
        definitions, kept = self._next_definitions(), bytearray()
        for record in records_in(content):
            own = content[record.start : record.end]
            if record.opcode != Opcode.MESSAGE or readable(own, definitions):
                kept += own
            if (definition := definition_in(content, record)) is not None:
                definitions.learn(definition)
        return bytes(kept)

    def _define(self, definition: Schema | Channel, *, in_chunk: bool = False) -> None:
        """Define a schema or channel, as the summary has it where no CRC covers it; nothing if it is so defined."""
        found = self._defined.schemas if isinstance(definition, Schema) else self._defined.channels
        as_in_summary = self._summary.schemas if isinstance(definition, Schema) else self._summary.channels
        if self._is_summary_right and not in_chunk and (type(definition), definition.id) not in self._redeclared:
            definition = as_in_summary.get(definition.id, definition)
        elif isinstance(definition, Schema) and not in_chunk and definition.data in self._copies:
            definition = replace(definition, data=max(self._copies, key=known_fields))
        if found.get(definition.id) != definition:
            self._defined.learn(definition)
            self._target.define(definition, in_chunk=in_chunk)

    def _is_sound(self) -> bool:
        """Whether the data's CRC is right or left out, and the summary whole."""
        try:
            frame = all(True for _ in walk(self._source))
            return frame and bool(self._data_ends) and all(has_data_crc(self._source, end) for end in self._data_ends)
        except (DamagedError, NotMcapError):
            return False


def _summary_definitions(source: McapSource) -> tuple[Definitions, bool]:
    """The schemas and channels of the summary, and whether its CRC says that they are right."""
    found = Definitions()
    start = source.size - len(MAGIC) - _FOOTER_SIZE
    try:
        place = source.place_at(max(start, 0))
        footer = source.parse(Footer, place) if place.opcode == Opcode.FOOTER else None
        if footer is None or not has_summary_crc(source, footer, place):
            return found, False
        position = footer.summary_start
        while 0 < position < place.start:
            record = source.place_at(position)
            if record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                found.learn(source.definition(record))
            position = record.end
    except DamagedError:
        return Definitions(), False
    return found, bool(footer.summary_crc)


def _declared(source: McapSource) -> tuple[set[tuple[type, int]], list[bytes]]:
    """What is defined outside of chunks: what twice and not alike, by kind and number; and copies of one schema.

    We write the same schema for steps and for trials; if bytes of one were changed the other still has them.
    """
    ours: dict[str, list[bytes]] = {f"{PACKAGE}.{message}": [] for message in (STEP, TRIAL)}
    known: dict[tuple[type, int], Schema | Channel] = {}
    twice = set()
    position = len(MAGIC)
    try:
        while (place := source.place_at(position)).opcode != Opcode.DATA_END:
            position = place.end
            if place.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                record = source.definition(place)
                if known.setdefault((type(record), record.id), record) != record:
                    twice.add((type(record), record.id))
                if isinstance(record, Schema) and record.name in ours:
                    ours[record.name].append(record.data)
    except DamagedError:
        pass  # so far as it goes
    copies = [data for each in ours.values() for data in each]
    are_copies = all(len(each) == 1 for each in ours.values()) and len({len(data) for data in copies}) == 1
    return twice, copies if are_copies else []


def _examined(content: bytes) -> Content:
    """What the records of a chunk are.

    Raises:
        DamagedError: they do not fill it.
    """
    messages: dict[int, list[tuple[int, int]]] = {}
    definitions: list[Schema | Channel] = []
    for record in records_in(content):
        if record.opcode == Opcode.MESSAGE:
            _check_head(record)
            channel, _, log_time, _ = MESSAGE_HEAD.unpack_from(content, record.body)
            messages.setdefault(channel, []).append((log_time, record.start))
        elif (definition := definition_in(content, record)) is not None:
            definitions.append(definition)
    return Content({channel: np.array(places, INDEX_ENTRY) for channel, places in messages.items()}, definitions)


def _check_head(record: Record) -> None:
    if record.end - record.body < MESSAGE_HEAD.size:
        raise DamagedError("a message is cut")
