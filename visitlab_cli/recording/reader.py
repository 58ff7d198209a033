"""Reading a log back as columns: whole chunks as arrays, the chunk's CRC and the constant bytes checked."""

import contextlib
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.reader import make_reader
from mcap.records import Chunk, ChunkIndex, Metadata
from mcap.stream_reader import StreamReader, get_chunk_data_stream

from visitlab_cli.errors import NotFoundError, RunError
from visitlab_cli.recording.layout import Layout, Records, layout_of
from visitlab_cli.recording.schema import METADATA_NAME, ONE_TRIAL_IN, STEP, STEP_NS, TRIAL

Columns = dict[str, npt.NDArray[np.generic]]

_RECORD_PREFIX = 9  # opcode and length


def read_metadata(path: Path) -> dict[str, str]:
    """The cell's attributes, also of a log without an end.

    Raises:
        NotFoundError: there is no such file.
        RunError: it is not a log of visitlab, or damaged.
    """
    with _opened(path) as file:
        return _metadata(file)


def read_steps(path: Path) -> Columns:
    """All recorded steps: for each column of the task an array of shape (steps,).

    Raises:
        NotFoundError: there is no such file.
        RunError: it is not a log of visitlab, or damaged.
    """
    with _opened(path) as file:
        layout, _ = layouts = _layouts(file)
        return _gather(layout, (steps for steps, _ in _blocks(file, layouts, _chunk_indexes(file))))


def trials(path: Path) -> Columns:
    """The `/trial` messages: for each of their fields an array of shape (trials,), `goals` in a visit only.

    Raises:
        NotFoundError: there is no such file.
        RunError: it is not a log of visitlab, or damaged.
    """
    with _opened(path) as file:
        _, layout = layouts = _layouts(file)
        return _gather(layout, (trials for _, trials in _blocks(file, layouts, _chunk_indexes(file))))


def read_trial(path: Path, trial: int) -> Columns:
    """The steps of one trial, from its step 0 on: for each column an array of shape (steps + 1,).

    Raises:
        NotFoundError: there is no such file, or the trial is not recorded.
        RunError: it is not a log of visitlab, or damaged.
    """
    table = trials(path)
    found = np.flatnonzero(table["trial"] == trial)
    if not len(found):
        raise NotFoundError(f"{path}: trial {trial} is not recorded; {_recorded(path, table)}")
    start = int(table["first_step_time"][found[0]])
    end = start + int(table["steps"][found[0]]) * STEP_NS
    with _opened(path) as file:
        layout, _ = layouts = _layouts(file)
        indexes = [
            index
            for index in _chunk_indexes(file)
            if index.message_start_time <= end and index.message_end_time >= start
        ]
        blocks = (steps for steps, _ in _blocks(file, layouts, indexes))
        return _gather(layout, (steps[(start <= steps["log_time"]) & (steps["log_time"] <= end)] for steps in blocks))


def _recorded(path: Path, table: Columns) -> str:
    """Which trials the log holds, in words."""
    numbers = table["trial"]
    if not len(numbers):
        return "the log holds none"
    thinned = read_metadata(path)[ONE_TRIAL_IN]
    return f"the log holds {numbers[0]} to {numbers[-1]}" + (f", one in {thinned}" if thinned != "1" else "")


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[BinaryIO]:
    """The file, with whatever is wrong with it shown as one line."""
    try:
        with path.open("rb") as file:
            yield file
    except FileNotFoundError as error:
        raise NotFoundError(f"{path}: no such file") from error
    except OSError as error:
        raise RunError(f"{path}: cannot read the log: {error.strerror}") from error
    except (McapError, ValueError, struct.error, zstandard.ZstdError) as error:
        raise RunError(f"{path}: not a whole MCAP file: {error or type(error).__name__}") from error


def _metadata(file: BinaryIO) -> dict[str, str]:
    file.seek(0)
    for record in StreamReader(file, emit_chunks=True).records:
        if isinstance(record, Metadata) and record.name == METADATA_NAME:
            return record.metadata
    raise RunError(f"{file.name}: not a log of visitlab")


def _layouts(file: BinaryIO) -> tuple[Layout, Layout]:
    """The layouts of the steps and the trials of the log's task."""
    task = _metadata(file)["task"]
    return layout_of(STEP, task), layout_of(TRIAL, task)


def _chunk_indexes(file: BinaryIO) -> list[ChunkIndex]:
    file.seek(0)
    summary = make_reader(file).get_summary()
    return summary.chunk_indexes if summary else []


def _blocks(
    file: BinaryIO, layouts: tuple[Layout, Layout], indexes: list[ChunkIndex]
) -> Iterator[tuple[Records, Records]]:
    """The steps and the trials of each chunk."""
    step_layout, trial_layout = layouts
    for index in indexes:
        file.seek(index.chunk_start_offset + _RECORD_PREFIX)
        stream, size = get_chunk_data_stream(Chunk.read(ReadDataStream(file)), validate_crc=True)
        content = stream.read(size)
        steps = np.frombuffer(content, step_layout.dtype, count=size // step_layout.dtype.itemsize)
        steps = steps[: _leading(step_layout.matches(steps))]
        rest = content[steps.nbytes :]
        trials = np.frombuffer(rest, trial_layout.dtype, count=len(rest) // trial_layout.dtype.itemsize)
        if steps.nbytes + trials.nbytes != size or not trial_layout.matches(trials).all():
            raise RunError(f"{file.name}: holds messages that this version of visitlab does not write")
        yield steps, trials


def _leading(flags: npt.NDArray[np.bool_]) -> int:
    """How many of the `flags` are set before the first that is not."""
    return len(flags) if flags.all() else int(flags.argmin())


def _gather(layout: Layout, blocks: Iterable[Records]) -> Columns:
    """The fields of all `blocks` as arrays of their own, so that no block outlives its turn."""
    parts: dict[str, list[npt.NDArray[np.generic]]] = {
        name: [np.empty(0, layout.dtype[name])] for name in layout.fields
    }
    for block in blocks:
        for name, arrays in parts.items():
            arrays.append(block[name].copy())
    return {name: np.concatenate(arrays) for name, arrays in parts.items()}
