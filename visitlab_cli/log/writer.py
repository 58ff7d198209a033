"""Recording: blocks of steps become the log of a cell, at less than half a microsecond a step, beside playing.

The file does not depend on the size of the blocks in which the steps arrive. First come the metadata and
the config, which a crash thus leaves, then chunks of `CHUNK_STEPS` steps, each followed in the chunk by the
trials whose last step it holds, then the summary. All that costs time is done in a thread, one block behind at most.
"""

import contextlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, BinaryIO, Self

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import RunError
from visitlab_cli.log.behind import Behind
from visitlab_cli.log.layout import STEP_CHANNEL, TRIAL_CHANNEL, VARINT_MAX, Records, layout_of
from visitlab_cli.log.mcap_file import McapFile, Position
from visitlab_cli.log.schema import (
    CONFIG_NAME,
    FORMAT,
    METADATA_NAME,
    ONE_TRIAL_IN,
    PACKAGE,
    STEP,
    STEP_NS,
    STEP_TOPIC,
    TRIAL,
    TRIAL_TOPIC,
    Parts,
    schema_bytes,
)
from visitlab_cli.world.columns import StepColumns

CONFIG_MEDIA_TYPE = "application/yaml"
CHUNK_STEPS = 8192


class StepRecorder:
    """Writes every step of one cell; a context manager.

    Leaving the `with` block closes the file; an exception leaves it unfinished, for the caller to delete.

    Args:
        path: the file, replaced if it exists.
        task: decides which columns are recorded.
        attributes: the cell's metadata; `format`, `task` and `one_trial_in` are added.
        config_yaml: the cell's config, attached.
        one_trial_in: record the trials 0, n, 2n, ... only; their steps are numbered on without gaps.
        parts: what the cell has beside what its task has, of `SOME_CELLS`.

    Raises:
        RunError: the file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        task: str,
        *,
        attributes: dict[str, str],
        config_yaml: bytes,
        one_trial_in: int = 1,
        parts: Parts = (),
    ):
        self._path = path
        self._one_trial_in = one_trial_in
        self._step_layout = layout_of(STEP, task, parts)
        self._trial_layout = layout_of(TRIAL, task, parts)
        layout = self._step_layout
        self._may_not_fit = [name for name in layout.varints if layout.dtype[name] != np.bool_]
        self._chunk = self._step_layout.blank(CHUNK_STEPS)
        self._behind = Behind()
        self._filled = 0
        self._steps_written = 0
        self._trials_written = 0
        self._open_reward = 0.0  # of the trial that goes on in the next chunk
        added = {"format": FORMAT, "task": task, ONE_TRIAL_IN: str(one_trial_in)}
        try:
            self._file = McapFile(path)
        except OSError as error:
            raise _cannot_write(path, error) from error
        with self._writing():
            self._file.write_metadata(METADATA_NAME, dict(sorted((attributes | added).items())))
            self._file.write_attachment(CONFIG_NAME, CONFIG_MEDIA_TYPE, config_yaml)
            self._file.write_channel(STEP_CHANNEL, STEP_TOPIC, f"{PACKAGE}.{STEP}", schema_bytes(parts))
            self._file.write_channel(TRIAL_CHANNEL, TRIAL_TOPIC, f"{PACKAGE}.{TRIAL}", schema_bytes(parts))
            self._file.flush()

    def write(self, columns: StepColumns, rows: int) -> None:
        """Append the first `rows` rows of a block, which may change afterwards.

        The rows of all blocks together are whole trials, each from its step 0 on, the last one maybe cut.

        Raises:
            RunError: a value of this block or the one before does not fit its field, or the file cannot be written.
        """
        if rows > len(columns.trial):
            raise ValueError(f"{rows} rows of a block of {len(columns.trial)}")
        block = {name: getattr(columns, name)[:rows] for name in self._step_layout.fields}
        if self._one_trial_in > 1:
            kept = np.flatnonzero(block["trial"] % self._one_trial_in == 0)
            block = {name: values[kept] for name, values in block.items()}
        if not self._behind.has_begun and self._filled + len(block["trial"]) <= CHUNK_STEPS:
            self._append(block)  # nothing is written yet, and a cell of one chunk starts no thread
            return
        if self._one_trial_in == 1:
            block = {name: values.copy() for name, values in block.items()}
        self._behind.hand(partial(self._append, block))

    def position(self) -> dict[str, npt.NDArray[Any]]:
        """Where it stands, as arrays: of what is in the file, which is then on the disk, and of what is not yet.

        Raises:
            RunError: the file cannot be written.
        """
        self._behind.wait()
        with self._writing():
            size, crc, chunks, counts = self._file.position()
        return {
            "numbers": np.array([size, crc, self._steps_written, self._trials_written], np.int64),
            "chunks": chunks,
            "counts": counts,
            "rows": self._chunk[: self._filled].view(np.uint8),
            "open": np.array([self._open_reward]),
        }

    def go_on(self, before: BinaryIO, position: dict[str, npt.NDArray[Any]]) -> None:
        """Go on from where another recorder of the same cell stood, whose file is `before`; this one wrote no step yet.

        Raises:
            ValueError: that file does not hold what it held; nothing is changed.
            RunError: this one's cannot be written.
        """
        size, crc, steps_written, trials_written = position["numbers"].tolist()
        with self._writing():
            self._file.go_on(before, Position(size, crc, position["chunks"], position["counts"]))
        rows = position["rows"].view(self._chunk.dtype)
        self._filled = len(rows)
        self._chunk[: self._filled] = rows
        self._steps_written, self._trials_written = steps_written, trials_written
        self._open_reward = float(position["open"][0])

    def close(self) -> None:
        """Write what is left and the summary; the file is on the disk, and the thread has ended, when this returns.

        Raises:
            RunError: the file cannot be written.
        """
        self._behind.end()
        self._behind.wait()
        if self._filled:
            self._write_chunk(trial_ended=True)
        with self._writing():
            self._file.finish()

    def described(self) -> dict[str, Any]:
        """Size in bytes and sha256 of the file, once it is closed."""
        return self._file.described()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if kind is None:
            self.close()
        else:
            self._behind.end()
            self._file.abandon()

    def _append(self, block: dict[str, np.ndarray]) -> None:
        """Encode a block, and write each chunk that more follows than it holds."""
        self._check_varints(block)
        done, total = 0, len(block["trial"])
        while done < total:
            if self._filled == CHUNK_STEPS:
                self._write_chunk(trial_ended=block["step"][done] == 0)
            count = min(total - done, CHUNK_STEPS - self._filled)
            into = self._chunk[self._filled : self._filled + count]
            for name, values in block.items():
                np.copyto(into[name], values[done : done + count], casting="safe")
            self._filled += count
            done += count

    def _check_varints(self, block: dict[str, np.ndarray]) -> None:
        for name in self._may_not_fit:
            if block[name].max(initial=0) > VARINT_MAX:
                row = int((block[name] > VARINT_MAX).argmax())
                raise RunError(
                    f"{self._path}: step {block['step'][row]} of trial {block['trial'][row]} has {name} "
                    f"{block[name][row]}, the log holds 0 to {VARINT_MAX}"
                )

    def _write_chunk(self, trial_ended: bool) -> None:
        """Write the filled rows as a chunk; `trial_ended`: the last of them is the last of its trial."""
        steps = self._chunk[: self._filled]
        numbers = np.arange(self._steps_written, self._steps_written + self._filled)
        steps["sequence"] = numbers
        steps["log_time"] = steps["publish_time"] = numbers * STEP_NS
        with self._writing():
            self._file.write_chunk([steps, self._trials_of(steps, trial_ended)])
        self._steps_written += self._filled
        self._filled = 0

    def _trials_of(self, steps: Records, trial_ended: bool) -> Records:
        """The `/trial` messages of the trials that end in `steps`; keeps the reward of one that goes on."""
        firsts = np.flatnonzero(steps["step"] == 0)
        if not len(firsts) or firsts[0]:
            firsts = np.append(0, firsts)
        rewards = np.add.reduceat(steps["reward"].astype(np.float64), firsts)
        rewards[0] += self._open_reward
        lasts = np.append(firsts[1:], len(steps)) - 1
        if trial_ended:
            self._open_reward = 0.0
        else:
            self._open_reward = float(rewards[-1])
            rewards, lasts = rewards[:-1], lasts[:-1]
        ended, last_steps = steps["log_time"][lasts], steps["step"][lasts]
        trials = self._trial_layout.blank(len(lasts))
        trials["sequence"] = np.arange(self._trials_written, self._trials_written + len(lasts))
        trials["log_time"] = trials["publish_time"] = ended
        trials["trial"] = steps["trial"][lasts]
        trials["first_step_time"] = ended - last_steps.astype(np.uint64) * STEP_NS
        trials["reward"] = rewards
        trials["steps"] = last_steps
        if "goals" in self._trial_layout.fields:
            trials["goals"] = rewards
        self._trials_written += len(lasts)
        return trials

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        """Give the file up at an error of the disk, and show it as one line."""
        try:
            yield
        except OSError as error:
            self._file.abandon()
            raise _cannot_write(self._path, error) from error


def _cannot_write(path: Path, error: OSError) -> RunError:
    return RunError(f"{path}: cannot write the log: {error.strerror}")
