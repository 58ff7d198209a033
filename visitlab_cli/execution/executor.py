"""What the runner asks of whatever cells run in: processes of this machine, or a cluster."""

import signal
from collections.abc import Callable
from concurrent.futures import Future
from pathlib import Path
from typing import Protocol

from visitlab_cli.errors import RunError
from visitlab_cli.plan.cells import Cell

DEATHS_GIVEN_UP = 3
"""How many workers may die of a cell before it is given up."""
DIED = f"its worker process died {DEATHS_GIVEN_UP} times"
OUT_OF_MEMORY = f"{DIED} (out of memory?)"
NOT_BEGUN = -1
"""The steps of a cell whose worker is still starting, importing or compiling."""
WAITING = -2
"""The steps of a cell that no worker has taken yet."""


def died_of(number: int) -> str:
    """What is told of a cell that its workers died of; `number` is the signal, 0 where nobody knows."""
    if number in (0, signal.SIGKILL):
        return OUT_OF_MEMORY
    return f"{DIED} ({signal.Signals(number).name}: {signal.strsignal(number)})"


class EndOfRunError(RunError):
    """A cell could not be run for a reason that holds for all: the command ends, and what was finished is kept."""


class Executor(Protocol):
    """Slots that cells run in; a slot's progress can be read at any time.

    A cell's future ends with `BrokenExecutor` where a process died with which all slots are lost.
    """

    @property
    def count(self) -> int:
        """How many slots there are now."""

    def submit(self, run: Path, cell: Cell, slot: int) -> Future[None]:
        """Run a cell in a free `slot`."""

    def steps_done(self, slot: int) -> int:
        """Steps that the cell in `slot` has done so far; `NOT_BEGUN` or `WAITING` before the first."""

    def went_on_from(self, slot: int) -> int:
        """The step from which the cell in `slot` was gone on with; 0 where it was begun."""

    def place(self, slot: int) -> str:
        """Which worker and process runs the cell in `slot`, in words."""

    def stop(self) -> None:
        """Ask every cell to stop after its block; may be said again and again."""

    def replace(self) -> int:
        """Give up what is broken; the next cell starts anew. The signal that it died of, 0 where nobody knows."""

    def kill(self) -> None:
        """End all that runs at once."""

    def close(self) -> None:
        """Wait for the end of what was started; may be said again."""


OpenPool = Callable[[int], Executor]
"""Makes an executor of at most so many workers."""
