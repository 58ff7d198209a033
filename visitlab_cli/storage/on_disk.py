"""What lies in a run folder, found by looking: cells whole and damaged, what killed processes left, bytes.

Links are never followed. A folder that can't be looked into is told, never passed over: nobody knows what it holds.
"""

import os
import re
from collections.abc import Iterator
from pathlib import Path

from visitlab_cli.storage.cell_folder import DAMAGED, OF_CELLS, TEMPORARY, temporaries
from visitlab_cli.storage.inside import is_real
from visitlab_cli.storage.reading import check_damage

EVALUATIONS, OPTIONS = "evaluations", "evaluation.json"
"""The folder of what was played with options of its own, and the file of the options in each of its folders."""
REPORT, FIGURES, FAILURES, JOBS = "report.html", "figures", "failures", "jobs"
"""A run's page; the folders of its pictures, of the tracebacks of cells that failed, of its jobs' scripts and logs."""
_SEED_FOLDER = re.compile(r"seed-\d+")


def cell_folders(run: Path) -> list[Path]:
    """Every folder of a cell, done or not, in the order of their paths.

    It holds files of ours: what else is called `seed-0000`, such as the folder of a human of that name, is no cell.

    Raises:
        UnreadableError: a folder can't be looked into.
    """
    found = []
    for here, folders, files in walk(run):
        folders[:] = [name for name in folders if not name.startswith(TEMPORARY)]
        if is_seed_folder(here.name) and OF_CELLS.intersection(files):
            found.append(here)
    return sorted(found)


def walk(folder: Path) -> Iterator[tuple[Path, list[str], list[str]]]:
    """As `os.walk`, which passes over what it can't look into.

    Raises:
        UnreadableError: a folder can't be looked into.
    """

    def told(error: OSError) -> None:
        check_damage(Path(error.filename), error)  # else it vanished

    for here, folders, files in os.walk(folder, onerror=told):
        yield Path(here), folders, files


def is_seed_folder(name: str) -> bool:
    """Whether a cell's folder may have this name."""
    return _SEED_FOLDER.fullmatch(name) is not None


def leftovers(run: Path) -> list[Path]:
    """What processes that were killed left, or others are writing now, wherever a run is written to."""
    folders = [run / FIGURES, *(sorted((run / EVALUATIONS).iterdir()) if is_real(run / EVALUATIONS) else [])]
    return [path for folder in (run, *filter(is_real, folders)) for path in temporaries(folder)]


def set_aside(file: Path) -> None:
    """Rename a file so that it counts as missing, and what depends on it is made again.

    Raises:
        OSError: it can't be renamed.
    """
    os.replace(file, file.with_name(file.name + DAMAGED))


def was_set_aside(file: Path) -> bool:
    """Whether `set_aside` took a file of this name away."""
    return file.with_name(file.name + DAMAGED).exists()


def bytes_below(folder: Path) -> int:
    """The sizes of all files in a folder, in bytes; what vanishes meanwhile counts nothing."""
    total = 0
    for here, _, files in os.walk(folder):
        for name in files:
            try:
                total += os.lstat(os.path.join(here, name)).st_size
            except OSError:
                continue
    return total
