"""The whole records of a damaged file: those whose bytes are what their content would be written as.

After bytes that are no whole record the search goes on at the next place where one begins, whatever the lengths
in between say.
"""

import re
import struct
from collections.abc import Iterator

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    Chunk,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from visitlab_cli.recording.source import MAGIC, PREFIX, WINDOW, DamagedError, McapSource, Place, chunk_content

KINDS: dict[int, type[McapRecord]] = {
    Opcode.HEADER: Header,
    Opcode.FOOTER: Footer,
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.CHUNK: Chunk,
    Opcode.CHUNK_INDEX: ChunkIndex,
    Opcode.ATTACHMENT: Attachment,
    Opcode.ATTACHMENT_INDEX: AttachmentIndex,
    Opcode.STATISTICS: Statistics,
    Opcode.METADATA: Metadata,
    Opcode.METADATA_INDEX: MetadataIndex,
    Opcode.SUMMARY_OFFSET: SummaryOffset,
    Opcode.DATA_END: DataEnd,
}
MESSAGE_HEADER_SIZE = 22
INDEX_HEADER, INDEX_ENTRY_SIZE = struct.Struct("<9xHI"), 16
FOLLOWERS = 3
OPCODES = frozenset(map(int, Opcode))
CRC_SIZE = 4
# A known opcode and a length below 2^40.
_MAY_BEGIN = re.compile(rb"(?=[\x01-\x0f].{5}\x00\x00\x00)", re.DOTALL)


def whole_records(source: McapSource) -> Iterator[tuple[Place, McapRecord | None]]:
    """The whole records of a file in their order; messages and their indexes come unparsed, as None."""
    position = len(MAGIC)
    while position < source.size:
        try:
            place = source.place_at(position)
            yield place, _parsed(source, place)
            position = place.end
        except DamagedError:
            position = _next_whole(source, position + 1)


def _next_whole(source: McapSource, position: int) -> int:
    """Where the first whole record at or after `position` begins; the file's size if there is none.

    Bytes of an index can look like a small record: only a chunk, which has a CRC, is believed by itself.
    """
    while position < source.size:
        window = source.read(position, position + WINDOW + PREFIX.size - 1)
        for found in _MAY_BEGIN.finditer(window):
            try:
                place = source.place_at(position + found.start())
                _parsed(source, place)
            except DamagedError:
                continue
            if place.opcode == Opcode.CHUNK or _is_followed(source, place, FOLLOWERS):
                return place.start
        position += WINDOW
    return source.size


def _is_followed(source: McapSource, place: Place, count: int) -> bool:
    """Whether `count` records come after a place, or as many as the file still has."""
    for _ in range(count):
        if place.end >= source.size - len(MAGIC):
            return True
        try:
            place = source.place_at(place.end)
        except DamagedError:
            return False
        if place.opcode not in OPCODES:
            return False
    return True


def _parsed(source: McapSource, place: Place) -> McapRecord | None:
    """The record at a place, None where it is a message or an index of messages.

    Raises:
        DamagedError: it is not whole.
    """
    if place.opcode in (Opcode.MESSAGE, Opcode.MESSAGE_INDEX):
        is_whole = _is_message(source, place) if place.opcode == Opcode.MESSAGE else _is_index(source, place)
        record = None
    elif place.opcode in KINDS:
        record = source.parse(KINDS[place.opcode], place)
        is_whole = _is_written_so(record, source.read(place.start, place.end))
    else:
        is_whole = False
    if not is_whole:
        raise DamagedError(f"the record at byte {place.start:,} is damaged")
    if isinstance(record, Chunk):
        chunk_content(record, place)
    return record


def _is_message(source: McapSource, place: Place) -> bool:
    """Whether a message is long enough, and followed by a record: nothing else is known of it."""
    return place.end - place.start >= PREFIX.size + MESSAGE_HEADER_SIZE and _is_followed(source, place, 1)


def _is_index(source: McapSource, place: Place) -> bool:
    """Whether the length of an index is what its entries take."""
    _, entries = INDEX_HEADER.unpack(source.read(place.start, place.start + INDEX_HEADER.size).ljust(INDEX_HEADER.size))
    return bool(place.start + INDEX_HEADER.size + entries == place.end and entries % INDEX_ENTRY_SIZE == 0)


def _is_written_so(record: McapRecord, data: bytes) -> bool:
    """Whether `data` is how a record is written: lengths agree, and an attachment's CRC, where it has one."""
    builder = RecordBuilder()
    try:
        record.write(builder)
    except OverflowError:
        return False
    written: bytes = builder.end()  # type: ignore[no-untyped-call]
    if isinstance(record, Attachment) and not any(data[-CRC_SIZE:]):
        return written[:-CRC_SIZE] == data[:-CRC_SIZE]
    return written == data
