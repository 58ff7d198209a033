"""An MCAP file as records at places: read by place, so that nothing but what is looked at is in memory."""

import io
import os
import struct
import zlib
from collections.abc import Iterator
from typing import BinaryIO, NamedTuple, TypeVar

import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import EndOfFile, McapError
from mcap.opcode import Opcode
from mcap.records import Channel, DataEnd, Footer, McapRecord, Schema
from mcap.writer import MCAP0_MAGIC

PREFIX = struct.Struct("<BQ")
"""How each record begins: opcode, length of what follows."""
MAGIC = MCAP0_MAGIC
NO_OPCODE = 0
"""The one opcode that no record has."""
MAX_RECORD = 1 << 24
"""The largest record that is parsed, in bytes; chunks and attachments are read by their parts."""
WINDOW = 1 << 20
"""Bytes that are looked at together where all are."""

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
    """An open file, or its bytes from `first` up to `last`, which count from 0; it has `size` bytes."""

    def __init__(self, file: BinaryIO, first: int = 0, last: int | None = None):
        self._descriptor = file.fileno()
        self._first = first
        self.size = (os.fstat(self._descriptor).st_size if last is None else last) - first

    def read(self, start: int, end: int) -> bytes:
        """The bytes from `start` up to `end`, fewer where the file begins later or ends before."""
        start, end = max(start, 0), min(end, self.size)
        return os.pread(self._descriptor, end - start, self._first + start) if start < end else b""

    def windows(self, start: int, end: int) -> Iterator[bytes]:
        """The bytes from `start` up to `end` in parts of bounded size."""
        for begin in range(start, end, WINDOW):
            yield self.read(begin, min(begin + WINDOW, end))

    def crc(self, start: int, end: int) -> int:
        """The CRC32 of the bytes from `start` up to `end`."""
        crc = 0
        for window in self.windows(start, end):
            crc = zlib.crc32(window, crc)
        return crc

    def body(self, place: Place) -> bytes:
        """What follows the prefix of a record."""
        return self.read(place.start + PREFIX.size, place.end)

    def place_at(self, position: int) -> Place:
        """The record that begins at `position`.

        Raises:
            DamagedError: there is none, or the file ends before it does.
        """
        prefix = self.read(position, position + PREFIX.size)
        if len(prefix) == PREFIX.size:
            opcode, length = PREFIX.unpack(prefix)
            if opcode != NO_OPCODE and position + PREFIX.size + length <= self.size:
                return Place(opcode, position, position + PREFIX.size + length)
        raise DamagedError(f"its records end at byte {position:,} of {self.size:,}")

    def parse(self, kind: type[Parsed], place: Place) -> Parsed:
        """The record of a `kind` that is at a place; what follows its fields is left alone, as the format says.

        Raises:
            DamagedError: its bytes are no such record, or more than one has.
        """
        try:
            if place.end - place.start > MAX_RECORD:
                raise ValueError("too large")
            record: Parsed = kind.read(ExactStream(io.BytesIO(self.body(place))))  # type: ignore[attr-defined]
        except PARSE_ERRORS as error:
            raise DamagedError(f"the {kind.__name__} at byte {place.start:,} is damaged") from error
        return record

    def definition(self, place: Place) -> Schema | Channel:
        """The schema or channel that is at a place.

        Raises:
            DamagedError: its bytes are none.
        """
        return self.parse(Schema, place) if place.opcode == Opcode.SCHEMA else self.parse(Channel, place)


class ExactStream(ReadDataStream):
    """A stream that ends with an error, where mcap's own gives what is left."""

    def read(self, length: int) -> bytes:
        """The next `length` bytes."""
        data: bytes = super().read(length)
        if len(data) != length:
            raise EndOfFile
        return data


def walk(source: McapSource) -> Iterator[Place]:
    """Every record of a whole file, front to back, with only the prefixes read.

    Raises:
        NotMcapError: this is no MCAP file.
        DamagedError: the file is not whole, as far as sizes and the summary's CRC tell.
    """
    if source.read(0, len(MAGIC)) != MAGIC:
        if source.size > len(MAGIC) and source.read(source.size - len(MAGIC), source.size) == MAGIC:
            raise DamagedError("its first bytes are damaged")
        raise NotMcapError("not an MCAP file" + too_short(source))
    place = Place(0, 0, len(MAGIC))
    while place.opcode != Opcode.FOOTER:
        place = source.place_at(place.end)
        yield place
    end = place.end + len(MAGIC)
    if source.read(place.end, end) != MAGIC:
        raise DamagedError("its last bytes are damaged")
    if source.size > end:
        what = "another MCAP file follows" if source.read(end, end + len(MAGIC)) == MAGIC else "bytes follow"
        raise DamagedError(f"{what} behind its end at byte {end:,}")
    footer = source.parse(Footer, place)
    if not has_summary_crc(source, footer, place):
        raise DamagedError("its summary is damaged")


def too_short(source: McapSource) -> str:
    """Words for a file that is shorter than any MCAP file's beginning, empty for any other."""
    if not source.size:
        return ": it is empty"
    return f": {source.size} bytes are too short" if source.size < len(MAGIC) else ""


def has_summary_crc(source: McapSource, footer: Footer, place: Place) -> bool:
    """Whether the summary's CRC, which covers the footer up to the CRC itself, is right or left out."""
    start = footer.summary_start or place.start
    end = place.start + PREFIX.size + struct.calcsize("<QQ")
    return not footer.summary_crc or footer.summary_crc == source.crc(start, end)


def has_data_crc(source: McapSource, place: Place) -> bool:
    """Whether the CRC in the DataEnd at `place`, which covers everything before it, is right or left out."""
    expected = source.parse(DataEnd, place).data_section_crc
    return not expected or expected == source.crc(0, place.start)
