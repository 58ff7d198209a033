import numpy as np
import pytest
from mcap.reader import make_reader

from visitlab_cli.errors import NotFoundError, RunError
from visitlab_cli.recording.reader import read_metadata, read_steps, read_trial, trials
from visitlab_cli.recording.writer import CHUNK_STEPS
from visitlab_cli.world.columns import TASKS, columns_of

from .blocks import ATTRIBUTES, random_steps, record

TRIALS, TRIAL_STEPS = 100, 100


@pytest.fixture
def steps():
    return random_steps(TRIALS, TRIAL_STEPS)


@pytest.mark.parametrize("task", TASKS)
def test_read_steps_gives_what_was_written(tmp_path, steps, task):
    columns, rows = steps
    found = read_steps(record(tmp_path / "a.mcap", task, columns, rows))
    assert list(found) == [column.name for column in columns_of(task)]
    for name, values in found.items():
        written = getattr(columns, name)
        assert values.dtype == written.dtype
        np.testing.assert_array_equal(values, written)


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


def test_metadata_survives_a_cut_after_the_first_chunk(tmp_path, steps):
    path = record(tmp_path / "a.mcap", "social", *steps)
    expected = ATTRIBUTES | {"format": "1", "task": "social", "one_trial_in": "1"}
    assert read_metadata(path) == expected
    with path.open("rb") as file:
        first = make_reader(file).get_summary().chunk_indexes[0]
    path.write_bytes(path.read_bytes()[: first.chunk_start_offset + first.chunk_length])
    assert read_metadata(path) == expected
    with pytest.raises(RunError, match="not a whole MCAP file"):
        read_steps(path)


def test_a_changed_byte_in_a_chunk_is_an_error(tmp_path, steps):
    path = record(tmp_path / "a.mcap", "social", *steps)
    with path.open("rb") as file:
        first = make_reader(file).get_summary().chunk_indexes[0]
    data = bytearray(path.read_bytes())
    data[first.chunk_start_offset + first.chunk_length // 2] ^= 1
    path.write_bytes(data)
    with pytest.raises(RunError, match=r"^[^\n]+: not a whole MCAP file: [^\n]+$"):
        read_steps(path)


@pytest.mark.parametrize("read", [read_metadata, read_steps, trials, lambda path: read_trial(path, 0)])
def test_what_is_no_log_is_one_line(tmp_path, read):
    with pytest.raises(NotFoundError, match=r"a\.mcap: no such file$"):
        read(tmp_path / "a.mcap")
    text = tmp_path / "b.mcap"
    text.write_text("this is a text, not a log")
    with pytest.raises(RunError, match=r"^[^\n]+: not a whole MCAP file: [^\n]+$"):
        read(text)
    with pytest.raises(RunError, match=r"^[^\n]+: cannot read the log: [^\n]+$"):
        read(tmp_path)
