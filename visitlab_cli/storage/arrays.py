"""A model's arrays and the table of trials as files, written the same for the same content, read with care."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import NotFoundError, RunError

Arrays = dict[str, npt.NDArray[Any]]
LARGEST_ARRAY = 4 * 2**30  # bytes that a model's file may claim for one array


def _mended(file: Path) -> str:
    """How a damaged file of a run is mended; nothing for one that lies in none."""
    runs = [folder for folder in file.parents if (folder / "config.yaml").is_file()]
    return f"; visitlab runs verify {runs[0]} sets it aside, and running again mends it" if runs else ""


def write_model(file: Path, arrays: Arrays) -> None:
    """Write arrays by name to an `.npz`; a zip member carries no time, so equal arrays give equal bytes."""
    np.savez_compressed(file, **arrays)  # type: ignore[arg-type]  # (its stub takes any name for an option)


def read_model(file: Path) -> Arrays:
    """Read the arrays of an `.npz`; nothing in it is ever executed.

    Raises:
        NotFoundError: there is no such file.
        RunError: the file is damaged or claims more than a model can hold.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            names = [member.filename for member in members]
            if len(set(names)) != len(names) or any(not name.endswith(".npy") for name in names):
                raise RunError(f"{file}: not a model: {', '.join(names)}")
            if any(member.file_size > LARGEST_ARRAY for member in members):
                raise RunError(f"{file}: claims an array of over {LARGEST_ARRAY} bytes")
        with np.load(file, allow_pickle=False) as loaded:
            return {name: loaded[name] for name in loaded.files}
    except FileNotFoundError:
        raise NotFoundError(f"{file}: no such model") from None
    except (OSError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise RunError(f"{file}: damaged: {error}{_mended(file)}") from error


def write_trials(file: Path, trial_rewards: npt.NDArray[np.float64], with_goals: bool) -> None:
    """Write `trials.parquet`: one row a trial, `trial`, `reward` and in a visit `goals`."""
    import pyarrow
    from pyarrow import parquet

    columns: Arrays = {
        "trial": np.arange(len(trial_rewards), dtype=np.int32),
        "reward": trial_rewards,
    }
    if with_goals:
        columns["goals"] = trial_rewards.astype(np.int32)
    # from buffers: given a numpy array, pyarrow would import pandas where it is installed, at 45 MB a worker
    arrays = [
        pyarrow.Array.from_buffers(
            pyarrow.from_numpy_dtype(column.dtype), len(column), [None, pyarrow.py_buffer(column)]
        )
        for column in columns.values()
    ]
    parquet.write_table(pyarrow.table(arrays, names=list(columns)), file)


def read_trials(file: Path) -> Arrays:
    """The columns of `trials.parquet`, each of shape (trials,).

    Raises:
        NotFoundError: there is no such file.
        RunError: the file is damaged.
    """
    import pyarrow
    from pyarrow import parquet

    try:
        table = parquet.read_table(file)
    except FileNotFoundError:
        raise NotFoundError(f"{file}: no such table of trials") from None
    except (OSError, pyarrow.ArrowException) as error:
        raise RunError(f"{file}: damaged: no table of trials{_mended(file)}") from error
    return {name: table.column(name).to_numpy() for name in table.column_names}
