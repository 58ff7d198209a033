"""A cell's folder: it appears whole or not at all, and `cell.json`, written last, says that it is done.

Files are written in a hidden folder beside the cells, flushed to the disk, and the folder is renamed to its place.
In the place of a damaged cell its files are renamed one by one instead, `cell.json` last, for the user may keep
files there. While it is written a file beside the hidden folder is locked (`locks.py`), so that what a killed process
left can be told from what another one is still writing.

A long cell keeps checkpoints in its hidden folder (`checkpoint_file.py`): one that was abandoned with some stays until
its cell is done, for whoever does that next to go on from.
"""

import hashlib
import json
import os
import re
import shutil
import stat
import uuid
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from visitlab_cli.errors import Interrupted, RunError
from visitlab_cli.storage.checkpoint_file import NAMES, UNFINISHED
from visitlab_cli.storage.facts import (
    CELL,
    CELL_FORMAT,
    FACTS,
    MODEL,
    SOURCES,
    STEPS,
    TIMING,
    TRIALS,
    malformed,
)
from visitlab_cli.storage.inside import check_inside
from visitlab_cli.storage.locks import Heart, HeldError, lock
from visitlab_cli.storage.reading import check_damage, open_file, read_json, size_of

__all__ = [
    "CELL",
    "CELL_FORMAT",
    "FACTS",
    "MODEL",
    "SOURCES",
    "STEPS",
    "TIMING",
    "TRIALS",
    "NewCell",
    "describe",
    "hidden_folder_of",
    "hidden_name",
    "lock_of",
    "one_line",
    "read_cell",
    "reason",
    "sync",
    "to_json",
    "write_durably",
]

TEMPORARY, LOCK = ".tmp-", ".lock"
DAMAGED = ".damaged"
"""How the name of a file ends that was set aside."""
OF_CELLS = frozenset(name + ending for name in (STEPS, TRIALS, MODEL, CELL, TIMING) for ending in ("", DAMAGED))
"""The files of a cell."""
OF_HIDDEN = OF_CELLS | {*NAMES, UNFINISHED}
"""The files of a cell that is being written."""


_FOLDER = re.compile(rf"{re.escape(TEMPORARY)}.+-[0-9a-f]{{8}}")
_FILE = re.compile(
    rf"{_FOLDER.pattern}{re.escape(LOCK)}|{re.escape(TEMPORARY)}([0-9a-f]{{8}}-.+|(clock|probe)-[0-9a-f]{{8}})"
)


def is_temporary(path: Path) -> bool:
    """Whether a path is one that visitlab writes to before it is whole; whatever else is called so is the user's.

    Such a folder has files of a cell that is being written, and nothing else; a link is none, whatever it is called.

    Raises:
        UnreadableError: it can't be looked into.
    """
    try:
        mode = path.lstat().st_mode
        if stat.S_ISREG(mode):
            return _FILE.fullmatch(path.name) is not None
        if not stat.S_ISDIR(mode) or not _FOLDER.fullmatch(path.name):
            return False
        with os.scandir(path) as entries:
            return all(entry.name in OF_HIDDEN and entry.is_file(follow_symlinks=False) for entry in entries)
    except OSError as error:
        check_damage(path, error)
        return False  # it is gone


def hidden_folder_of(file: Path) -> Path | None:
    """The folder, called as one in which a cell is written, that a file lies in, whatever else is there; else None."""
    return next((folder for folder in file.absolute().parents if _FOLDER.fullmatch(folder.name)), None)


def one_line(error: OSError) -> str:
    """What went wrong, as the system puts it, without a number."""
    return error.strerror or str(error)


def reason(error: OSError | ValueError) -> str:
    """Why a file can't be reached: the system's word, or that a name can't be one."""
    return one_line(error) if isinstance(error, OSError) else str(error)


def to_json(document: Any) -> str:
    """A document as text, the same for equal documents."""
    return json.dumps(document, indent=2, sort_keys=True, allow_nan=False) + "\n"


def describe(file: Path) -> dict[str, Any]:
    """Size in bytes and sha256 of a file."""
    with open_file(file) as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
        return {"size": os.fstat(stream.fileno()).st_size, "sha256": digest}


def write_durably(file: Path, text: str) -> None:
    """Write a file and wait until it is on the disk."""
    with file.open("w", encoding="utf-8") as stream:
        stream.write(text)
        stream.flush()
        os.fsync(stream.fileno())


def sync(path: Path) -> None:
    """Wait until a file, or a folder's entries, are on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


class NewCell:
    """A cell being written: a context manager whose `folder` vanishes unless `commit` was called.

    Raises:
        RunError: the disk is full or the folder can't be written.
    """

    def __init__(self, run: Path, path: str) -> None:
        """Begin the cell `path` (relative to the folder `run`)."""
        self.place = run / path
        self.folder = run / f"{hidden_name(path)}-{uuid.uuid4().hex[:8]}"
        self._run, self._path = run, path

    def __enter__(self) -> Self:
        """Lock the file beside the hidden folder, then make that."""
        check_inside(self._run, self.place)
        try:
            self._run.mkdir(parents=True, exist_ok=True)
            held = lock(lock_of(self.folder), cell=self._path, steps=0)
            try:
                self.folder.mkdir()
            except OSError:
                held.release(remove=True)
                raise
        except (OSError, HeldError) as error:
            why = reason(error) if isinstance(error, OSError) else "another holds its lock"
            raise RunError(f"{self.folder.parent}: can't be written: {why}") from error
        self._held, self._heart = held, Heart(held)
        return self

    def beat(self, steps: int) -> None:
        """Give a sign of life, as whoever writes for long must, and say how many steps are done."""
        self._heart.beat(cell=self._path, steps=steps)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove what was not committed and can't be gone on with; a full disk becomes one clear line."""
        ended = isinstance(error, Interrupted | OSError) or (error and isinstance(error.__cause__, OSError))
        if ended and any((self.folder / name).exists() for name in NAMES):
            self._held.leave()
        else:
            shutil.rmtree(self.folder, ignore_errors=True)
            self._held.release(remove=True)
        if isinstance(error, OSError):
            raise RunError(f"{self.place}: can't be written: {one_line(error)}") from error

    def commit(
        self, facts: dict[str, Any], timing: dict[str, Any], described: Mapping[str, dict[str, Any]] | None = None
    ) -> None:
        """Write `timing.json` and, last, `cell.json` with `facts` and the files' hashes; then rename.

        What whoever wrote a file has `described`, as `describe` would, is not read again.
        """
        known = described or {}
        names = sorted(file.name for file in self.folder.iterdir() if file.name in OF_CELLS)
        files = {name: known.get(name) or describe(self.folder / name) for name in names}
        for name in files:
            sync(self.folder / name)
        write_durably(self.folder / TIMING, to_json(timing))
        write_durably(self.folder / CELL, to_json({"format": CELL_FORMAT, **facts, "files": files}))
        for name in OF_HIDDEN - OF_CELLS:
            (self.folder / name).unlink(missing_ok=True)
        sync(self.folder)
        check_inside(self._run, self.place)
        self.place.parent.mkdir(parents=True, exist_ok=True)
        try:
            self.folder.rename(self.place)
        except OSError:
            if read_cell(self.place) is None:
                self._replace()
            # else another runner was first, with the same bytes
        sync(self.place.parent)

    def _replace(self) -> None:
        """Take the place of what is no finished cell, file by file; what is not a cell's stays there."""
        (self.place / CELL).unlink(missing_ok=True)
        new = {file.name for file in self.folder.iterdir()}
        for name in OF_CELLS - new:
            (self.place / name).unlink(missing_ok=True)
        for name in sorted(new - {CELL}):
            os.replace(self.folder / name, self.place / name)
        sync(self.place)
        os.replace(self.folder / CELL, self.place / CELL)
        sync(self.place)


def read_cell(place: Path) -> dict[str, Any] | None:
    """What `cell.json` says of a finished cell; None where the cell is missing, damaged or cut short.

    Raises:
        UnreadableError: it is there and can't be read.
    """
    try:
        if place.is_symlink():
            return None
        cell: dict[str, Any] = read_json(place / CELL)
        if malformed(cell) is not None:
            return None
        whole = all(size_of(place / name) == described["size"] for name, described in cell["files"].items())
    except (OSError, ValueError) as error:
        if isinstance(error, OSError):
            check_damage(place, error)
        return None
    return cell if whole else None


def temporaries(folder: Path) -> list[Path]:
    """What `is_temporary` in a folder."""
    names = sorted(name for name in os.listdir(folder) if name.startswith(TEMPORARY)) if folder.is_dir() else []
    return [folder / name for name in names if is_temporary(folder / name)]


def lock_of(folder: Path) -> Path:
    """The lock file of a hidden folder, beside it."""
    return folder.with_name(folder.name + LOCK)


def hidden_name(path: str) -> str:
    """How the names of a cell's hidden folders begin."""
    return TEMPORARY + path.replace("/", "-")[:100]
