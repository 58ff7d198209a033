import os
import shlex
import tracemalloc

import numpy as np
import pytest
from mcap.reader import make_reader

from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.log import log, writer
from visitlab_cli.log.reader import iter_steps, read_metadata, read_steps, read_trial, trials
from visitlab_cli.log.writer import CHUNK_STEPS
from visitlab_cli.world.tasks import TASK_NAMES, columns_of

from .blocks import ATTRIBUTES, random_steps, record

TRIALS, TRIAL_STEPS = 100, 100


@pytest.fixture
def steps():
    return random_steps(TRIALS, TRIAL_STEPS)


@pytest.mark.parametrize("task", TASK_NAMES)
def test_read_steps_gives_what_was_written(tmp_path, steps, task):
    columns, rows = steps
    found = read_steps(record(tmp_path / "a.mcap", task, columns, rows))
    assert list(found) == [column.name for column in columns_of(task)]
    for name, values in found.items():
        written = getattr(columns, name)
        assert values.dtype == written.dtype
        np.testing.assert_array_equal(values, written)


def test_read_metadata_gives_what_was_written(tmp_path, steps):
    path = record(tmp_path / "a.mcap", "social", *steps, one_trial_in=3)
    assert read_metadata(path) == ATTRIBUTES | {"format": "1", "task": "social", "one_trial_in": "3"}


@pytest.mark.parametrize("trial", [0, 40, CHUNK_STEPS // (TRIAL_STEPS + 1), TRIALS - 1])
def test_read_trial_gives_the_rows_of_the_trial(tmp_path, steps, trial):
    columns, rows = steps
    found = read_trial(record(tmp_path / "a.mcap", "visit", columns, rows), trial)
    for name, values in found.items():
        np.testing.assert_array_equal(values, getattr(columns, name)[columns.trial == trial])
    assert found["step"].tolist() == list(range(TRIAL_STEPS + 1))


def test_read_trial_of_a_thinned_log(tmp_path, steps):
    columns, rows = steps
    path = record(tmp_path / "a.mcap", "visit", columns, rows, one_trial_in=7)
    np.testing.assert_array_equal(read_trial(path, 21)["state"], columns.state[columns.trial == 21])
    with pytest.raises(NotFoundError, match=r"trial 22 is not recorded; the log holds 0 to 98, one in 7$"):
        read_trial(path, 22)


def test_a_trial_that_is_not_recorded_is_answered_with_the_range(tmp_path, steps):
    path = record(tmp_path / "a.mcap", "visit", *steps)
    with pytest.raises(NotFoundError, match=r"trial 100 is not recorded; the log holds 0 to 99$"):
        read_trial(path, 100)
    empty = record(tmp_path / "empty.mcap", "visit", *random_steps(0, 20))
    with pytest.raises(NotFoundError, match=r"trial 0 is not recorded; the log holds none$"):
        read_trial(empty, 0)


@pytest.mark.parametrize(("task", "goals"), [("visit", True), ("social", False)])
def test_trials_sums_the_rewards(tmp_path, steps, task, goals):
    columns, rows = steps
    table = trials(record(tmp_path / "a.mcap", task, columns, rows))
    rewards = columns.reward.reshape(TRIALS, TRIAL_STEPS + 1).sum(axis=1)
    np.testing.assert_array_equal(table["trial"], np.arange(TRIALS))
    np.testing.assert_array_equal(table["reward"], rewards)
    np.testing.assert_array_equal(table["first_step_time"], np.arange(TRIALS) * 101 * 10**9)
    assert (table["steps"] == TRIAL_STEPS).all()
    assert ("goals" in table) == goals
    np.testing.assert_array_equal(table.get("goals", rewards), rewards)


READERS = [read_metadata, read_steps, trials, lambda path: read_trial(path, 0), lambda path: list(iter_steps(path))]
BROKEN = r"^[^\n]+a\.mcap: not a whole MCAP file: [^\n]+; visitlab recover [^\n]+a\.mcap saves what is whole$"


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("left", [0.1, 0.5, 0.99, -1])
def test_a_cut_file_is_one_line_that_says_how_to_mend_it(tmp_path, steps, read, left):
    path = record(tmp_path / "a.mcap", "social", *steps)
    size = path.stat().st_size
    os.truncate(path, size - 1 if left < 0 else int(size * left))
    with pytest.raises(RunError, match=BROKEN):
        read(path)


@pytest.mark.parametrize("read", [read_steps, trials, lambda path: list(iter_steps(path))])
def test_a_changed_byte_anywhere_is_noticed_where_the_whole_is_read(tmp_path, steps, read):
    data = record(tmp_path / "whole.mcap", "social", *steps).read_bytes()
    path = tmp_path / "a.mcap"
    for place in range(7, len(data), len(data) // 40):
        path.write_bytes(data[:place] + bytes([data[place] ^ 1]) + data[place + 1 :])
        with pytest.raises(RunError, match=BROKEN):
            read(path)


def test_a_changed_byte_is_noticed_in_the_chunk_that_a_trial_is_in(tmp_path, steps):
    path = record(tmp_path / "a.mcap", "social", *steps)
    with path.open("rb") as file:
        first, _ = make_reader(file).get_summary().chunk_indexes
    data = bytearray(path.read_bytes())
    data[first.chunk_start_offset + first.chunk_length // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(RunError, match=BROKEN):
        read_trial(path, 0)


def test_how_to_mend_it_can_be_pasted(tmp_path, steps):
    path = record(tmp_path / "a log.mcap", "social", *steps)
    os.truncate(path, 5000)
    with pytest.raises(RunError) as error:
        read_steps(path)
    command = str(error.value).rpartition("; ")[2].removesuffix(" saves what is whole")
    assert shlex.split(command) == ["visitlab", "recover", str(path)]


@pytest.mark.parametrize("columns", [["reward"], ["state", "trial"], []])
def test_only_the_columns_that_are_asked_for(tmp_path, steps, columns):
    path = record(tmp_path / "a.mcap", "visit", *steps)
    for found in (read_steps(path, columns), read_trial(path, 40, columns)):
        assert list(found) == columns
    for name, values in read_steps(path, columns).items():
        np.testing.assert_array_equal(values, getattr(steps[0], name))


@pytest.mark.parametrize("read", [read_steps, lambda *args: read_trial(args[0], 0, args[1])])
def test_a_column_that_the_task_lacks_is_one_line(tmp_path, steps, read):
    path = record(tmp_path / "a.mcap", "navigation", *steps)
    with pytest.raises(UsageError, match=r"a.mcap: its steps have no column rewad; did you mean reward\?$"):
        read(path, ["rewad"])


def test_iter_steps_gives_a_chunk_at_a_time(tmp_path, steps):
    columns, _ = steps
    blocks = list(iter_steps(record(tmp_path / "a.mcap", "visit", *steps), ["trial", "state"]))
    assert [len(block["state"]) for block in blocks] == [CHUNK_STEPS, len(columns.state) - CHUNK_STEPS]
    np.testing.assert_array_equal(np.concatenate([block["state"] for block in blocks]), columns.state)


def test_memory_does_not_grow_with_the_log(tmp_path):
    def peak(trials):
        path = record(tmp_path / f"{trials}.mcap", "navigation", *random_steps(trials, 100))
        tracemalloc.start()
        total = sum(int(block["step"].max()) for block in iter_steps(path, ["step"]))
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert total
        return most

    peak(100)  # what is cached once
    assert peak(4000) < 1.2 * peak(1000)


def test_a_trial_of_a_long_log_takes_a_few_chunks(tmp_path, monkeypatch):
    monkeypatch.setattr(writer, "CHUNK_STEPS", 32)
    columns, rows = random_steps(trials=400, trial_steps=20)
    path = record(tmp_path / "a.mcap", "navigation", columns, rows)
    opened = []
    whole = log.chunk_content
    monkeypatch.setattr(log, "chunk_content", lambda *args: opened.append(args) or whole(*args))
    for trial in range(0, 400, 13):
        opened.clear()
        found = read_trial(path, trial)
        np.testing.assert_array_equal(found["state"], columns.state[columns.trial == trial])
        assert len(opened) <= 12  # of 263


def test_a_trial_that_is_longer_than_chunks_is_found(tmp_path, monkeypatch):
    monkeypatch.setattr(writer, "CHUNK_STEPS", 16)
    columns, rows = random_steps(trials=5, trial_steps=70)
    path = record(tmp_path / "a.mcap", "visit", columns, rows)
    for trial in range(5):
        np.testing.assert_array_equal(read_trial(path, trial)["state"], columns.state[columns.trial == trial])
    with pytest.raises(NotFoundError, match="holds 0 to 4$"):
        read_trial(path, 5)


@pytest.mark.parametrize("read", READERS)
def test_what_is_no_log_is_one_line(tmp_path, read):
    with pytest.raises(NotFoundError, match=r"a\.mcap: no such file$"):
        read(tmp_path / "a.mcap")
    text = tmp_path / "b.mcap"
    text.write_text("this is a text, not a log")
    with pytest.raises(RunError, match=r"b\.mcap: not an MCAP file$"):
        read(text)
    with pytest.raises(RunError, match=r"^[^\n]+: cannot read the log: [^\n]+$"):
        read(tmp_path)
