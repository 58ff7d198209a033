"""The parts of the file that the stock readers do not check: indexes, summary, CRCs."""

import io
import struct
import zlib

import pytest
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.reader import make_reader
from mcap.records import Chunk, DataEnd, Footer, MessageIndex, SummaryOffset
from mcap.stream_reader import StreamReader

from visitlab_cli.log.writer import CHUNK_STEPS

from .blocks import random_steps, record

TRIALS, TRIAL_STEPS = 170, 100
PREFIX = struct.Struct("<BQ")  # opcode and length of a record
MAGIC_SIZE = 8
FOOTER_SIZE = PREFIX.size + 20


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    columns, rows = random_steps(TRIALS, TRIAL_STEPS)
    return record(tmp_path_factory.mktemp("log") / "a.mcap", "visit", columns, rows).read_bytes()


@pytest.fixture(scope="module")
def no_steps(tmp_path_factory):
    columns, _ = random_steps(1, 0)
    return record(tmp_path_factory.mktemp("log") / "a.mcap", "visit", columns, 0).read_bytes()


@pytest.fixture(scope="module")
def summary(data):
    return make_reader(io.BytesIO(data)).get_summary()


def records_at(data, start, length):
    """(opcode, body) of the records that fill `length` bytes from `start`."""
    end = start + length
    while start < end:
        opcode, size = PREFIX.unpack_from(data, start)
        start += PREFIX.size
        yield opcode, data[start : start + size]
        start += size
    assert start == end


def footer_of(data):
    body = data[-FOOTER_SIZE - MAGIC_SIZE + PREFIX.size : -MAGIC_SIZE]
    return Footer.read(ReadDataStream(io.BytesIO(body)))


def test_statistics_count_everything(summary):
    rows = TRIALS * (TRIAL_STEPS + 1)
    found = summary.statistics
    assert found.message_count == rows + TRIALS
    assert found.channel_message_counts == {1: rows, 2: TRIALS}
    assert found.chunk_count == len(summary.chunk_indexes) == -(-rows // CHUNK_STEPS)
    assert (found.message_start_time, found.message_end_time) == (0, (rows - 1) * 10**9)
    assert (found.schema_count, found.channel_count) == (2, 2)
    assert (found.attachment_count, found.metadata_count) == (1, 1)


def test_schemas_and_channels_are_in_the_summary(summary):
    channels = {channel.topic: channel for channel in summary.channels.values()}
    names = {topic: summary.schemas[channel.schema_id].name for topic, channel in channels.items()}
    assert names == {"/step": "visitlab.Step", "/trial": "visitlab.Trial"}
    assert {channel.message_encoding for channel in channels.values()} == {"protobuf"}


def test_message_indexes_point_at_the_messages(data, summary):
    for index in summary.chunk_indexes:
        chunk = Chunk.read(ReadDataStream(io.BytesIO(data[index.chunk_start_offset + PREFIX.size :])))
        content = zstandard.decompress(chunk.data)
        assert zlib.crc32(content) == chunk.uncompressed_crc
        pointed = 0
        for channel, offset in index.message_index_offsets.items():
            entries = MessageIndex.read(ReadDataStream(io.BytesIO(data[offset + PREFIX.size :])))
            assert entries.channel_id == channel
            for log_time, at in entries.records:
                opcode, size, owner, _, time = struct.unpack_from("<BQHIQ", content, at)
                assert (opcode, owner, time) == (5, channel, log_time)
                pointed += PREFIX.size + size
        assert pointed == len(content) == index.uncompressed_size
        following = list(records_at(data, index.chunk_start_offset, index.chunk_length + index.message_index_length))
        assert [opcode for opcode, _ in following] == [6] + [7] * len(index.message_index_offsets)


def test_metadata_and_attachment_are_indexed_and_come_before_all_chunks(data, summary):
    [metadata], [attachment] = summary.metadata_indexes, summary.attachment_indexes
    reader = make_reader(io.BytesIO(data))
    assert [found.name for found in reader.iter_metadata()] == ["visitlab"]
    assert [found.data for found in reader.iter_attachments()] == [b"name: example\n"]
    opcodes = [next(records_at(data, index.offset, index.length))[0] for index in (metadata, attachment)]
    assert opcodes == [12, 9]
    assert max(metadata.offset, attachment.offset) < summary.chunk_indexes[0].chunk_start_offset


@pytest.mark.parametrize("log", ["data", "no_steps"])
def test_summary_offsets_delimit_groups_that_fill_the_summary(request, log):
    data = request.getfixturevalue(log)
    footer = footer_of(data)
    end = len(data) - MAGIC_SIZE - FOOTER_SIZE
    offsets = [
        SummaryOffset.read(ReadDataStream(io.BytesIO(body)))
        for _, body in records_at(data, footer.summary_offset_start, end - footer.summary_offset_start)
    ]
    position = footer.summary_start
    for offset in offsets:
        assert offset.group_start == position
        group = list(records_at(data, offset.group_start, offset.group_length))
        assert {opcode for opcode, _ in group} == {offset.group_opcode}
        position += offset.group_length
    assert position == footer.summary_offset_start
    chunk_index = {8} if log == "data" else set()
    assert {offset.group_opcode for offset in offsets} == {3, 4, 10, 11, 13} | chunk_index


def test_the_crcs_of_data_section_and_summary(data):
    footer = footer_of(data)
    crc_start = len(data) - MAGIC_SIZE - 4
    assert footer.summary_crc == zlib.crc32(data[footer.summary_start : crc_start])
    data_end = next(found for found in StreamReader(io.BytesIO(data)).records if isinstance(found, DataEnd))
    data_end_start = footer.summary_start - PREFIX.size - 4
    assert data_end.data_section_crc == zlib.crc32(data[:data_end_start])


def test_a_log_without_steps_is_a_whole_file(no_steps):
    reader = make_reader(io.BytesIO(no_steps), validate_crcs=True)
    assert list(reader.iter_messages()) == []
    assert reader.get_summary().statistics.message_count == 0
