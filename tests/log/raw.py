"""MCAP files put together record by record, as no writer writes them."""

import struct
import zlib

import lz4.frame
import zstandard
from mcap.opcode import Opcode
from mcap.records import Attachment, Channel, DataEnd, Footer, Header, Metadata, Schema
from mcap.writer import MCAP0_MAGIC as MAGIC

from visitlab_cli.log.mcap_file import record_bytes
from visitlab_cli.log.schema import schema_bytes

PRIVATE, FUTURE = 0x91, 0x2A
HEADER = record_bytes(Header("", "somebody"))
COMPRESSORS = {"": bytes, "zstd": zstandard.ZstdCompressor().compress, "lz4": lz4.frame.compress}


def record(opcode, body):
    return struct.pack("<BQ", opcode, len(body)) + body


def padded(data, padding=b"\x05more\x00"):
    """A record with bytes behind its fields."""
    opcode, _ = struct.unpack_from("<BQ", data)
    return record(opcode, data[9:] + padding)


def schema(number, name="visitlab.Step", data=None, encoding="protobuf"):
    return record_bytes(Schema(number, schema_bytes() if data is None else data, encoding, name))


def channel(number, topic="/step", schema_number=None, encoding="protobuf"):
    return record_bytes(Channel(number, topic, encoding, {}, number if schema_number is None else schema_number))


def message(number, data, time):
    return record(Opcode.MESSAGE, struct.pack("<HIQQ", number, 0, time, time) + data)


def chunk(content, compression="zstd", *, size=None, crc=None, data=None):
    data = COMPRESSORS[compression](content) if data is None else data
    head = struct.pack("<QQQ", 0, 0, len(content) if size is None else size)
    head += struct.pack("<II", zlib.crc32(content) if crc is None else crc, len(compression)) + compression.encode()
    return record(Opcode.CHUNK, head + struct.pack("<Q", len(data)) + data)


def attachment(name="notes", data=b"some"):
    return record_bytes(Attachment(1, 2, name, "text/plain", data))


def metadata(name="other", **values):
    return record_bytes(Metadata(name, values or {"a": "b"}))


def data_end(before=None):
    """The end of the data; with the CRC of what comes before it, if that is given."""
    return record_bytes(DataEnd(0 if before is None else zlib.crc32(before)))


def whole(*records, end=None):
    """A file of these records."""
    return MAGIC + b"".join(records) + (data_end() if end is None else end) + record_bytes(Footer(0, 0, 0)) + MAGIC
