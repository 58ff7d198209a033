"""What a chunk holds, never more memory than it says, and the records in it."""

import io
import struct
import zlib
from collections.abc import Iterator
from typing import NamedTuple

import lz4.frame
import zstandard
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Schema

from visitlab_cli.log.source import (
    MAX_RECORD,
    NO_OPCODE,
    PARSE_ERRORS,
    PREFIX,
    DamagedError,
    ExactStream,
    McapSource,
    Place,
)

MAX_CONTENT = 1 << 28
"""The largest chunk that is read, in bytes: a size that is damaged, or made up, must not fill the memory."""
MOST_NAME = 64
ZSTD, LZ4 = "zstd", "lz4"
_FIXED, _LENGTH = struct.Struct("<QQQII"), struct.Struct("<Q")


class Record(NamedTuple):
    """A record in the content of a chunk: from `start`, its prefix included; its body from `body` up to `end`."""

    opcode: int
    start: int
    body: int
    end: int


def content_size(source: McapSource, place: Place) -> int:
    """How many bytes the chunk at `place` says that it holds."""
    size: int = _LENGTH.unpack(source.read(place.start + PREFIX.size + 16, place.start + PREFIX.size + 24).ljust(8))[0]
    return size


def chunk_at(source: McapSource, place: Place) -> Chunk:
    """The chunk at a place, its records still compressed.

    Raises:
        DamagedError: its bytes are no chunk, or one larger than `MAX_CONTENT`.
    """
    head = source.read(place.start, min(place.end, place.start + PREFIX.size + _FIXED.size + MOST_NAME + _LENGTH.size))
    try:
        start, end, size, crc, letters = _FIXED.unpack_from(head, PREFIX.size)
        begin = PREFIX.size + _FIXED.size
        compression = head[begin : begin + letters].decode()
        (length,) = _LENGTH.unpack_from(head, begin + letters)
    except (struct.error, ValueError) as error:
        raise _damaged(place) from error
    first = place.start + begin + letters + _LENGTH.size
    if first + length > place.end:
        raise _damaged(place)
    if max(size, length) > MAX_CONTENT:
        raise DamagedError(f"the chunk at byte {place.start:,} says that it is larger than {MAX_CONTENT:,} bytes")
    return Chunk(compression, source.read(first, first + length), end, start, crc, size)


def chunk_content(chunk: Chunk, place: Place) -> bytes:
    """The decompressed records of a chunk.

    Raises:
        DamagedError: its size or CRC is wrong.
    """
    try:
        content = _decompressed(chunk)
    except PARSE_ERRORS as error:
        raise _damaged(place) from error
    if len(content) != chunk.uncompressed_size or chunk.uncompressed_crc not in (0, zlib.crc32(content)):
        raise _damaged(place)
    return content


def _damaged(place: Place) -> DamagedError:
    return DamagedError(f"the chunk at byte {place.start:,} is damaged")


def _decompressed(chunk: Chunk) -> bytes:
    """The content, or at most a byte more than the chunk says: what a frame says of itself is not believed."""
    most = chunk.uncompressed_size + 1
    if chunk.compression == ZSTD:
        if zstandard.get_frame_parameters(chunk.data).content_size == chunk.uncompressed_size:
            return zstandard.ZstdDecompressor().decompress(chunk.data)
        with zstandard.ZstdDecompressor().stream_reader(chunk.data) as stream:
            return stream.read(most)
    if chunk.compression == LZ4:
        frame = lz4.frame.LZ4FrameDecompressor()
        content: bytes = frame.decompress(chunk.data, max_length=most)
        if not frame.eof:
            raise ValueError("cut, or larger than it says")
        return content
    if chunk.compression:
        raise ValueError(f"compressed by {chunk.compression}")
    return chunk.data


def definition_in(content: bytes, record: Record) -> Schema | Channel | None:
    """What a record in a chunk defines, None where it is another.

    Raises:
        DamagedError: it is no whole schema or channel.
    """
    if record.opcode not in (Opcode.SCHEMA, Opcode.CHANNEL):
        return None
    kind = Schema if record.opcode == Opcode.SCHEMA else Channel
    try:
        if record.end - record.body > MAX_RECORD:
            raise ValueError("too large")
        definition: Schema | Channel = kind.read(ExactStream(io.BytesIO(content[record.body : record.end])))
    except PARSE_ERRORS as error:
        raise DamagedError(f"a {kind.__name__} in a chunk is damaged") from error
    return definition


def records_in(content: bytes) -> Iterator[Record]:
    """The records of a chunk, in their order.

    Raises:
        DamagedError: they do not fill it.
    """
    position, end = 0, len(content)
    while position < end:
        body = position + PREFIX.size
        if body > end:
            raise DamagedError("the last record of a chunk is cut")
        opcode, length = PREFIX.unpack_from(content, position)
        if opcode == NO_OPCODE or body + length > end:
            raise DamagedError("a record in a chunk is damaged")
        yield Record(opcode, position, body, body + length)
        position = body + length
