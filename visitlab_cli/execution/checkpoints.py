"""A long cell's checkpoints: all that it takes to go on from between two blocks, to the same bytes.

One is written about once a minute, two by turns, in the cell's hidden folder. Who does the cell after its process was
killed takes the newest that is whole and of the same config, code and versions. What was recorded is copied to a new
hidden folder before the old one is removed: a process that was only thought dead can write nothing into it.
"""

import contextlib
import time
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import RunError
from visitlab_cli.execution.build import Simulation
from visitlab_cli.execution.versions import decided_by
from visitlab_cli.log.writer import StepRecorder
from visitlab_cli.plan.cells import Cell
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.simulation.loop import START, Cursor
from visitlab_cli.simulation.memory import ElsewhereError, Memory
from visitlab_cli.storage.cell_folder import STEPS, NewCell, sync
from visitlab_cli.storage.checkpoint_file import NAMES, UNFINISHED, Checkpoint, decoded, encoded, stated, write
from visitlab_cli.storage.key import own_key
from visitlab_cli.storage.leftovers import abandoned, remove_hidden
from visitlab_cli.storage.reading import UnreadableError, open_file, read_bytes
from visitlab_cli.world.scene import Scene

EVERY = 60.0
"""Seconds between two."""
SHARE = 0.01
"""Of a cell's time, at most, for which they are written more seldom where a disk is slow."""
PART, LOG = "part_", "log_"
"""How the names of the arrays begin that are the memory's and the log's."""


class Standing(NamedTuple):
    """Where a cell's simulation stands between two blocks: in which stretch (-1: before the first), with what rewards.

    `trial_rewards` has shape (trials,); `seconds` of the clock and `cpu_seconds` of one core were spent playing.
    """

    trial_rewards: npt.NDArray[np.float64]
    cursor: Cursor = START
    stretch: int = -1
    seconds: float = 0.0
    cpu_seconds: float = 0.0


class Checkpoints:
    """Those of a cell that is being written: of its simulation, random stream and log, as these are at the time.

    `began` is when it was begun, perhaps by another process.
    """

    def __init__(
        self,
        cell: Cell,
        new: NewCell,
        simulation: Simulation,
        random: RandomState,
        log: StepRecorder | None,
        begun: float,
    ) -> None:
        """None yet; it was `begun` here at this time of the monotonic clock."""
        self._cell, self._new, self._random, self._log = cell, new, random, log
        self.began = datetime.now(UTC) - timedelta(seconds=time.monotonic() - begun)
        self._begun = begun
        self._due = time.monotonic() + EVERY
        self._written = 0
        self._latest: Standing | None = None
        self._memory: Memory | None = None
        with contextlib.suppress(ElsewhereError):
            self._memory = Memory(record for each in simulation.stretches for record in (each.task, each.agent))

    @property
    def seconds(self) -> float:
        """What was spent on the cell so far, by all who did."""
        return time.monotonic() - self._begun

    def go_on(self, run: Path, beginning: Standing) -> Standing:
        """Go on from the newest checkpoint that can be, if there is one: where the cell then stands.

        Raises:
            RunError: the log can't be written.
        """
        if self._memory is None:
            return beginning
        for folder, content, (facts, arrays) in _found(run, self._cell):
            memory = [arrays[f"{PART}{number}"] for number in range(facts["parts"])]
            rewards = arrays["trial_rewards"]
            if not self._memory.fits(memory) or not self._copy_log(folder, arrays):
                continue
            self._memory.restore(memory)
            self._random[:] = arrays["random"]
            beginning.trial_rewards[: len(rewards)] = rewards
            self.began = datetime.fromisoformat(facts["began"])
            self._begun -= facts["spent"]
            with contextlib.suppress(OSError):
                self._keep(content)
                remove_hidden(folder)
            cursor = _cursor(facts["cursor"])
            return Standing(beginning.trial_rewards, cursor, facts["stretch"], facts["seconds"], facts["cpu_seconds"])
        return beginning

    def after_block(self, standing: Standing) -> None:
        """Write one, if it is time; what can't be written is not, and the cell goes on.

        Raises:
            RunError: the log can't be written.
        """
        self._latest = standing
        begun = time.monotonic()
        if self._memory is None or begun < self._due:
            return
        self._write(self._memory, standing)
        self._latest = None
        ended = time.monotonic()
        self._due = ended + max(EVERY, (ended - begun) / SHARE)

    def interrupted(self) -> None:
        """Write a last one, of a cell that is long enough to have some, and has played on since."""
        if self._memory is not None and self._latest is not None and self._written:
            with contextlib.suppress(RunError):
                self._write(self._memory, self._latest)

    def _write(self, memory: Memory, standing: Standing) -> None:
        key = own_key(make=True)
        if key is None:
            return
        log = {} if self._log is None else self._log.position()
        parts, cursor = memory.saved(), standing.cursor
        arrays = {
            "random": self._random,
            "trial_rewards": standing.trial_rewards[: cursor.trial + 1],
            **{f"{LOG}{name}": array for name, array in log.items()},
            **{f"{PART}{number}": array for number, array in enumerate(parts)},
        }
        facts = {
            **decided_by(self._cell),
            "steps": cursor.steps,
            "cursor": _plain(cursor._asdict()),
            "stretch": standing.stretch,
            "seconds": standing.seconds,
            "cpu_seconds": standing.cpu_seconds,
            "began": self.began.isoformat(),
            "spent": self.seconds,
            "parts": len(parts),
        }
        with contextlib.suppress(OSError, ValueError):
            self._keep(encoded(Checkpoint(facts, arrays), key))

    def _keep(self, content: bytes) -> None:
        folder = self._new.folder
        try:
            write(folder, NAMES[self._written % len(NAMES)], content)
            sync(folder)
            sync(folder.parent)
        finally:
            (folder / UNFINISHED).unlink(missing_ok=True)
        self._written += 1

    def _copy_log(self, folder: Path, arrays: dict[str, npt.NDArray[Any]]) -> bool:
        """Whether what was recorded is there and whole, and copied."""
        if self._log is None:
            return True
        position = {name.removeprefix(LOG): array for name, array in arrays.items() if name.startswith(LOG)}
        try:
            with open_file(folder / STEPS) as before:
                self._log.go_on(before, position)
        except (OSError, ValueError):
            return False
        return True


def _found(run: Path, cell: Cell) -> Iterator[tuple[Path, bytes, Checkpoint]]:
    """The checkpoints of abandoned folders that are whole and of the cell as it is here, the newest first."""
    ours, found = decided_by(cell), []  # which must be the same
    for folder in abandoned(run, cell.path):
        for name in NAMES:
            said = stated(folder / name)
            if ours.items() <= said.items() and isinstance(said.get("steps"), int):
                found.append((said["steps"], folder / name))
    key = own_key() if found else None
    for _, file in sorted(found, reverse=True):
        with contextlib.suppress(OSError, ValueError, UnreadableError):
            content = read_bytes(file)
            if key is not None and ours.items() <= (checkpoint := decoded(content, key)).facts.items():
                yield file.parent, content, checkpoint


def _plain(value: Any) -> Any:
    """What is whole numbers, truths and fractions, of whatever library, as JSON has it."""
    if isinstance(value, Scene):
        return _plain(value._asdict())
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    return value.item() if isinstance(value, np.generic) else value


def _cursor(told: dict[str, Any]) -> Cursor:
    """The cursor again, each number of the kind that it is at the start, for which the loop is compiled."""
    scene = {name: type(at_first)(told["scene"][name]) for name, at_first in START.scene._asdict().items()}
    return Cursor(**{**told, "scene": START.scene._replace(**scene)})
