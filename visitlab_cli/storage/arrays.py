"""A model's arrays and the table of trials as files, written the same for the same content, read with care."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.declared import Declared
from visitlab_cli.errors import NotFoundError, RunError, reason
from visitlab_cli.storage.npz import Arrays, NotAModelError, read_npz
from visitlab_cli.storage.parquet import decode
from visitlab_cli.storage.reading import is_file, read_bytes
from visitlab_cli.wording import printable

__all__ = ["Arrays", "damaged", "read_model", "read_trials", "write_model", "write_trials"]

MOST_TRIALS = 256 << 20
"""Bytes of a table of trials."""
LARGEST_REWARD = 1e12
COLUMNS = {"trial": "<i4", "reward": "<f8", "goals": "<i4", "phase": "<i4"}
"""Those of `trials.parquet`; only a visit has `goals`, and `phase` is only where there are phases."""


def damaged(file: Path, why: str) -> RunError:
    """That a file of a run is damaged, and what to do."""
    return RunError(f"{printable(str(file))}: damaged: {why}{_mended(file)}")


def _mended(file: Path) -> str:
    """How a damaged file of a run is mended; nothing for one that lies in none."""
    runs = [folder for folder in file.parents if is_file(folder / "config.yaml")]
    if not runs:
        return ""
    return f"; visitlab runs verify {printable(str(runs[0]))} sets it aside, and running again mends it"


def write_model(file: Path, arrays: Arrays) -> None:
    """Write arrays by name to an `.npz`; a zip member carries no time, so equal arrays give equal bytes."""
    in_rows: Arrays = {name: np.asarray(array, order="C") for name, array in arrays.items()}  # as they are read
    np.savez_compressed(file, **in_rows)  # type: ignore[arg-type]  # (its stub takes any name for an option)


def read_model(file: Path, declared: Mapping[str, Declared] | None = None) -> Arrays:
    """Read the arrays of an `.npz`; nothing in it is ever executed.

    Args:
        file: the model.
        declared: what each array must be, and which are read; where it is not known, all, whatever their shapes.

    Raises:
        NotFoundError: there is no such file.
        RunError: the file is damaged, or not as declared.
    """
    try:
        arrays = read_npz(file, declared)
    except FileNotFoundError:
        raise NotFoundError(f"{printable(str(file))}: no such model") from None
    except NotAModelError as error:
        raise RunError(f"{printable(str(file))}: {error}") from error
    except (OSError, ValueError) as error:
        raise damaged(file, reason(error)) from error
    if "random_state" in arrays and not arrays["random_state"].any():
        raise damaged(file, "random_state is zero, from which no number follows")
    return arrays


def write_trials(
    file: Path, trial_rewards: npt.NDArray[np.float64], with_goals: bool, phase_trials: Sequence[int] = ()
) -> None:
    """Write `trials.parquet`: a row a trial, `trial`, `reward`, in a visit `goals`, `phase` if phases have trials."""
    import pyarrow
    from pyarrow import parquet

    columns: Arrays = {
        "trial": np.arange(len(trial_rewards), dtype=np.int32),
        "reward": trial_rewards,
    }
    if with_goals:
        columns["goals"] = trial_rewards.astype(np.int32)
    if phase_trials:
        columns["phase"] = _numbered(phase_trials)
    # from buffers: given a numpy array, pyarrow would import pandas where it is installed, at 45 MB a worker
    arrays = [
        pyarrow.Array.from_buffers(
            pyarrow.from_numpy_dtype(column.dtype), len(column), [None, pyarrow.py_buffer(column)]
        )
        for column in columns.values()
    ]
    parquet.write_table(pyarrow.table(arrays, names=list(columns)), file, compression="snappy", data_page_version="1.0")


def _numbered(phase_trials: Sequence[int]) -> npt.NDArray[np.int32]:
    return np.repeat(np.arange(len(phase_trials), dtype=np.int32), phase_trials)


def read_trials(
    file: Path,
    trials: int | None = None,
    with_goals: bool | None = None,
    phase_trials: Sequence[int] | None = None,
) -> Arrays:
    """The columns of `trials.parquet`, each of shape (trials,).

    Args:
        file: the table.
        trials: how many there must be, where that is known.
        with_goals: whether it has a column `goals`, where that is known.
        phase_trials: the trials of each phase, where these are known; empty for no column `phase`.

    Raises:
        NotFoundError: there is no such file.
        RunError: the file is damaged, or not as it should be.
    """
    try:
        content = read_bytes(file, MOST_TRIALS)
        optional = {name for name, needed in (("goals", with_goals), ("phase", phase_trials)) if not needed}
        found = decode(content, COLUMNS, optional=optional, rows=trials)
        if with_goals is False and "goals" in found:
            raise ValueError("has goals, which its task has not")
        if (
            phase_trials is not None
            and "phase" in found
            and not np.array_equal(found["phase"], _numbered(phase_trials))
        ):
            raise ValueError("its phases are not those of its config")
        _check_trials(found)
    except FileNotFoundError:
        raise NotFoundError(f"{printable(str(file))}: no such table of trials") from None
    except (OSError, ValueError) as error:
        raise damaged(file, f"no table of trials: {reason(error)}") from error
    return found


def _check_trials(found: Arrays) -> None:
    rewards = found["reward"]
    if (found["trial"] != np.arange(len(rewards))).any():
        raise ValueError("its trials are not numbered from 0 on")
    if not (np.abs(rewards) <= LARGEST_REWARD).all():
        raise ValueError("has a reward that is no number, or too large")
    if "goals" in found and (found["goals"] != np.trunc(rewards)).any():
        raise ValueError("its goals are not its rewards")
    if "phase" in found and (found["phase"][0] != 0 or not np.isin(np.diff(found["phase"]), (0, 1)).all()):
        raise ValueError("its phases are not numbered from 0 on")
