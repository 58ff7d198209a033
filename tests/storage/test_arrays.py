"""Models and tables of trials: what is written is read, and what is damaged is said to be."""

import zipfile

import numpy as np
import pytest

from visitlab_cli.agents.declared import RESERVED, fault_in_saved
from visitlab_cli.config import hidden
from visitlab_cli.errors import NotFoundError, RunError
from visitlab_cli.storage.arrays import read_model, read_trials, write_model, write_trials

ARRAYS = {"q": np.arange(6.0).reshape(2, 3), "visits": np.arange(6, dtype=np.int32)}


def test_what_is_written_is_read(tmp_path):
    write_model(tmp_path / "model.npz", ARRAYS)
    read = read_model(tmp_path / "model.npz")
    assert read.keys() == ARRAYS.keys()
    assert all((read[name] == ARRAYS[name]).all() and read[name].dtype == ARRAYS[name].dtype for name in ARRAYS)
    write_trials(tmp_path / "trials.parquet", np.array([0.5, 2.0]), with_goals=True)
    trials = read_trials(tmp_path / "trials.parquet")
    assert {name: values.tolist() for name, values in trials.items()} == {
        "trial": [0, 1],
        "reward": [0.5, 2.0],
        "goals": [0, 2],
    }


def test_arrays_are_read_however_they_lie_in_memory(tmp_path):
    write_model(tmp_path / "model.npz", {"q": ARRAYS["q"].T, "every": ARRAYS["q"][:, ::2], "one": np.float64(2)})
    read = read_model(tmp_path / "model.npz")
    assert [read[name].tolist() for name in read] == [[[0, 3], [1, 4], [2, 5]], [[0, 2], [3, 5]], 2.0]


@pytest.mark.parametrize("name", ["q", "_a1", "qé", "a" * 61, "a" * 62, "", "1a", "a/b", "../a", "a.b", "a b", "a\n"])
def test_what_may_be_saved_is_what_is_read(tmp_path, name):
    arrays = {name: np.zeros(2)}
    write_model(tmp_path / "model.npz", arrays)
    if fault_in_saved(arrays):
        with pytest.raises(RunError, match="not a model"):
            read_model(tmp_path / "model.npz")
    else:
        assert read_model(tmp_path / "model.npz").keys() == {name}


@pytest.mark.parametrize("dtype", ["f8", "f4", "f2", ">f8", "c16", "i8", "u1", "?", "U3", "O", "M8[s]"])
def test_what_dtype_may_be_saved_is_what_is_read(tmp_path, dtype):
    arrays = {"q": np.zeros(2, dtype)}
    write_model(tmp_path / "model.npz", arrays)
    if fault_in_saved(arrays):
        with pytest.raises(RunError, match="is no array of numbers"):
            read_model(tmp_path / "model.npz")
    else:
        assert read_model(tmp_path / "model.npz")["q"].dtype == dtype


def test_what_a_cell_keeps_itself_is_reserved_and_fits_beside_the_agents():
    assert {"random_state", *hidden.ARRAYS} <= set(RESERVED)
    assert fault_in_saved({f"a{number}": np.zeros(1) for number in range(56)}) is None
    assert "57 arrays; at most 56" in fault_in_saved({f"a{number}": np.zeros(1) for number in range(57)})


def test_equal_content_is_equal_bytes(tmp_path):
    for name in ("one", "two"):
        write_model(tmp_path / f"{name}.npz", ARRAYS)
        write_trials(tmp_path / f"{name}.parquet", np.zeros(100), with_goals=False)
    for ending in ("npz", "parquet"):
        assert (tmp_path / f"one.{ending}").read_bytes() == (tmp_path / f"two.{ending}").read_bytes()


def test_a_model_is_never_executed(tmp_path):
    np.savez(tmp_path / "evil.npz", q=np.array([{"a": 1}], dtype=object))
    with pytest.raises(RunError, match="damaged"):
        read_model(tmp_path / "evil.npz")


def test_strange_archives_are_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "strange.npz", "w") as archive:
        archive.writestr("readme.txt", "hello")
    with pytest.raises(RunError, match="not a model: readme.txt"):
        read_model(tmp_path / "strange.npz")


@pytest.mark.parametrize("reader", [read_model, read_trials])
def test_missing_and_damaged_files_are_one_line(tmp_path, reader):
    with pytest.raises(NotFoundError, match="no such"):
        reader(tmp_path / "nothing")
    (tmp_path / "garbage").write_bytes(b"garbage" * 100)
    with pytest.raises(RunError, match="damaged") as caught:
        reader(tmp_path / "garbage")
    assert "\n" not in str(caught.value)
