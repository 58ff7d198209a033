"""Recovery takes nothing for damage that the format allows, and loses nothing that can be read."""

import struct
import time

import numpy as np
import pytest

from visitlab_cli.errors import RunError
from visitlab_cli.log import mcap_file, reader
from visitlab_cli.log.reader import read_attachment, read_steps
from visitlab_cli.log.recovery.recovery import recover
from visitlab_cli.world.lab import paper_lab

from . import raw
from .blocks import message_class, random_steps, record, serialized

TRIALS, TRIAL_STEPS = 4, 20
ROWS = TRIALS * (TRIAL_STEPS + 1)
DEFINED = raw.schema(1) + raw.channel(1)


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch):
    monkeypatch.setattr(mcap_file.os, "fsync", lambda descriptor: None)


@pytest.fixture(scope="module")
def steps():
    return random_steps(TRIALS, TRIAL_STEPS)[0]


@pytest.fixture(scope="module")
def messages(steps):
    step = message_class("Step")
    return [raw.message(1, serialized(step, "visit", steps, row), row) for row in range(ROWS)]


def joined(parts, between=b""):
    return between.join(parts)


def with_crc(*records):
    return raw.whole(*records, end=raw.data_end(raw.MAGIC + b"".join(records)))


PRIVATE = raw.record(raw.PRIVATE, b"private") + raw.record(raw.FUTURE, b"future")
MAKES = {
    "padding behind each record": lambda m: raw.whole(
        raw.padded(raw.HEADER),
        raw.padded(DEFINED[: len(raw.schema(1))]),
        raw.padded(raw.channel(1)),
        raw.padded(raw.metadata()),
        raw.padded(raw.attachment()),
        raw.padded(raw.chunk(joined(m))),
        end=raw.padded(raw.data_end()),
    ),
    "padding, with a CRC": lambda m: with_crc(
        raw.HEADER, raw.padded(raw.channel(1)), raw.schema(1), raw.chunk(joined(m))
    ),
    "private and future records between messages": lambda m: raw.whole(
        raw.HEADER, PRIVATE, DEFINED, PRIVATE, joined(m, PRIVATE), PRIVATE
    ),
    "private records in chunks": lambda m: raw.whole(
        raw.HEADER, raw.chunk(PRIVATE + DEFINED + joined(m, PRIVATE), "lz4")
    ),
    "only chunks, no CRC": lambda m: raw.whole(
        raw.HEADER, raw.chunk(DEFINED + joined(m[:30]), "", crc=0), raw.chunk(joined(m[30:]), "zstd", crc=0)
    ),
    "empty chunks": lambda m: raw.whole(
        raw.HEADER,
        raw.chunk(b"", ""),
        raw.chunk(DEFINED, "lz4"),
        raw.chunk(b""),
        raw.chunk(joined(m)),
        raw.chunk(b"", "lz4"),
    ),
    "everything repeated, attachments anywhere": lambda m: raw.whole(
        raw.HEADER,
        raw.attachment(),
        *(raw.chunk(DEFINED + one) + raw.attachment(data=b"") + raw.metadata() for one in m),
    ),
    "several ends of the data": lambda m: raw.whole(
        raw.HEADER,
        DEFINED,
        raw.chunk(joined(m[:9])),
        raw.data_end(),
        raw.chunk(joined(m[9:50])),
        raw.data_end(),
        joined(m[50:]),
    ),
    "chunked and not": lambda m: raw.whole(
        raw.HEADER, DEFINED, joined(m[:9]), raw.chunk(joined(m[9:50])), joined(m[50:]), raw.attachment()
    ),
    "defined after its messages": lambda m: raw.whole(raw.HEADER, raw.chunk(joined(m)), DEFINED),
}


def check(path, steps):
    found = read_steps(path)
    for name, values in found.items():
        np.testing.assert_array_equal(values, getattr(steps, name), err_msg=name)


@pytest.mark.parametrize("make", MAKES)
def test_what_the_format_allows_is_whole(tmp_path, steps, messages, make):
    path = tmp_path / "a.mcap"
    path.write_bytes(MAKES[make](messages))
    check(path, steps)
    saved = recover(path)
    assert (saved.was_whole, saved.lost_bytes, saved.steps) == (True, 0, TRIALS * TRIAL_STEPS)
    assert saved.path.read_bytes() == path.read_bytes()


@pytest.mark.parametrize("make", MAKES)
def test_nothing_of_it_is_lost_with_its_end(tmp_path, steps, messages, make):
    path = tmp_path / "a.mcap"
    path.write_bytes(MAKES[make](messages)[:-12])
    saved = recover(path)
    assert not saved.was_whole
    check(saved.path, steps)
    data = saved.path.read_bytes()
    if "private" in make and "chunks" not in make:
        assert data.count(PRIVATE) == ROWS + 2
    if "attachments" in make:
        assert (data.count(raw.attachment(data=b"")), data.count(raw.metadata())) == (ROWS, ROWS)
        assert read_attachment(saved.path, "notes") == b"some"


@pytest.mark.parametrize("make", [make for make in MAKES if not make.startswith("padding")])
def test_damage_between_records_loses_none_of_them(tmp_path, steps, messages, make):
    data = MAKES[make](messages)
    place = data.rindex(messages[-1]) if messages[-1] in data else len(raw.MAGIC) + len(raw.HEADER)
    path = tmp_path / "a.mcap"
    path.write_bytes(data[:place] + bytes(1000) + data[place:])
    saved = recover(path)
    assert saved.lost_bytes == 1000
    check(saved.path, steps)


def test_joined_files_are_each_saved_alone(tmp_path, steps):
    files = [record(tmp_path / f"{task}.mcap", task, steps, ROWS) for task in ("visit", "social", "navigation")]
    path = tmp_path / "joined.mcap"
    path.write_bytes(b"".join(file.read_bytes() for file in files))
    first_bytes = np.cumsum([file.stat().st_size for file in files]).tolist()
    with pytest.raises(RunError, match=f"another MCAP file follows behind its end at byte {first_bytes[0]:,}; "):
        read_steps(path)
    saved = recover(path)
    every = (saved, *saved.others)
    assert [one.path.name for one in every] == [f"joined.recovered{n}.mcap" for n in ("", "-2", "-3")]
    assert [one.path.read_bytes() for one in every] == [file.read_bytes() for file in files]
    assert [one.first_byte for one in every] == [0, *first_bytes[:2]]
    assert (saved.was_whole, saved.lost_bytes, saved.left_out) == (False, 0, ())


def test_a_file_behind_one_that_was_cut_or_is_no_log_is_saved(tmp_path, steps):
    ours = record(tmp_path / "a.mcap", "visit", steps, ROWS).read_bytes()
    other = raw.whole(raw.HEADER, raw.attachment())
    path = tmp_path / "joined.mcap"
    path.write_bytes(ours[:-200] + other + ours)
    saved = recover(path)
    assert [one.path.name for one in (saved, *saved.others)] == ["joined.recovered.mcap", "joined.recovered-2.mcap"]
    assert all(one.path.read_bytes() == ours for one in (saved, *saved.others))
    where = f"{len(other):,} bytes from byte {len(ours) - 200:,} on"
    assert saved.left_out == (f"{where}: is whole, there is nothing to recover: it is no log of visitlab",)


@pytest.mark.parametrize("tail", [bytes(1 << 16), b"\x05" + bytes(8), b"text"])
def test_bytes_behind_the_end_are_told_as_such(tmp_path, steps, tail):
    path = record(tmp_path / "a.mcap", "visit", steps, ROWS)
    size = path.stat().st_size
    path.write_bytes(path.read_bytes() + tail)
    with pytest.raises(RunError, match=f"not a whole MCAP file: bytes follow behind its end at byte {size:,}; "):
        read_steps(path)
    saved = recover(path)
    assert saved.lost_bytes == len(tail)
    assert saved.path.read_bytes() == path.read_bytes()[:size]


def test_messages_that_are_damaged_cost_no_others(tmp_path, steps, messages):
    """Without chunks no CRC tells which of them are whole."""
    broken = raw.message(1, b"\xff\xff", 3) + raw.message(7, b"", 3)
    path = tmp_path / "a.mcap"
    path.write_bytes(raw.whole(raw.HEADER, DEFINED, joined(messages[:50]), broken, joined(messages[50:])))
    with pytest.raises(
        RunError, match=r"a.mcap: not a whole MCAP file: a message of /step is damaged; visitlab recover "
    ):
        read_steps(path)
    saved = recover(path)
    assert (saved.lost_bytes, saved.was_whole) == (len(broken), False)
    check(saved.path, steps)


@pytest.mark.parametrize(("content", "words"), [(b"", "it is empty"), (b"\x89MCAP", "5 bytes are too short")])
def test_a_file_with_next_to_nothing_says_so(tmp_path, content, words):
    path = tmp_path / "a.mcap"
    path.write_bytes(content)
    with pytest.raises(RunError, match=rf"a.mcap: not an MCAP file: {words}$"):
        read_steps(path)
    with pytest.raises(RunError, match=rf"a.mcap: nothing in it can be saved: ([^\n]+: )?{words}$"):
        recover(path)


def test_a_long_tail_of_zeros_is_no_long_wait(tmp_path, steps):
    path = record(tmp_path / "a.mcap", "visit", steps, ROWS)
    whole = path.read_bytes()
    with path.open("r+b") as file:
        file.truncate(len(whole) - 50)
        file.truncate(1 << 28)
    before = time.process_time()
    with pytest.raises(RunError, match="its records end at byte"):
        read_steps(path)
    assert recover(path).path.read_bytes() == whole
    assert time.process_time() - before < 5


def test_impossible_numbers_of_a_place_are_refused_like_any_other(tmp_path, steps):
    columns = {name: values[:21] for name, values in steps._asdict().items()}
    columns = {name: np.minimum(values, 3).astype(values.dtype) for name, values in columns.items() if name != "step"}
    for name in ("robot_row", "human_col", "state"):
        wrong = columns | {"step": np.arange(21), name: np.full(21, 4_000_000_000, np.uint32)}
        with pytest.raises(RunError, match=rf"a.mcap: step 0 of trial 0 has {name} 4000000000, which there is not$"):
            reader.check_values(tmp_path / "a.mcap", wrong, "visit", paper_lab())
    with pytest.raises(RunError, match=r"a.mcap: row 3 has action 31, which there is not$"):
        reader.check_values(tmp_path / "a.mcap", {"action": np.array([0, 30, 1, 31], np.uint8)}, "visit", paper_lab())


def test_numbers_of_trials_and_steps_have_an_end(tmp_path, steps, messages):
    step = message_class("Step").FromString(messages[30][31:])
    step.step = 4_000_000_000
    messages = [*messages[:30], raw.message(1, step.SerializeToString(), 30), *messages[31:]]
    path = tmp_path / "a.mcap"
    path.write_bytes(raw.whole(raw.HEADER, DEFINED, raw.chunk(joined(messages))))
    with pytest.raises(RunError, match=r"a.mcap: step 4000000000 of trial 1 has step 4000000000, which there is not$"):
        read_steps(path)
    assert struct.calcsize("<BQHIQQ") == 31


@pytest.mark.parametrize("between", [b"", PRIVATE])
def test_a_cut_outside_of_chunks_costs_the_cut_message_alone(tmp_path, messages, between):
    data = raw.whole(raw.HEADER, DEFINED, joined(messages, between))
    ends = [data.index(each) + len(each) for each in messages]
    path, fixed = tmp_path / "a.mcap", tmp_path / "fixed.mcap"
    for cut in range(ends[0], len(data), 97):
        path.write_bytes(data[:cut])
        fixed.unlink(missing_ok=True)
        assert len(read_steps(recover(path, fixed).path)["step"]) == sum(end <= cut for end in ends), cut
