"""Which cells of a run are being done, where, and how far they and those that were left are: from its folder alone."""

import time
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.storage.cell_folder import LOCK, temporaries
from visitlab_cli.storage.checkpoint_file import NAMES, stated
from visitlab_cli.storage.claims import CLAIM, Owner, owner_of
from visitlab_cli.storage.leftovers import is_left_over
from visitlab_cli.storage.locks import told_in


class UnderWay(NamedTuple):
    """A cell that is being done, by its path.

    `owner` is the process that writes it or, while nothing is written yet, the runner that claimed it; `steps` are
    those that are done, as last told; `silent` are the seconds since its last sign of life, by this machine's clock.
    """

    cell: str
    owner: Owner
    steps: int
    silent: float


def under_way(run: Path) -> list[UnderWay]:
    """Those of a run, by their paths; what killed processes left is not among them."""
    found: dict[str, UnderWay] = {}
    files = [path for path in temporaries(run) if path.name.endswith(LOCK)]
    for file in sorted(files, key=lambda file: not file.name.startswith(CLAIM)):  # who writes tells more than a claim
        each = _told(file)
        if each is not None and not is_left_over(file):
            claim = found.get(each.cell)
            found[each.cell] = each if claim is None else each._replace(silent=min(each.silent, claim.silent))
    return sorted(found.values())


def checkpoints_stated(run: Path) -> list[dict[str, Any]]:
    """What the checkpoints of a run say that are not yet part of a finished cell."""
    folders = [path for path in temporaries(run) if path.is_dir()]
    return [told for folder in folders for name in NAMES if (told := stated(folder / name))]


def _told(file: Path) -> UnderWay | None:
    """What a lock file says; None where it says nothing of a cell."""
    told = told_in(file)
    try:
        silent = max(0.0, time.time() - file.lstat().st_mtime)
    except OSError:
        return None
    cell, steps = told.get("cell"), told.get("steps")
    return UnderWay(cell, owner_of(told), _count(steps), silent) if isinstance(cell, str) else None


def _count(steps: Any) -> int:
    return steps if type(steps) is int and steps > 0 else 0
