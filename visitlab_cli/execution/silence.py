"""Which cell hangs: the one that has long done no block of steps, told once for each silence."""

from typing import NamedTuple

from visitlab_cli.execution.executor import WAITING
from visitlab_cli.plan.cells import Cell
from visitlab_cli.simulation.loop import BLOCK_ROWS

SECONDS_OF_SILENCE = 60.0
"""How long a cell may do no block of steps."""
SLOW_BLOCKS = 3
"""A silence of so many of its longest blocks is one, too, where these are slow: a sweep at every step takes time."""
SECONDS_ASIDE = 600.0
"""How long it may do what is no block: import and compile before the first, write its files after the last."""
SECONDS_UNWATCHED = 2.0
"""What counts at most of the time between two looks: a machine asleep or a program stopped (Ctrl-Z) is no silence."""


class _Heard(NamedTuple):
    steps: int | None
    at: float
    longest: float = 0.0
    told: bool = False


class Silence:
    """What was last heard of each cell that runs, in seconds that were watched."""

    def __init__(self) -> None:
        """Nothing was heard."""
        self._heard: dict[str, _Heard] = {}
        self._looked: float | None = None
        self._watched = 0.0

    def looks(self, clock: float) -> None:
        """It is `clock` seconds, of any clock that never goes back: to be said before each look at all cells."""
        if self._looked is not None:
            self._watched += min(clock - self._looked, SECONDS_UNWATCHED)
        self._looked = clock

    def begins(self, cell: Cell) -> None:
        """`cell` is given to a worker."""
        self._heard[cell.path] = _Heard(None, self._watched)

    def heard(self, cell: Cell, steps: int) -> str | None:
        """`cell` has done `steps` steps, a negative number while it has not begun: what to tell of it, if anything.

        One that waits for a worker is not silent.
        """
        last, now = self._heard[cell.path], self._watched
        if last.steps != steps or steps == WAITING:
            between_blocks = last.steps is not None and last.steps >= 0
            longest = max(last.longest, now - last.at) if between_blocks else last.longest
            self._heard[cell.path] = _Heard(steps, now, longest)
            return None
        playing = 0 <= steps < cell.steps
        limit = max(SECONDS_OF_SILENCE, SLOW_BLOCKS * last.longest) if playing else SECONDS_ASIDE
        if last.told or now - last.at < limit:
            return None
        self._heard[cell.path] = last._replace(told=True)
        seconds = f"for {now - last.at:.0f} seconds"
        if playing:
            done = f"{steps:,} of {cell.steps:,} steps are done"
            return f"no block of {BLOCK_ROWS:,} steps {seconds}, {done}; does it hang?"
        return f"{'its worker starts' if steps < 0 else 'writes its files'} {seconds}; does it hang?"
