"""What processes that were killed left in a run: how it is told from what another is writing, and taken away."""

import contextlib
import shutil
from collections.abc import Iterator
from pathlib import Path

from visitlab_cli.errors import RunError
from visitlab_cli.storage.cell_folder import LOCK, hidden_name, lock_of, read_cell, temporaries
from visitlab_cli.storage.checkpoint_file import stated_cell
from visitlab_cli.storage.inside import check_inside, is_real
from visitlab_cli.storage.locks import SILENT, is_abandoned, older_than
from visitlab_cli.storage.on_disk import leftovers

YOUNG = 60.0
"""Seconds without a change after which nobody writes a file any more that has no lock."""


def is_left_over(path: Path) -> bool:
    """Whether something temporary is of somebody who is surely gone: a hidden folder, its lock file, or a file."""
    if not is_locked(path):
        return older_than(path, YOUNG)
    file = path if path.name.endswith(LOCK) else lock_of(path)
    if not file.is_symlink() and file.exists():
        return is_abandoned(file, begun=_has_begun(file))
    return older_than(path, SILENT)  # of a version that had no lock files, or half removed


def is_locked(path: Path) -> bool:
    """Whether it is something temporary that says who writes it: a cell's folder or its lock file, or a claim."""
    return path.name.endswith(LOCK) or is_real(path)


def _has_begun(file: Path) -> bool:
    """Whether the folder that a lock file is of is there; a claim has none."""
    return file.with_name(file.name.removesuffix(LOCK)).exists()


def abandoned(run: Path, path: str) -> Iterator[Path]:
    """The hidden folders in which somebody who is surely gone wrote a cell, and left checkpoints."""
    for folder in temporaries(run):
        mine = folder.is_dir() and folder.name.rpartition("-")[0] == hidden_name(path)
        if mine and stated_cell(folder) == path and is_left_over(folder):
            yield folder


def remove_leftovers(run: Path) -> None:
    """Remove what processes left that are surely gone; what is being written stays, or what a cell can go on from.

    Raises:
        RunError: the run can't be looked into.
    """
    for path in sorted(leftovers(run), key=lambda path: path.name.endswith(LOCK)):
        if path.name.endswith(LOCK):
            if not _has_begun(path):
                is_abandoned(path, begun=False, remove=True)
        elif not is_left_over(path):
            continue
        elif not is_locked(path):
            with contextlib.suppress(OSError):
                path.unlink()
        elif not _is_to_go_on(run, path):
            remove_hidden(path)


def remove_hidden(folder: Path) -> None:
    """Remove a hidden folder, then its lock file."""
    shutil.rmtree(folder, ignore_errors=True)
    with contextlib.suppress(OSError):
        lock_of(folder).unlink()


def _is_to_go_on(run: Path, folder: Path) -> bool:
    """Whether a hidden folder has checkpoints of a cell that is not done."""
    path = stated_cell(folder)
    if path is None or folder.name.rpartition("-")[0] != hidden_name(path):
        return False
    try:
        check_inside(run, run / path)
        return read_cell(run / path) is None
    except RunError:
        return True  # nobody can tell
