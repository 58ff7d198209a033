"""The whole records of a damaged file: those whose parts fit in them, whose CRCs are right, and that others follow.

What follows the fields of a record, and records of an opcode that is not known, are what the format allows: both are
whole. After bytes that are no whole record the search goes on at the next place where one begins, whatever the lengths
in between say.
"""

import re
from collections import deque
from collections.abc import Iterator
from typing import NamedTuple

from mcap.opcode import Opcode
from mcap.records import (
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

from visitlab_cli.log.attachments import CRC_SIZE, Attached, attached
from visitlab_cli.log.chunks import chunk_at, chunk_content, content_size, records_in
from visitlab_cli.log.foreign import MESSAGE_HEAD
from visitlab_cli.log.mcap_file import INDEX_ENTRY, INDEX_HEAD, record_bytes
from visitlab_cli.log.source import MAGIC, NO_OPCODE, PREFIX, WINDOW, DamagedError, McapSource, Place

KINDS: dict[int, type[McapRecord]] = {
    Opcode.HEADER: Header,
    Opcode.FOOTER: Footer,
    Opcode.SCHEMA: Schema,
    Opcode.CHANNEL: Channel,
    Opcode.CHUNK_INDEX: ChunkIndex,
    Opcode.ATTACHMENT_INDEX: AttachmentIndex,
    Opcode.STATISTICS: Statistics,
    Opcode.METADATA: Metadata,
    Opcode.METADATA_INDEX: MetadataIndex,
    Opcode.SUMMARY_OFFSET: SummaryOffset,
    Opcode.DATA_END: DataEnd,
}
FOLLOWERS = 3
MOST_LENGTH = 1 << 40
"""Bytes; a number that is larger is no length of a record."""
ANOTHER_FILE = -1
"""In the place of an opcode: here another file begins."""
LOOK = 1 << 12
MOST_SEARCHED = 1 << 30
"""The search gives up once it has read so many bytes for nothing, and eight times the file's size: each look costs at
least `LOOK`. Without it a file of nothing but beginnings of large records would take days."""
# A known opcode and a length below 2^40, or another file.
_MAY_BEGIN = re.compile(rb"[\x01-\x0f].{5}\x00\x00\x00|" + re.escape(MAGIC) + rb"\x01", re.DOTALL)


class Whole(NamedTuple):
    """A whole record: parsed, but for messages, their indexes and what is not known; the `content` of a chunk.

    The place of a footer includes the magic behind it.
    """

    place: Place
    record: McapRecord | Attached | None = None
    content: bytes = b""


def whole_records(source: McapSource) -> Iterator[Whole]:
    """The whole records of a file in their order, up to its end or to `ANOTHER_FILE`."""
    position = len(MAGIC) if source.read(0, len(MAGIC)) == MAGIC else 0
    searching = 8 * source.size + MOST_SEARCHED
    while position < source.size:
        try:
            whole = _whole(source, _place(source, position))
        except DamagedError:
            found, searching = _next_whole(source, position + 1, searching)
            if found is None:
                return
            whole = found
        position = whole.place.end
        if whole.place.opcode == Opcode.FOOTER and source.read(position, position + len(MAGIC)) == MAGIC:
            position += len(MAGIC)
            whole = whole._replace(place=whole.place._replace(end=position))
        yield whole
        if whole.place.opcode == ANOTHER_FILE:
            return


def _place(source: McapSource, position: int) -> Place:
    """What begins at a position: a record or another file."""
    if position and source.read(position, position + len(MAGIC)) == MAGIC:
        header = source.place_at(position + len(MAGIC))
        if header.opcode == Opcode.HEADER:
            return Place(ANOTHER_FILE, position, position)
    return source.place_at(position)


def _next_whole(source: McapSource, position: int, searching: int) -> tuple[Whole | None, int]:
    """The first whole record at or after `position`, None where there is none; and what is left of `searching`.

    Bytes of an index can look like a small record: only a chunk, which has a CRC, is believed by itself.
    """
    while position < source.size:
        window = source.read(position, position + WINDOW + PREFIX.size - 1)
        at = 0
        while found := _MAY_BEGIN.search(window, at):
            at = found.start() + 1
            length = 0 if window[found.start()] == MAGIC[0] else PREFIX.unpack_from(window, found.start())[1]
            if position + found.start() + length + PREFIX.size > source.size:
                continue
            cost = LOOK
            try:
                place = _place(source, position + found.start())
                cost += length + (content_size(source, place) if place.opcode == Opcode.CHUNK else 0)
                if cost > searching:
                    continue
                whole = _whole(source, place)
            except DamagedError:
                searching -= cost
                if searching < LOOK:
                    return None, searching
                continue
            alone = Opcode.CHUNK, ANOTHER_FILE
            if place.opcode in alone or _is_followed(source, place, FOLLOWERS):
                return whole, searching
            searching -= LOOK
        position += WINDOW
    return None, searching


def _is_followed(source: McapSource, place: Place, count: int) -> bool:
    """Whether `count` records come after a place, or as many as the file still has."""
    for _ in range(count):
        if place.end >= source.size - len(MAGIC) or source.read(place.end, place.end + len(MAGIC)) == MAGIC:
            return True
        try:
            place = source.place_at(place.end)
        except DamagedError:
            return _is_cut(source, place.end)
    return True


def _is_cut(source: McapSource, position: int) -> bool:
    """Whether what begins at a position is what a crash leaves there: the beginning of a record, or zeros."""
    prefix = source.read(position, position + PREFIX.size)
    opcode, length = PREFIX.unpack(prefix)
    return not any(prefix) or (opcode != NO_OPCODE and source.size - position < length + PREFIX.size < MOST_LENGTH)


def _whole(source: McapSource, place: Place) -> Whole:
    """The record at a place.

    Raises:
        DamagedError: it is not whole.
    """
    if place.opcode == ANOTHER_FILE:
        return Whole(place)
    whole, end = _parsed(source, place)
    if end == place.end or (end < place.end and _is_followed(source, place, FOLLOWERS)):
        return whole
    shorter = Place(place.opcode, place.start, end)  # perhaps it is its length that is damaged
    has_crc = isinstance(whole.record, Attached) or (isinstance(whole.record, Chunk) and whole.record.uncompressed_crc)
    if place.start < end < place.end and (has_crc or _is_followed(source, shorter, FOLLOWERS)):
        return whole._replace(place=shorter)
    raise DamagedError(f"the record at byte {place.start:,} is damaged")


def _parsed(source: McapSource, place: Place) -> tuple[Whole, int]:
    """The record at a place, and where its fields end.

    Raises:
        DamagedError: it is not whole.
    """
    body = place.start + PREFIX.size
    if place.opcode == Opcode.MESSAGE:
        is_message = place.end - body >= MESSAGE_HEAD.size and _is_followed(source, place, 1)
        return Whole(place), place.end if is_message else place.end + 1
    if place.opcode == Opcode.MESSAGE_INDEX:
        head = source.read(body, body + INDEX_HEAD.size).ljust(INDEX_HEAD.size, b"\1")
        _, size = INDEX_HEAD.unpack(head)
        return Whole(place), body + INDEX_HEAD.size + size if size % INDEX_ENTRY.itemsize == 0 else place.end + 1
    if place.opcode == Opcode.CHUNK:
        chunk = chunk_at(source, place)
        content = chunk_content(chunk, place)
        if not chunk.uncompressed_crc:
            deque(records_in(content), maxlen=0)  # each is whole: nothing else tells
        head_size = len(record_bytes(Chunk(chunk.compression, b"", 0, 0, 0, 0)))
        return Whole(place, chunk, content), place.start + head_size + len(chunk.data)
    if place.opcode == Opcode.ATTACHMENT:
        attachment = attached(source, place)
        return Whole(place, attachment), attachment.end + CRC_SIZE
    if place.opcode not in KINDS:
        return Whole(place), place.start  # its fields are not known: others must follow
    record = source.parse(KINDS[place.opcode], place)
    try:
        written = record_bytes(record)
    except OverflowError as error:
        raise DamagedError(f"the record at byte {place.start:,} is damaged") from error
    fields = written[PREFIX.size :]
    has_more = source.read(body, body + len(fields)) != fields  # such as a map in two parts
    return Whole(place, record), place.start if has_more else body + len(fields)
