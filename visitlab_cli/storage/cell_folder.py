"""A cell's folder: it appears whole or not at all, and `cell.json`, written last, says that it is done.

Files are written in a hidden folder beside the cells, flushed to the disk, and the folder is renamed to its place.
In the place of a damaged cell its files are renamed one by one instead, `cell.json` last, for the user may keep
files there. While it is written its folder is locked, so that what a killed process left can be told from what
another one is still writing.
"""

import fcntl
import hashlib
import json
import os
import shutil
import uuid
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from visitlab_cli.errors import RunError
from visitlab_cli.sources import is_sources

CELL_FORMAT = 1
FACTS: dict[str, type | tuple[type, ...]] = {
    "cell": str,
    "seed": int,
    "steps": int,
    "trials": int,
    "mean_reward_last_hundredth": (int, float),
    "mean_reward_last_tenth": (int, float),
    "config_hash": str,
    "versions": dict,
}
"""What `cell.json` says beside `format` and `files`."""
SOURCES = "sources"
"""What it says, too, but for cells of version 0.1.0: the hash of the code that made it."""
STEPS, TRIALS, MODEL, CELL, TIMING = "steps.mcap", "trials.parquet", "model.npz", "cell.json", "timing.json"
TEMPORARY = ".tmp-"
DAMAGED = ".damaged"
"""How the name of a file ends that was set aside."""
OF_CELLS = frozenset(name + ending for name in (STEPS, TRIALS, MODEL, CELL, TIMING) for ending in ("", DAMAGED))
"""The files of a cell."""


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
    with file.open("rb") as stream:
        digest = hashlib.file_digest(stream, "sha256").hexdigest()
    return {"size": file.stat().st_size, "sha256": digest}


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
        self.folder = run / f"{TEMPORARY}{path.replace('/', '-')[:100]}-{uuid.uuid4().hex[:8]}"
        self._lock = -1

    def __enter__(self) -> Self:
        """Make the hidden folder and lock it."""
        try:
            self.folder.mkdir(parents=True)
            self._lock = os.open(self.folder, os.O_RDONLY)
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            raise RunError(f"{self.folder.parent}: can't be written: {one_line(error)}") from error
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove what was not committed; a full disk becomes one clear line."""
        shutil.rmtree(self.folder, ignore_errors=True)
        os.close(self._lock)
        if isinstance(error, OSError):
            raise RunError(f"{self.place}: can't be written: {one_line(error)}") from error

    def commit(self, facts: dict[str, Any], timing: dict[str, Any]) -> None:
        """Write `timing.json` and, last, `cell.json` with `facts` and the files' hashes; then rename."""
        files = {file.name: describe(file) for file in sorted(self.folder.iterdir())}
        for name in files:
            sync(self.folder / name)
        write_durably(self.folder / TIMING, to_json(timing))
        write_durably(self.folder / CELL, to_json({"format": CELL_FORMAT, **facts, "files": files}))
        sync(self.folder)
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
    """What `cell.json` says of a finished cell; None where the cell is missing, damaged or cut short."""
    try:
        cell = json.loads((place / CELL).read_text(encoding="utf-8"))
        if cell["format"] != CELL_FORMAT:
            return None
        sizes = {name: (place / name).stat().st_size for name in cell["files"]}
        whole = all(sizes[name] == facts["size"] for name, facts in cell["files"].items())
        whole = whole and all(isinstance(cell[name], kind) for name, kind in FACTS.items())
        whole = whole and (SOURCES not in cell or is_sources(cell[SOURCES]))
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return None
    return cell if whole else None


def remove_leftovers(run: Path) -> None:
    """Remove the hidden folders of processes that were killed; those still being written stay."""
    for folder in run.glob(f"{TEMPORARY}*"):
        try:
            lock = os.open(folder, os.O_RDONLY)
        except OSError:
            continue
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if folder.is_dir():
                shutil.rmtree(folder, ignore_errors=True)
        except BlockingIOError:
            pass
        finally:
            os.close(lock)
