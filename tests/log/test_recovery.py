"""What is left of a log that was cut anywhere, or in which a bit flipped."""

import os
import random
import struct

import numpy as np
import pytest
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.log import mcap_file, writer
from visitlab_cli.log.reader import read_metadata, read_steps, read_trial, trials
from visitlab_cli.log.recovery.recovery import recover

from .blocks import ATTRIBUTES, CONFIG, random_steps, record

PREFIX = struct.Struct("<BQ")
MAGIC_SIZE = 8
TRIAL_STEPS = 20
SMALL_CHUNK = 16
PARTS = 8  # of the cuts, of which every eighth is made each time
IN_DATA = {Opcode.HEADER, Opcode.METADATA, Opcode.ATTACHMENT, Opcode.SCHEMA, Opcode.CHANNEL, Opcode.MESSAGE_INDEX}
IN_SUMMARY = {Opcode.CHUNK_INDEX, Opcode.STATISTICS, Opcode.METADATA_INDEX, Opcode.ATTACHMENT_INDEX}
AT_THE_END = {Opcode.DATA_END, Opcode.SUMMARY_OFFSET, Opcode.FOOTER}


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch):
    monkeypatch.setattr(mcap_file.os, "fsync", lambda descriptor: None)


@pytest.fixture
def small(tmp_path, monkeypatch):
    """A log of three trials in chunks of 16 rows, as small as it can be: cut at each of its bytes."""
    monkeypatch.setattr(writer, "CHUNK_STEPS", SMALL_CHUNK)
    columns, rows = random_steps(trials=3, trial_steps=TRIAL_STEPS)
    return record(tmp_path / "small.mcap", "social", columns, rows)


@pytest.fixture(scope="module")
def large(tmp_path_factory):
    columns, rows = random_steps(trials=600, trial_steps=100)
    return record(tmp_path_factory.mktemp("large") / "large.mcap", "visit", columns, rows)


def records_of(data):
    """(opcode, start, end) of every record of a whole file."""
    position = MAGIC_SIZE
    while position < len(data) - MAGIC_SIZE:
        opcode, length = PREFIX.unpack_from(data, position)
        yield opcode, position, position + PREFIX.size + length
        position += PREFIX.size + length


def kept_rows(data, cut, chunk_steps, rows):
    """How many rows are in the chunks that end before `cut`."""
    chunks = sum(opcode == Opcode.CHUNK and end <= cut for opcode, _, end in records_of(data))
    return min(chunks * chunk_steps, rows)


def damaged(tmp_path, content):
    """A file of its own with `content`, and where it is to be recovered to."""
    broken, fixed = tmp_path / "broken.mcap", tmp_path / "fixed.mcap"
    broken.write_bytes(content)
    fixed.unlink(missing_ok=True)
    return broken, fixed


def check_whole(fixed):
    """The stock reader finds every message, all CRCs checked, by the indexes and without them."""
    with fixed.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        count = reader.get_summary().statistics.message_count
        assert len(list(reader.iter_decoded_messages())) == count
        assert len(list(reader.iter_messages(log_time_order=False))) == count


@pytest.mark.parametrize("part", [0, *(pytest.param(part, marks=pytest.mark.slow) for part in range(1, PARTS))])
def test_a_file_cut_at_any_byte_gives_back_all_its_whole_chunks(small, tmp_path, part):
    data = small.read_bytes()
    steps = read_steps(small)
    rows = len(steps["step"])
    channel_end = next(end for opcode, _, end in records_of(data) if opcode == Opcode.CHANNEL)
    checked = set()
    broken, fixed = damaged(tmp_path, data)
    for cut in reversed(range(part, len(data), PARTS)):
        os.truncate(broken, cut)
        fixed.unlink(missing_ok=True)
        if cut < channel_end or not kept_rows(data, cut, SMALL_CHUNK, rows):
            with pytest.raises(RunError, match="nothing in it can be saved"):
                recover(broken, fixed)
            assert not fixed.exists()
            continue
        saved = recover(broken, fixed)
        kept = kept_rows(data, cut, SMALL_CHUNK, rows)
        found = steps["step"][:kept]
        ended = sum(end <= kept for end in range(TRIAL_STEPS + 1, rows + 1, TRIAL_STEPS + 1))
        assert (saved.steps, saved.trials) == (np.count_nonzero(found), ended)
        assert saved.trials + saved.parts == len(np.unique(steps["trial"][:kept]))
        assert not saved.was_whole
        if kept not in checked:
            checked.add(kept)
            check_whole(fixed)
            for name, values in read_steps(fixed).items():
                np.testing.assert_array_equal(values, steps[name][:kept])
    assert len(checked) == len(range(SMALL_CHUNK, rows, SMALL_CHUNK)) + 1
    assert list(tmp_path.glob(".tmp-*")) == []


def test_a_large_file_cut_at_random_bytes_gives_back_all_its_whole_chunks(large, tmp_path):
    data, steps = large.read_bytes(), read_steps(large)
    rows = len(steps["step"])
    for cut in random.Random(0).sample(range(len(data) // 100, len(data)), 12):
        broken, fixed = damaged(tmp_path, data[:cut])
        kept = kept_rows(data, cut, writer.CHUNK_STEPS, rows)
        if not kept:
            with pytest.raises(RunError, match="nothing in it can be saved: no step of it is whole$"):
                recover(broken, fixed)
            continue
        saved = recover(broken, fixed)
        assert saved.steps == np.count_nonzero(steps["step"][:kept])
        np.testing.assert_array_equal(read_steps(fixed, ["state"])["state"], steps["state"][:kept])
        assert broken.read_bytes() == data[:cut]


def test_a_whole_file_is_copied_byte_by_byte(small, large, tmp_path):
    for whole in (small, large):
        saved = recover(whole, tmp_path / f"copy of {whole.name}")
        assert (saved.was_whole, saved.lost_bytes, saved.parts) == (True, 0, 0)
        assert saved.path.read_bytes() == whole.read_bytes()


def test_a_cut_keeps_metadata_and_config(small, tmp_path):
    data = small.read_bytes()
    cut = [end for opcode, _, end in records_of(data) if opcode == Opcode.CHUNK][1]
    broken, fixed = damaged(tmp_path, data[:cut])
    recover(broken, fixed)
    assert read_metadata(fixed) == ATTRIBUTES | {"format": "1", "task": "social", "one_trial_in": "1"}
    with fixed.open("rb") as file:
        assert [attachment.data for attachment in make_reader(file).iter_attachments()] == [CONFIG]


def flips(data, opcodes, chosen):
    """A copy of `data` for each of some bits of the first records of `opcodes`: prefix, beginning, middle, end."""
    seen = set()
    for opcode, start, end in records_of(data):
        if opcode in opcodes and opcode not in seen:
            seen.add(opcode)
            places = {start, start + 1, start + 3, start + PREFIX.size, start + 13, (start + end) // 2, end - 1}
            places |= {chosen.randrange(start, end) for _ in range(6)}
            for place in sorted(places):
                flipped = bytearray(data)
                flipped[min(place, end - 1)] ^= 1 << chosen.randrange(8)
                yield opcode, place, bytes(flipped)
    assert seen == set(opcodes)


def test_a_flipped_bit_outside_of_the_chunks_loses_no_step(small, tmp_path):
    data, steps = small.read_bytes(), read_steps(small)
    for opcode, place, flipped in flips(data, IN_DATA | IN_SUMMARY | AT_THE_END, random.Random(1)):
        broken, fixed = damaged(tmp_path, flipped)
        with pytest.raises(RunError, match=r"^[^\n]+; visitlab recover [^\n]+ saves what is whole$"):
            read_steps(broken)
        saved = recover(broken, fixed)
        assert (saved.trials, saved.parts, saved.was_whole) == (3, 0, False), (opcode, place)
        check_whole(fixed)
        for name, values in read_steps(fixed).items():
            np.testing.assert_array_equal(values, steps[name], err_msg=f"{opcode} {place}")


def test_a_flipped_bit_in_a_chunk_loses_at_most_that_chunk(small, tmp_path):
    data, steps = small.read_bytes(), read_steps(small)
    without_first = {name: values[SMALL_CHUNK:] for name, values in steps.items()}
    lost = 0
    for _, place, flipped in flips(data, {Opcode.CHUNK}, random.Random(2)):
        broken, fixed = damaged(tmp_path, flipped)
        saved = recover(broken, fixed)
        check_whole(fixed)
        found = read_steps(fixed)
        expected = steps if len(found["step"]) == len(steps["step"]) else without_first
        lost += expected is without_first
        assert saved.trials == (3 if expected is steps else 2), place
        for name, values in found.items():
            np.testing.assert_array_equal(values, expected[name])
    assert lost


@pytest.mark.parametrize("place", [0, 3, -1, -5])
def test_a_flipped_bit_in_the_magic_loses_nothing(small, tmp_path, place):
    data = bytearray(small.read_bytes())
    data[place] ^= 4
    broken, fixed = damaged(tmp_path, bytes(data))
    with pytest.raises(RunError, match="visitlab recover"):
        read_trial(broken, 0)
    assert recover(broken, fixed).trials == 3
    assert fixed.read_bytes() == small.read_bytes()


def test_random_flips_in_a_large_file_lose_a_chunk_each_at_most(large, tmp_path):
    data, steps = large.read_bytes(), read_steps(large)
    chosen = random.Random(3)
    for _ in range(12):
        flipped = bytearray(data)
        for _ in range(2):
            flipped[chosen.randrange(len(data) // 20, len(data))] ^= 1 << chosen.randrange(8)
        broken, fixed = damaged(tmp_path, bytes(flipped))
        recover(broken, fixed)
        found = read_steps(fixed, ["trial", "step", "state"])
        assert len(found["step"]) >= len(steps["step"]) - 2 * writer.CHUNK_STEPS
        rows = found["trial"].astype(int) * 101 + found["step"]
        assert (np.diff(rows) > 0).all()
        np.testing.assert_array_equal(found["state"], steps["state"][rows])


def test_what_a_lost_chunk_left_of_a_trial_is_not_given_as_the_trial(small, tmp_path):
    data = bytearray(small.read_bytes())
    start, end = [(start, end) for opcode, start, end in records_of(data) if opcode == Opcode.CHUNK][1]
    data[(start + end) // 2] ^= 1
    broken, fixed = damaged(tmp_path, bytes(data))
    saved = recover(broken, fixed)  # rows 16 to 31: the end of trial 0 and the beginning of trial 1
    assert (saved.steps, saved.trials, saved.parts) == (60 - 15, 1, 2)
    for trial, left in ((0, 16), (1, 10)):
        with pytest.raises(RunError, match=rf"of trial {trial} only {left} rows are left"):
            read_trial(fixed, trial)
    assert len(read_trial(fixed, 2)["step"]) == TRIAL_STEPS + 1
    assert trials(fixed)["trial"].tolist() == [1, 2]


def test_the_new_file_is_beside_the_old_one_and_nothing_is_overwritten(small):
    whole = small.read_bytes()
    small.write_bytes(whole[:-30])
    assert recover(small).path == small.with_name("small.recovered.mcap")
    assert small.with_name("small.recovered.mcap").read_bytes() == whole
    with pytest.raises(UsageError, match=r"small.recovered.mcap: exists; choose another file with -o$"):
        recover(small)
    with pytest.raises(UsageError, match=r"small.mcap: is the file to recover"):
        recover(small, small.parent / "." / small.name)
    assert small.read_bytes() == whole[:-30]


@pytest.mark.parametrize("content", [b"", b"a text", b"\x89MCAP0\r\n", bytes(100_000)])
def test_a_file_without_anything_whole_is_one_line(tmp_path, content):
    broken, fixed = damaged(tmp_path, content)
    with pytest.raises(RunError, match=r"^[^\n]+broken.mcap: nothing in it can be saved: [^\n]+$"):
        recover(broken, fixed)
    assert [path.name for path in tmp_path.iterdir()] == ["broken.mcap"]


def test_paths_that_do_not_work_are_one_line(small, tmp_path):
    with pytest.raises(NotFoundError, match=r"missing.mcap: no such file$"):
        recover(tmp_path / "missing.mcap")
    with pytest.raises(RunError, match=r"can't be written: [^\n]+$"):
        recover(small, tmp_path / "missing" / "fixed.mcap")
    with pytest.raises(RunError, match=r"cannot read the log: [^\n]+$"):
        recover(tmp_path, tmp_path / "fixed.mcap")


@pytest.mark.parametrize("name", [b"robot_heading", b"goal_room", b"trial"])
def test_a_changed_byte_of_a_schema_that_nothing_else_checks_costs_no_field(tiny_run, tmp_path, name):
    log = tiny_run / "navigation" / "mf" / "seed-0000" / "steps.mcap"
    content = bytearray(log.read_bytes())
    content[
        content.index(b"visitlab.Step")
        + content[content.index(b"visitlab.Step") :].index(b"\x0a" + bytes([len(name)]) + name)
        + 3
    ] ^= 2
    broken, whole = tmp_path / "broken.mcap", tmp_path / "whole.mcap"
    broken.write_bytes(content[:-20])
    recover(broken, whole)
    expected, found = read_steps(log), read_steps(whole)
    assert {key: values.tolist() for key, values in found.items()} == {
        key: values.tolist() for key, values in expected.items()
    }
