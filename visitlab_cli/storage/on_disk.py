"""What lies in a run folder, found by looking: cells whole and damaged, what killed processes left, bytes.

Links are never followed.
"""

import os
import re
from pathlib import Path

from visitlab_cli.storage.cell_folder import DAMAGED, OF_CELLS, TEMPORARY

EVALUATIONS, OPTIONS = "evaluations", "evaluation.json"
"""The folder of what was played with options of its own, and the file of the options in each of its folders."""
REPORT, OF_REPORT = "report.html", b"<!doctype html>\n<!-- a report of visitlab -->\n"
"""A run's page, and how each begins: what begins otherwise is the user's."""
_SEED_FOLDER = re.compile(r"seed-\d+")


def cell_folders(run: Path) -> list[Path]:
    """Every folder of a cell, done or not, in the order of their paths.

    It holds files of ours: what else is called `seed-0000`, such as the folder of a human of that name, is no cell.
    """
    found = []
    for here, folders, files in os.walk(run):
        folders[:] = [name for name in folders if not name.startswith(TEMPORARY)]
        if is_seed_folder(os.path.basename(here)) and OF_CELLS.intersection(files):
            found.append(Path(here))
    return sorted(found)


def is_seed_folder(name: str) -> bool:
    """Whether a cell's folder may have this name."""
    return _SEED_FOLDER.fullmatch(name) is not None


def leftovers(run: Path) -> list[Path]:
    """What processes that were killed left, or others are writing now, in the run folder itself."""
    return sorted(run.glob(f"{TEMPORARY}*"))


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
