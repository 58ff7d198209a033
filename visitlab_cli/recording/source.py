"""An MCAP file as records at places: read by place, so that nothing but what is looked at is in memory."""

import io
import os
import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple, TypeVar

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Chunk, DataEnd, Footer, McapRecord
from mcap.stream_reader import get_chunk_data_stream
from mcap.writer import MCAP0_MAGIC

PREFIX = struct.Struct("<BQ")
"""How each record begins: opcode, length of what follows."""
MAGIC = MCAP0_MAGIC
MAX_CONTENT = 1 << 30
"""The largest chunk that is decompressed, in bytes: a damaged size must not fill the memory."""
WINDOW = 1 << 20
"""Bytes that are looked at together where all are."""
_CRC_SIZE = struct.calcsize("<I")

Parsed = TypeVar("Parsed", bound=McapRecord)


class DamagedError(Exception):
    """A part of the file is not whole; the message says which."""


class NotMcapError(Exception):
    """The file is of another kind."""


PARSE_ERRORS = (McapError, ValueError, struct.error, zstandard.ZstdError, RuntimeError, MemoryError, OverflowError)
"""What parsing damaged bytes raises in the libraries that do it (RuntimeError: lz4)."""


class Place(NamedTuple):
    """Where a record is: the bytes from `start`, its prefix included, up to `end`."""

    opcode: int
    start: int
    end: int


class McapSource:
    """An open file of `size` bytes."""

    def __init__(self, file: BinaryIO):
        self._descriptor = file.fileno()
        self.size = os.fstat(self._descriptor).st_size

    def read(self, start: int, end: int) -> bytes:
        """The bytes from `start` up to `end`, fewer where the file ends before."""
        return os.pread(self._descriptor, end - start, start) if start < end else b""

    def body(self, place: Place) -> bytes:
        """What follows the prefix of a record."""
        return self.read(place.start + PREFIX.size, place.end)

    def place_at(self, position: int) -> Place:
        """The record that begins at `position`.

        Raises:
            DamagedError: the file ends before the record does.
        """
        prefix = self.read(position, position + PREFIX.size)
        if len(prefix) == PREFIX.size:
            opcode, length = PREFIX.unpack(prefix)
            if position + PREFIX.size + length <= self.size:
                return Place(opcode, position, position + PREFIX.size + length)
        raise DamagedError(f"its records end at byte {position:,} of {self.size:,}")

    def parse(self, kind: type[Parsed], place: Place) -> Parsed:
        """The record of a `kind` that is at a place.

        Raises:
            DamagedError: its bytes are no such record.
        """
        try:
            record: Parsed = kind.read(ReadDataStream(io.BytesIO(self.body(place))))  # type: ignore[attr-defined]
        except PARSE_ERRORS as error:
            raise DamagedError(f"the {kind.__name__} at byte {place.start:,} is damaged") from error
        return record


def walk(source: McapSource) -> Iterator[Place]:
    """Every record of a whole file, front to back, with only the prefixes read.

    Raises:
        NotMcapError: this is no MCAP file.
        DamagedError: the file is not whole, as far as sizes and the summary's CRC tell.
    """
    if source.read(0, len(MAGIC)) != MAGIC:
        if source.read(source.size - len(MAGIC), source.size) == MAGIC and source.size > len(MAGIC):
            raise DamagedError("its first bytes are damaged")
        raise NotMcapError("not an MCAP file")
    place = Place(0, 0, len(MAGIC))
    while place.opcode != Opcode.FOOTER:
        place = source.place_at(place.end)
        yield place
    if source.read(place.end, source.size) != MAGIC:
        raise DamagedError("its last bytes are damaged")
    footer = source.parse(Footer, place)
    if not has_summary_crc(source, footer, place):
        raise DamagedError("its summary is damaged")


def has_summary_crc(source: McapSource, footer: Footer, place: Place) -> bool:
    """Whether the summary's CRC, which covers the footer up to the CRC itself, is right or left out."""
    start = footer.summary_start or place.start
    return footer.summary_crc in (0, zlib.crc32(source.read(start, place.end - _CRC_SIZE)))


def has_data_crc(source: McapSource, place: Place) -> bool:
    """Whether the CRC in the DataEnd at `place`, which covers everything before it, is right or left out."""
    expected, crc = source.parse(DataEnd, place).data_section_crc, 0
    for start in range(0, place.start if expected else 0, WINDOW):
        crc = zlib.crc32(source.read(start, min(start + WINDOW, place.start)), crc)
    return bool(crc == expected)


def chunk_content(chunk: Chunk, place: Place) -> bytes:
    """The decompressed records of a chunk.

    Raises:
        DamagedError: its size or CRC is wrong.
    """
    try:
        if chunk.uncompressed_size > MAX_CONTENT:
            raise ValueError("too large")
        stream, size = get_chunk_data_stream(chunk, validate_crc=True)
        if size != chunk.uncompressed_size:
            raise ValueError("another size")
        return stream.read(size)
    except PARSE_ERRORS as error:
        raise DamagedError(f"the chunk at byte {place.start:,} is damaged") from error
