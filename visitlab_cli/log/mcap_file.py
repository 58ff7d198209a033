"""An MCAP file whose chunks are blocks of records of constant size, with every index and CRC filled in.

Written front to back in bounded memory; what is kept until the end is one small index record a chunk. The
stock writer adds messages one by one, which is what this module is here to avoid. It holds no wall clock: the
same calls give the same bytes. Format: mcap.dev/spec.
"""

import contextlib
import hashlib
import os
import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

import numpy as np
import numpy.typing as npt
import zstandard
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
from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import MCAP0_MAGIC

from visitlab_cli.log.layout import Records

HEADER = Header(profile="", library="visitlab")
COMPRESSION = "zstd"
# The fast strategy of levels 1 and 2, with a table and a window that fit the processor's cache. Measured on a
# visit: a fifth less CPU than level 3, which writes 2 bytes a step less.
COMPRESSION_PARAMETERS = zstandard.ZstdCompressionParameters(
    strategy=zstandard.STRATEGY_FAST, window_log=18, hash_log=16, min_match=6
)
INDEX_HEAD = struct.Struct("<HI")
"""How the body of a MessageIndex begins: channel, bytes of its entries."""
INDEX_ENTRY = np.dtype([("log_time", "<u8"), ("offset", "<u8")])
IndexEntries = npt.NDArray[np.void]
"""Log time and place in its chunk of each message, of `INDEX_ENTRY`."""
_PART = 1 << 20
_OF_CHUNK = (
    "chunk_start_offset",
    "chunk_length",
    "compressed_size",
    "uncompressed_size",
    "message_start_time",
    "message_end_time",
    "message_index_length",
)
_ABSENT = -1


class Position(NamedTuple):
    """Where a file being written stands, `size` bytes with the CRC `crc`; what its summary will say of these.

    `chunks` has a row for each, of `_OF_CHUNK`, then where each channel's index is; `counts` are messages by channel.
    """

    size: int
    crc: int
    chunks: npt.NDArray[np.int64]
    counts: npt.NDArray[np.int64]


class McapFile:
    """An MCAP file being written. Errors are OSErrors."""

    def __init__(self, path: Path, header: Header = HEADER):
        self._file = path.open("wb")
        self._compressor = zstandard.ZstdCompressor(compression_params=COMPRESSION_PARAMETERS)
        self._position = 0
        self._crc = 0
        self._digest = hashlib.sha256()
        self._channels: dict[int, Channel] = {}
        self._schemas: dict[int, Schema] = {}
        self._chunks: list[ChunkIndex] = []
        self._attachments: list[AttachmentIndex] = []
        self._metadata: list[MetadataIndex] = []
        self._message_counts: dict[int, int] = {}
        self._write(MCAP0_MAGIC)
        self._write(record_bytes(header))

    def write_metadata(self, name: str, metadata: dict[str, str]) -> None:
        """Append a metadata record."""
        self.copy([record_bytes(Metadata(name, metadata))], metadata=name)

    def write_attachment(self, name: str, media_type: str, content: bytes) -> None:
        """Append an attachment, at time 0."""
        data = record_bytes(Attachment(0, 0, name, media_type, content))
        self.copy([data], attachment=AttachmentIndex(0, 0, 0, 0, len(content), name, media_type))

    def copy(
        self, parts: Iterable[bytes], *, metadata: str | None = None, attachment: AttachmentIndex | None = None
    ) -> None:
        """Append a record as it is, in parts; one of metadata is indexed by its name, an attachment by `attachment`."""
        start = self._position
        for part in parts:
            self._write(part)
        length = self._position - start
        if metadata is not None:
            self._metadata.append(MetadataIndex(start, length, metadata))
        if attachment is not None:
            self._attachments.append(replace(attachment, offset=start, length=length))

    def write_channel(self, channel: int, topic: str, message: str, schema: bytes) -> None:
        """Append the number and topic of a `channel`, and the `schema` of its protobuf `message`."""
        self.define(Schema(channel, schema, SchemaEncoding.Protobuf, message))
        self.define(Channel(channel, topic, MessageEncoding.Protobuf, {}, channel))

    def define(self, definition: Schema | Channel, *, in_chunk: bool = False) -> None:
        """Append a schema or channel, unless the next chunk holds it; the summary repeats it."""
        if isinstance(definition, Schema):
            self._schemas[definition.id] = definition
        else:
            self._channels[definition.id] = definition
            self._message_counts.setdefault(definition.id, 0)
        if not in_chunk:
            self._write(record_bytes(definition))

    def write_chunk(self, blocks: Sequence[Records]) -> None:
        """Append a chunk of `blocks`, each of one channel in the order of its log times, and their indexes.

        An empty block is left out; there is at least one message.
        """
        blocks = [block for block in blocks if len(block)]
        indexes, offset = {}, 0
        for block in blocks:
            entries = np.empty(len(block), INDEX_ENTRY)
            entries["log_time"] = block["log_time"]
            entries["offset"] = offset + block.itemsize * np.arange(len(block))
            indexes[int(block["channel"][0])] = entries
            offset += block.nbytes
        self.write_content(b"".join(block.view(np.uint8).data for block in blocks), indexes)

    def write_content(self, content: bytes, indexes: Mapping[int, IndexEntries]) -> None:
        """Append a chunk of `content`, the records of messages, and the `indexes` of these by their channel."""
        compressed = self._compressor.compress(content)
        self.copy_chunk(Chunk(COMPRESSION, compressed, 0, 0, zlib.crc32(content), len(content)), indexes)

    def copy_chunk(self, chunk: Chunk, indexes: Mapping[int, IndexEntries]) -> None:
        """Append a chunk as it is, but for the times of its messages, which `indexes` tell, and these."""
        start = min((int(entries["log_time"].min()) for entries in indexes.values()), default=0)
        end = max((int(entries["log_time"].max()) for entries in indexes.values()), default=0)
        chunk_start = self._position
        self._write_chunk(replace(chunk, message_start_time=start, message_end_time=end))
        indexes_start = self._position
        index_offsets = {}
        for channel, entries in indexes.items():
            index_offsets[channel] = self._position
            self._message_counts[channel] = self._message_counts.get(channel, 0) + len(entries)
            self._write(_message_index(channel, entries))
        self._chunks.append(
            ChunkIndex(
                chunk_length=indexes_start - chunk_start,
                chunk_start_offset=chunk_start,
                compression=chunk.compression,
                compressed_size=len(chunk.data),
                message_end_time=end,
                message_index_length=self._position - indexes_start,
                message_index_offsets=index_offsets,
                message_start_time=start,
                uncompressed_size=chunk.uncompressed_size,
            )
        )
        self.flush()

    def flush(self) -> None:
        """Hand what is written to the operating system: a killed process leaves it readable."""
        self._file.flush()

    def position(self) -> Position:
        """Where it stands; that much is on the disk."""
        self.flush()
        os.fsync(self._file.fileno())
        channels = sorted(self._channels)
        rows = [
            [getattr(chunk, name) for name in _OF_CHUNK]
            + [chunk.message_index_offsets.get(channel, _ABSENT) for channel in channels]
            for chunk in self._chunks
        ]
        chunks = np.array(rows, np.int64).reshape(-1, len(_OF_CHUNK) + len(channels))
        return Position(self._position, self._crc, chunks, np.array([self._message_counts[each] for each in channels]))

    def go_on(self, before: BinaryIO, at: Position) -> None:
        """Append what another file holds up to a position, which began as this one and holds chunks since.

        Raises:
            ValueError: it does not hold that; nothing is appended.
        """
        begun, crc, digest = self._position, self._crc, self._digest.copy()
        before.seek(begun)
        while self._position < at.size and (part := before.read(min(_PART, at.size - self._position))):
            self._write(part)
        if (self._position, self._crc) != (at.size, at.crc):
            self._file.seek(begun)
            self._file.truncate()
            self._position, self._crc, self._digest = begun, crc, digest
            raise ValueError("cut, or damaged")
        channels = sorted(self._channels)
        for row in at.chunks.tolist():
            told, indexes = row[: len(_OF_CHUNK)], zip(channels, row[len(_OF_CHUNK) :], strict=True)
            offsets = {channel: offset for channel, offset in indexes if offset != _ABSENT}
            chunk = dict(zip(_OF_CHUNK, told, strict=True))
            self._chunks.append(ChunkIndex(compression=COMPRESSION, message_index_offsets=offsets, **chunk))
        self._message_counts.update(zip(channels, at.counts.tolist(), strict=True))
        self.position()

    def finish(self) -> None:
        """Append the summary, see that the file is on the disk, and close it."""
        self._write(record_bytes(DataEnd(self._crc)))
        summary_start = self._position
        self._crc = 0
        offsets: list[SummaryOffset] = []
        for opcode, records in self._summary().items():
            group_start = self._position
            self._write(record_bytes(*records))
            offsets.append(SummaryOffset(opcode, group_start, self._position - group_start))
        offsets_start = self._position
        self._write(record_bytes(*offsets))
        # The summary's CRC covers the footer too, up to the CRC itself.
        footer = record_bytes(Footer(summary_start, offsets_start, 0))[: -struct.calcsize("<I")]
        self._write(footer)
        self._write(struct.pack("<I", self._crc) + MCAP0_MAGIC)
        self.flush()
        os.fsync(self._file.fileno())
        self._file.close()

    def described(self) -> dict[str, Any]:
        """Size in bytes and sha256 of what was written so far."""
        return {"size": self._position, "sha256": self._digest.hexdigest()}

    def abandon(self) -> None:
        """Close the file without a summary; what it holds is not worth an error of the disk."""
        with contextlib.suppress(OSError):
            self._file.close()

    def _summary(self) -> dict[Opcode, Sequence[McapRecord]]:
        groups: dict[Opcode, Sequence[McapRecord]] = {
            Opcode.SCHEMA: list(self._schemas.values()),
            Opcode.CHANNEL: list(self._channels.values()),
            Opcode.STATISTICS: [self._statistics()],
            Opcode.CHUNK_INDEX: self._chunks,
            Opcode.ATTACHMENT_INDEX: self._attachments,
            Opcode.METADATA_INDEX: self._metadata,
        }
        return {opcode: records for opcode, records in groups.items() if records}

    def _statistics(self) -> Statistics:
        chunks = [chunk for chunk in self._chunks if chunk.message_index_offsets]  # an empty one has no times
        return Statistics(
            attachment_count=len(self._attachments),
            channel_count=len(self._channels),
            channel_message_counts=self._message_counts,
            chunk_count=len(self._chunks),
            message_count=sum(self._message_counts.values()),
            message_end_time=max((chunk.message_end_time for chunk in chunks), default=0),
            message_start_time=min((chunk.message_start_time for chunk in chunks), default=0),
            metadata_count=len(self._metadata),
            schema_count=len(self._schemas),
        )

    def _write_chunk(self, chunk: Chunk) -> None:
        """Append the record of a chunk, its data from where they are."""
        compression = chunk.compression.encode()
        head = struct.pack("<QQQ", chunk.message_start_time, chunk.message_end_time, chunk.uncompressed_size)
        head += struct.pack("<II", chunk.uncompressed_crc, len(compression)) + compression
        head += struct.pack("<Q", len(chunk.data))
        self._write(struct.pack("<BQ", Opcode.CHUNK, len(head) + len(chunk.data)) + head)
        self._write(chunk.data)

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._position += len(data)
        self._crc = zlib.crc32(data, self._crc)
        self._digest.update(data)


def record_bytes(*records: McapRecord) -> bytes:
    """Records as a file holds them."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    data: bytes = builder.end()  # type: ignore[no-untyped-call]  # mcap leaves it unannotated
    return data


def _message_index(channel: int, entries: IndexEntries) -> bytes:
    """The MessageIndex record of a channel's messages in a chunk."""
    head = INDEX_HEAD.pack(channel, entries.nbytes)
    return struct.pack("<BQ", Opcode.MESSAGE_INDEX, len(head) + entries.nbytes) + head + entries.tobytes()
