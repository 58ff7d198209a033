"""Salvage: the whole records of a damaged file, copied into a new one.

Chunks are copied as they are, messages outside of chunks are put into chunks; what can be derived (indexes, times of
chunks, summary, CRCs) is made anew. Schemas and channels are taken from the summary where that is whole.
"""

import io
import struct
from typing import NamedTuple

import numpy as np
from mcap.data_stream import ReadDataStream
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, Chunk, DataEnd, Footer, McapRecord, Metadata, Schema

from visitlab_cli.recording.foreign import Definitions
from visitlab_cli.recording.log import RUN_OF_MESSAGES, TASK
from visitlab_cli.recording.mcap_file import INDEX_ENTRY, IndexEntries, McapFile
from visitlab_cli.recording.schema import METADATA_NAME
from visitlab_cli.recording.source import (
    MAGIC,
    PARSE_ERRORS,
    PREFIX,
    DamagedError,
    McapSource,
    NotMcapError,
    Place,
    chunk_content,
    has_data_crc,
    has_summary_crc,
    walk,
)
from visitlab_cli.recording.whole_records import whole_records
from visitlab_cli.world.tasks import TASK_NAMES

_MESSAGE_HEAD = struct.Struct("<HIQ")  # channel, sequence, log time
_FOOTER_SIZE = PREFIX.size + struct.calcsize("<QQI")


class Content(NamedTuple):
    """What a chunk holds: where its messages are, by their channel, and the schemas and channels it defines."""

    indexes: dict[int, IndexEntries]
    definitions: list[Schema | Channel]


class Salvage:
    """Copies what is whole of `source` to `target`; `lost_bytes` and `was_whole` then tell of the rest."""

    def __init__(self, source: McapSource, target: McapFile):
        self._source, self._target = source, target
        self._summary = _summary_definitions(source)
        self._defined = Definitions()
        self._loose = bytearray()
        self.lost_bytes = 0
        self.was_whole = False

    @property
    def topics(self) -> set[str]:
        """The topics that the copy describes."""
        return {channel.topic for channel in self._defined.channels.values()}

    def run(self) -> None:
        """Copy everything up to the end of the data."""
        end = len(MAGIC)
        for place, record in whole_records(self._source):
            self.lost_bytes += place.start - end
            end = place.end
            if place.opcode == Opcode.MESSAGE:
                self._loose += self._source.read(place.start, place.end)
            if place.opcode != Opcode.MESSAGE or len(self._loose) > RUN_OF_MESSAGES:
                self._write_loose()
            if isinstance(record, DataEnd):
                self.was_whole = self.lost_bytes == 0 and _is_sound(self._source, place)
                return
            try:
                self._copy(place, record)
            except DamagedError:
                self.lost_bytes += place.end - place.start
        self._write_loose()
        self.lost_bytes += self._source.size - end

    def _copy(self, place: Place, record: McapRecord | None) -> None:
        """Append a record to the copy, if it is none of those that are made anew."""
        if isinstance(record, Chunk):
            content = _examined(chunk_content(record, place))
            self._define_all(content)
            self._target.copy_chunk(record, content.indexes)
        elif isinstance(record, Schema | Channel):
            self._define(record)
        elif isinstance(record, Attachment):
            self._target.copy_attachment(record)
        elif isinstance(record, Metadata):
            if record.name == METADATA_NAME and record.metadata.get(TASK) not in TASK_NAMES:
                raise DamagedError("names no task")
            self._target.write_metadata(record.name, record.metadata)

    def _write_loose(self) -> None:
        if self._loose:
            content = bytes(self._loose)
            examined = _examined(content)
            self._define_all(examined)
            self._target.write_content(content, examined.indexes)
            self._loose.clear()

    def _define_all(self, content: Content) -> None:
        """See that everything is defined before a chunk is written: by it, or else as the summary has it."""
        for definition in content.definitions:
            self._define(definition, in_chunk=True)
        for schema in self._summary.schemas.values():
            self._define(schema)
        for channel in self._summary.channels.values():
            self._define(channel)

    def _define(self, definition: Schema | Channel, *, in_chunk: bool = False) -> None:
        """Define a schema or channel that is not defined yet, as the summary has it."""
        if isinstance(definition, Schema):
            is_known = definition.id in self._defined.schemas
            definition = self._summary.schemas.get(definition.id, definition)
        else:
            is_known = definition.id in self._defined.channels
            definition = self._summary.channels.get(definition.id, definition)
        if not is_known:
            self._defined.learn(definition)
            self._target.define(definition, in_chunk=in_chunk)


def _summary_definitions(source: McapSource) -> Definitions:
    """The schemas and channels of the summary, if its CRC says that it is whole."""
    found = Definitions()
    start = source.size - len(MAGIC) - _FOOTER_SIZE
    try:
        place = source.place_at(max(start, 0))
        footer = source.parse(Footer, place)
        if place.opcode != Opcode.FOOTER or not footer.summary_crc or not has_summary_crc(source, footer, place):
            return found
        position = footer.summary_start
        while 0 < position < place.start:
            record = source.place_at(position)
            if record.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                found.learn(source.parse(Schema if record.opcode == Opcode.SCHEMA else Channel, record))
            position = record.end
    except DamagedError:
        return Definitions()
    return found


def _examined(content: bytes) -> Content:
    """What the records of a chunk are.

    Raises:
        DamagedError: they do not fill it.
    """
    messages: dict[int, list[tuple[int, int]]] = {}
    definitions: list[Schema | Channel] = []
    position = 0
    try:
        while position < len(content):
            opcode, length = PREFIX.unpack_from(content, position)
            body = position + PREFIX.size
            if opcode == Opcode.MESSAGE:
                channel, _, log_time = _MESSAGE_HEAD.unpack_from(content, body)
                messages.setdefault(channel, []).append((log_time, position))
            elif opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                kind = Schema if opcode == Opcode.SCHEMA else Channel
                definitions.append(kind.read(ReadDataStream(io.BytesIO(content[body : body + length]))))
            position = body + length
    except PARSE_ERRORS as error:
        raise DamagedError("a record in a chunk is damaged") from error
    if position != len(content):
        raise DamagedError("the last record of a chunk is cut")
    return Content({channel: np.array(places, INDEX_ENTRY) for channel, places in messages.items()}, definitions)


def _is_sound(source: McapSource, data_end: Place) -> bool:
    """Whether the data's CRC is right or left out, and the summary whole."""
    try:
        return has_data_crc(source, data_end) and all(True for _ in walk(source))
    except (DamagedError, NotMcapError):
        return False
