"""Which cells are being done, and by which runner, so that several runners of a run share its cells.

Whoever is about to do a cell claims it: by a file of that cell in the run's folder, which is locked, and touched every
so often, as long as the cell runs (`locks.py`). Claims are about sharing work, and nothing else depends on them: a cell
that is done twice has the same bytes, and the first to finish it wins.

A claim is dead where nobody locks it and its owner was a process of this machine that is no more, or where nothing
touched it for two minutes. Those are minutes of the observer's own clock, which never jumps, and only while it looks:
how far the clocks of two machines and of their disks are apart, or jump, does not matter.
"""

import hashlib
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.storage.cell_folder import LOCK, TEMPORARY
from visitlab_cli.storage.locks import Changes, HeldError, Lock, lock, owner_unless

CLAIM = f"{TEMPORARY}claim-"
BEAT_SECONDS = 20.0
"""How often a claim is touched."""
DEAD_SECONDS = 120.0
"""After how long without that a claim is dead; nodes of a network file system see a change up to a minute later."""
UNWATCHED_SECONDS = 5.0
"""What counts at most of the time between two looks: while the observer was stopped, others may have been, too."""
TRIES = 100
LONGEST_NAME = 100


class Owner(NamedTuple):
    """A runner, by its machine and process; 0 where its claim does not say."""

    host: str
    process: int


def claim_file(run: Path, path: str) -> Path:
    """The file that claims the cell `path`."""
    digest = hashlib.sha256(path.encode()).hexdigest()[:8]
    return run / f"{CLAIM}{path.replace('/', '-')[:LONGEST_NAME]}-{digest}{LOCK}"


def owner_of(told: dict[str, Any]) -> Owner:
    """Who has what a lock file is of, from what the file says."""
    process = told.get("process")
    return Owner(str(told.get("machine", "?")).split(" ")[0], process if type(process) is int else 0)


class Claims:
    """What one runner has claimed, and what it has seen of the claims of others."""

    def __init__(self, run: Path, clock: Callable[[], float] = time.monotonic) -> None:
        """Nothing yet, in the run's folder; `clock` tells seconds and never goes back."""
        self._run, self._clock = run, clock
        self._held: dict[str, Lock] = {}
        self._seen: dict[str, tuple[tuple[int, ...], float]] = {}
        self._beaten = self._looked = clock()
        self._watched = 0.0

    def take(self, path: str) -> Owner | None:
        """Claim the cell `path`: None where it is ours now, else who has it.

        Where no claim can be made, the cell is ours: that will say what is wrong.
        """
        self.beat()
        file = claim_file(self._run, path)
        for _ in range(TRIES):  # its owner may end while we look
            try:
                self._held[path] = lock(file, new=True, cell=path)
                break
            except HeldError:
                continue  # somebody just looks at it
            except FileExistsError:
                pass
            except OSError:
                break
            try:
                owner = owner_unless(partial(self._is_silent, path), file)
            except FileNotFoundError:
                continue
            except OSError:
                break
            if owner is not None:
                return owner_of(owner)
        self._seen.pop(path, None)
        return None

    def _is_silent(self, path: str, changes: Changes) -> bool:
        """Whether the claim of a cell has not changed for so long that it is dead."""
        now = self._clock()
        self._watched += min(now - self._looked, UNWATCHED_SECONDS)
        self._looked = now
        before, since = self._seen.setdefault(path, (changes, self._watched))
        if before != changes:
            self._seen[path] = changes, self._watched
            return False
        return self._watched - since >= DEAD_SECONDS

    def release(self, path: str) -> None:
        """Let a cell go: it is done, or failed."""
        if (held := self._held.pop(path, None)) is not None:
            held.release(remove=True)

    def beat(self) -> None:
        """Give a sign of life for each claim, if it is time."""
        now = self._clock()
        if now - self._beaten >= BEAT_SECONDS:
            self._beaten = now
            for held in self._held.values():
                held.beat()

    def close(self) -> None:
        """Let all go."""
        for path in list(self._held):
            self.release(path)
