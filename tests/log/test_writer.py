import gc
import io
import resource
import threading
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import NonSeekingReader, make_reader
from mcap.writer import MCAP0_MAGIC
from mcap_protobuf.decoder import DecoderFactory

from visitlab_cli.errors import RunError
from visitlab_cli.log.mcap_file import McapFile
from visitlab_cli.log.writer import CHUNK_STEPS, StepRecorder
from visitlab_cli.storage.cell_folder import describe
from visitlab_cli.world.columns import StepColumns, empty_columns
from visitlab_cli.world.tasks import TASK_NAMES, columns_of

from .blocks import (
    ATTRIBUTES,
    CONFIG,
    message_class,
    random_steps,
    record,
    serialized,
)

SECOND = 10**9


@pytest.mark.parametrize("task", TASK_NAMES)
def test_the_stock_reader_gives_the_bytes_of_the_protobuf_library(tmp_path, task):
    columns, rows = random_steps(trials=100, trial_steps=100)
    step = message_class("Step")
    with record(tmp_path / "a.mcap", task, columns, rows).open("rb") as file:
        messages = [m for _, _, m in make_reader(file, validate_crcs=True).iter_messages("/step")]
    assert rows > CHUNK_STEPS
    assert [m.data for m in messages] == [serialized(step, task, columns, row) for row in range(rows)]
    assert [(m.sequence, m.log_time, m.publish_time) for m in messages] == [
        (row, row * SECOND, row * SECOND) for row in range(rows)
    ]


@pytest.mark.parametrize("reader", [make_reader, NonSeekingReader])
@pytest.mark.parametrize("task", TASK_NAMES)
def test_stock_readers_decode_the_steps_with_crcs_validated(tmp_path, task, reader):
    columns, rows = random_steps(trials=450, trial_steps=20)
    names = {column.name for column in columns_of(task)}
    with record(tmp_path / "a.mcap", task, columns, rows).open("rb") as file:
        decoded = reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        steps = [message for *_, message in decoded.iter_decoded_messages("/step")]
    assert len(steps) == rows > CHUNK_STEPS
    assert {field.name for step in steps for field, _ in step.ListFields()} == names
    for name in names:
        assert [getattr(step, name) for step in steps] == getattr(columns, name).tolist()


@pytest.mark.parametrize(("task", "trial_steps"), [("visit", 100), ("social", 20), ("social", 127)])
def test_trials_follow_in_the_chunk_of_their_last_step(tmp_path, task, trial_steps):
    columns, rows = random_steps(trials=3 * CHUNK_STEPS // (trial_steps + 1), trial_steps=trial_steps)
    with record(tmp_path / "a.mcap", task, columns, rows).open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        summary = reader.get_summary()
        in_file_order = list(reader.iter_decoded_messages(log_time_order=False))
    trials = [(message, trial) for _, channel, message, trial in in_file_order if channel.topic == "/trial"]
    for number, (message, trial) in enumerate(trials):
        first = number * (trial_steps + 1)
        reward = float(columns.reward[first : first + trial_steps + 1].sum())
        assert (trial.trial, trial.first_step_time) == (number, first * SECOND)
        assert (trial.reward, trial.steps) == (reward, trial_steps)
        assert trial.HasField("goals") == (task == "visit")
        assert trial.goals == (reward if task == "visit" else 0)
        assert (message.sequence, message.log_time) == (number, (first + trial_steps) * SECOND)
    last_rows = np.arange(1, len(trials) + 1) * (trial_steps + 1) - 1
    expected = []
    for chunk, index in enumerate(summary.chunk_indexes):
        steps = min(CHUNK_STEPS, rows - chunk * CHUNK_STEPS)
        assert index.message_end_time == (chunk * CHUNK_STEPS + steps - 1) * SECOND
        expected += ["/step"] * steps + ["/trial"] * int((last_rows // CHUNK_STEPS == chunk).sum())
    assert [channel.topic for _, channel, *_ in in_file_order] == expected
    assert len(trials) == rows // (trial_steps + 1)


def test_a_last_trial_that_is_cut_counts_the_steps_it_has(tmp_path):
    columns, rows = random_steps(trials=3, trial_steps=20)
    with record(tmp_path / "a.mcap", "social", columns, rows - 5).open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        trials = [trial for *_, trial in reader.iter_decoded_messages("/trial")]
    assert [trial.steps for trial in trials] == [20, 20, 15]
    assert trials[2].reward == columns.reward[42 : rows - 5].sum()


def test_the_reward_of_a_trial_over_several_chunks_stays_its_own(tmp_path):
    lengths = [CHUNK_STEPS // 2, 2 * CHUNK_STEPS + CHUNK_STEPS // 2, 100]  # the second ends with its chunk
    columns = empty_columns(sum(lengths))
    columns.trial[:] = np.repeat(np.arange(3), lengths)
    columns.step[:] = np.concatenate([np.arange(length) for length in lengths])
    columns.reward[:] = 1
    with record(tmp_path / "a.mcap", "visit", columns, sum(lengths)).open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        trials = [trial for *_, trial in reader.iter_decoded_messages("/trial")]
    assert [trial.goals for trial in trials] == lengths
    assert [trial.first_step_time for trial in trials] == [0, lengths[0] * SECOND, 3 * CHUNK_STEPS * SECOND]


@pytest.mark.parametrize("one_trial_in", [1, 3])
@pytest.mark.parametrize("block", [1, 37, CHUNK_STEPS - 1, CHUNK_STEPS, CHUNK_STEPS + 1])
def test_the_bytes_do_not_depend_on_the_size_of_the_blocks(tmp_path, block, one_trial_in):
    columns, rows = random_steps(trials=200 * one_trial_in, trial_steps=127)
    whole = record(tmp_path / "whole.mcap", "visit", columns, rows, one_trial_in=one_trial_in)
    parts = record(tmp_path / "parts.mcap", "visit", columns, rows, block=block, one_trial_in=one_trial_in)
    assert parts.read_bytes() == whole.read_bytes()


def test_only_every_nth_trial_is_recorded_and_numbered_on(tmp_path):
    columns, rows = random_steps(trials=10, trial_steps=20)
    with record(tmp_path / "a.mcap", "social", columns, rows, one_trial_in=4).open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        steps = [(message, step) for _, _, message, step in reader.iter_decoded_messages("/step")]
        trials = [trial for *_, trial in reader.iter_decoded_messages("/trial")]
        metadata = next(iter(reader.iter_metadata())).metadata
    kept = np.flatnonzero(np.isin(columns.trial, [0, 4, 8]))
    assert [step.state for _, step in steps] == columns.state[kept].tolist()
    assert [message.log_time for message, _ in steps] == [n * SECOND for n in range(3 * 21)]
    assert [(t.trial, t.first_step_time) for t in trials] == [(0, 0), (4, 21 * SECOND), (8, 42 * SECOND)]
    assert metadata["one_trial_in"] == "4"


def test_a_killed_recorder_leaves_metadata_config_and_whole_chunks(tmp_path):
    columns, rows = random_steps(trials=100, trial_steps=100)
    path = tmp_path / "a.mcap"
    with StepRecorder(path, "visit", attributes=ATTRIBUTES, config_yaml=CONFIG) as recorder:
        prelude = path.read_bytes()
        recorder.write(columns, rows)
        recorder.position()  # whose file is what a kill would leave once the thread has done what it was handed
        left = path.read_bytes()
    with path.open("rb") as file:
        first = make_reader(file).get_summary().chunk_indexes[0]
    assert len(prelude) == first.chunk_start_offset
    assert left == path.read_bytes()[: len(left)]
    assert len(left) == first.chunk_start_offset + first.chunk_length + first.message_index_length
    metadata = next(NonSeekingReader(io.BytesIO(left)).iter_metadata())
    attachment = next(NonSeekingReader(io.BytesIO(left)).iter_attachments())
    assert metadata.name == "visitlab"
    assert metadata.metadata == ATTRIBUTES | {"format": "1", "task": "visit", "one_trial_in": "1"}
    assert (attachment.name, attachment.data) == ("config.yaml", CONFIG)
    assert (attachment.log_time, attachment.create_time) == (0, 0)
    reader = NonSeekingReader(io.BytesIO(left), validate_crcs=True)
    messages = reader.iter_messages("/step", log_time_order=False)
    found = [next(messages)[2].sequence for _ in range(CHUNK_STEPS)]
    assert found == list(range(CHUNK_STEPS))


@pytest.fixture
def slow(monkeypatch):
    """A disk at which the thread is behind."""
    write_chunk = McapFile.write_chunk

    def late(self, blocks):
        time.sleep(0.05)
        write_chunk(self, blocks)

    monkeypatch.setattr(McapFile, "write_chunk", late)


def test_a_position_is_that_of_all_that_was_written(tmp_path, slow):
    """Also when the thread is behind: the file as it was then, and another that goes on from it."""
    columns, rows = random_steps(trials=300, trial_steps=100)
    whole = record(tmp_path / "whole.mcap", "visit", columns, rows).read_bytes()
    middle = 2 * CHUNK_STEPS + 1
    before = tmp_path / "before.mcap"
    with StepRecorder(before, "visit", attributes=ATTRIBUTES, config_yaml=CONFIG) as recorder:
        recorder.write(columns, middle)
        position = {name: array.copy() for name, array in recorder.position().items()}
        assert position["numbers"][2] == 2 * CHUNK_STEPS
        assert len(position["rows"]) == recorder._chunk.itemsize
        assert before.read_bytes() == whole[: position["numbers"][0]]
        recorder.write(StepColumns(*(values[middle:] for values in columns)), rows - middle)
    assert before.read_bytes() == whole
    for damaged in (True, False):
        path = tmp_path / f"{damaged}.mcap"
        with StepRecorder(path, "visit", attributes=ATTRIBUTES, config_yaml=CONFIG) as recorder:
            if damaged:
                with pytest.raises(ValueError, match="cut"):
                    recorder.go_on(io.BytesIO(whole[: position["numbers"][0] - 1]), position)
                recorder.write(columns, rows)
            else:
                recorder.go_on(io.BytesIO(whole), position)
                recorder.write(StepColumns(*(values[middle:] for values in columns)), rows - middle)
        assert path.read_bytes() == whole
        assert recorder.described() == describe(path)


@pytest.mark.parametrize("rows", [0, 100, CHUNK_STEPS, CHUNK_STEPS + 1, 3 * CHUNK_STEPS])
def test_size_and_digest_are_those_of_the_file(tmp_path, rows):
    columns, _ = random_steps(trials=1, trial_steps=rows)
    with StepRecorder(tmp_path / "a.mcap", "visit", attributes=ATTRIBUTES, config_yaml=CONFIG) as recorder:
        recorder.write(columns, rows)
    assert recorder.described() == describe(tmp_path / "a.mcap")


def test_an_exception_leaves_the_file_unfinished(tmp_path):
    columns, rows = random_steps(trials=100, trial_steps=100)
    path = tmp_path / "a.mcap"

    def interrupted() -> None:
        with StepRecorder(path, "visit", attributes=ATTRIBUTES, config_yaml=CONFIG) as recorder:
            recorder.write(columns, rows)
            raise KeyboardInterrupt

    threads = threading.active_count()
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert threading.active_count() == threads
    assert path.stat().st_size > 0
    assert not path.read_bytes().endswith(MCAP0_MAGIC)


@pytest.mark.parametrize(
    ("name", "trial"), [("distance", 1), ("human_action", 2), ("goal_room", 600), ("distance", 1199)]
)
def test_a_value_that_does_not_fit_is_refused(tmp_path, name, trial):
    """Also in the thread, in the last block, too."""
    columns, rows = random_steps(trials=1200, trial_steps=20)
    getattr(columns, name)[21 * trial + 4] = 128
    message = f"step 4 of trial {trial} has {name} 128, the log holds 0 to 127"
    threads = threading.active_count()
    with pytest.raises(RunError, match=message):
        record(tmp_path / "a.mcap", "visit", columns, rows, block=1000)
    assert threading.active_count() == threads


@pytest.mark.parametrize("one_trial_in", [1, 2])
def test_a_block_that_was_given_may_change(tmp_path, slow, one_trial_in):
    columns, rows = random_steps(trials=300, trial_steps=100)
    whole = record(tmp_path / "whole.mcap", "visit", columns, rows, one_trial_in=one_trial_in).read_bytes()
    path, size = tmp_path / "a.mcap", CHUNK_STEPS + 1
    given = empty_columns(size)
    with StepRecorder(path, "visit", attributes=ATTRIBUTES, config_yaml=CONFIG, one_trial_in=one_trial_in) as recorder:
        for start in range(0, rows, size):
            for ours, values in zip(given, columns, strict=True):
                ours[: rows - start] = values[start : start + size]
            recorder.write(given, min(size, rows - start))
            for ours in given:
                ours[:] = 0
    assert path.read_bytes() == whole


def test_a_value_that_the_task_lacks_is_not_looked_at(tmp_path):
    columns, rows = random_steps(trials=3, trial_steps=20)
    columns.distance[:] = 200
    assert record(tmp_path / "a.mcap", "navigation", columns, rows).stat().st_size > 0


def test_more_rows_than_the_block_has_are_a_bug(tmp_path):
    with pytest.raises(ValueError, match="9 rows of a block of 8"):
        record(tmp_path / "a.mcap", "social", empty_columns(8), 9)


def test_a_column_of_a_wider_type_is_a_bug(tmp_path):
    columns, rows = random_steps(trials=3, trial_steps=20)
    wider = columns._replace(state=columns.state.astype(np.int64))
    with pytest.raises(TypeError, match="Cannot cast"):
        record(tmp_path / "a.mcap", "social", wider, rows)


def test_two_writes_give_the_same_bytes(tmp_path):
    columns, rows = random_steps(trials=90, trial_steps=100)
    first = record(tmp_path / "first.mcap", "visit", columns, rows).read_bytes()
    assert record(tmp_path / "second.mcap", "visit", columns, rows).read_bytes() == first
    columns.state[-1] ^= 1
    assert record(tmp_path / "third.mcap", "visit", columns, rows).read_bytes() != first


def test_memory_does_not_grow_with_the_file(tmp_path):
    columns, rows = random_steps(trials=82, trial_steps=100)

    def peak(blocks: int) -> int:
        tracemalloc.start()
        with StepRecorder(tmp_path / "a.mcap", "visit", attributes={}, config_yaml=b"") as recorder:
            for _ in range(blocks):
                recorder.write(columns, rows)
            highest = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return highest

    assert peak(20) < peak(4) + 100_000


@pytest.mark.filterwarnings("error")
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_a_full_disk_is_one_line():
    with pytest.raises(RunError, match=r"^/dev/full: cannot write the log: No space left on device$"):
        StepRecorder(Path("/dev/full"), "social", attributes={}, config_yaml=b"")
    gc.collect()  # an open file would be warned of here


@pytest.mark.parametrize(("trials", "block"), [(60, None), (100, None), (400, 1000), (400, 20_000)])
def test_a_disk_that_fills_up_while_recording_is_one_line(tmp_path, trials, block):
    """Found at the end, and in the thread at the end, between blocks, in a block."""
    columns, rows = random_steps(trials=trials, trial_steps=100)
    threads = threading.active_count()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, hard))
    try:
        with pytest.raises(RunError, match=r"a\.mcap: cannot write the log: File too large$") as caught:
            record(tmp_path / "a.mcap", "visit", columns, rows, block=block)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert isinstance(caught.value.__cause__, OSError), "by which a checkpoint is kept"
    assert threading.active_count() == threads


@pytest.mark.parametrize("path", ["missing/a.mcap", "."])
def test_a_path_that_cannot_be_written_is_one_line(tmp_path, path):
    with pytest.raises(RunError, match=r"^.+: cannot write the log: [^\n]+$"):
        StepRecorder(tmp_path / path, "social", attributes={}, config_yaml=b"")
