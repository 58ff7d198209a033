"""What `cell.json` and `timing.json` say, and whether it can be so: one answer for all who read a cell."""

from pathlib import Path
from typing import Any

from visitlab_cli.sources import is_sources
from visitlab_cli.storage.reading import read_json

CELL_FORMAT = 1
FACTS: dict[str, tuple[type, ...]] = {
    "cell": (str,),
    "seed": (int,),
    "steps": (int,),
    "trials": (int,),
    "mean_reward_last_hundredth": (int, float),
    "mean_reward_last_tenth": (int, float),
    "config_hash": (str,),
    "versions": (dict,),
}
"""What `cell.json` says beside `format` and `files`."""
SOURCES = "sources"
"""What it says, too, but for cells of version 0.1.0: the hash of the code that made it."""
STEPS, TRIALS, MODEL, CELL, TIMING = "steps.mcap", "trials.parquet", "model.npz", "cell.json", "timing.json"
CPU_SECONDS = "cpu_seconds"
"""What `timing.json` says, too, of cells made since 0.2.0."""
LARGEST = 1e12
"""No mean of rewards, and no time in seconds, is larger."""


def malformed(cell: Any) -> str | None:
    """What of a `cell.json` can't be so, whatever the cell; None where all can."""
    if not isinstance(cell, dict):
        return "damaged: not a mapping"
    for key, kinds in {"format": (int,), **FACTS, "files": (dict,)}.items():
        if type(cell.get(key)) not in kinds:  # a truth is no number
            return f"damaged: {key} is {'missing' if key not in cell else 'of another kind'}"
        if key not in ("format", "files") and not isinstance(cell[key], str | dict) and not abs(cell[key]) <= LARGEST:
            return f"damaged: {key} is {cell[key]}"
    if cell["format"] != CELL_FORMAT:
        return f"of format {cell['format']}, not {CELL_FORMAT}"
    if SOURCES in cell and not is_sources(cell[SOURCES]):
        return f"damaged: {SOURCES} is no hash of sources"
    if not all(_is_description(described) for described in cell["files"].values()):
        return "damaged: a file is not described by size and sha256"
    if not all(isinstance(version, str) for version in cell["versions"].values()):
        return "damaged: a version is no text"
    if foreign := sorted(cell["files"].keys() - {STEPS, TRIALS, MODEL}):
        return f"lists a file {foreign[0]!a}, which no cell has"  # also keeps the eye inside of the cell's folder
    return None


def _is_description(described: Any) -> bool:
    kinds = {key: type(value) for key, value in described.items()} if isinstance(described, dict) else {}
    return kinds == {"size": int, "sha256": str}


def seconds_of(folder: Path) -> float | None:
    """How long a cell took; no hash covers `timing.json`, so nothing is said where it is not as it should be."""
    return _timed(folder, "seconds")


def cpu_seconds_of(folder: Path) -> float | None:
    """The time of one core that a cell's steps took, without recording them; None where it is not said."""
    return _timed(folder, CPU_SECONDS)


def _timed(folder: Path, key: str) -> float | None:
    try:
        timing = read_json(folder / TIMING)
    except (OSError, ValueError):
        return None
    seconds: Any = timing.get(key) if isinstance(timing, dict) else None
    is_number = isinstance(seconds, int | float) and not isinstance(seconds, bool)
    return float(seconds) if is_number and 0 <= seconds < LARGEST else None
