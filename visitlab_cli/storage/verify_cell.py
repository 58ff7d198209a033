"""Is a cell as it was written? Its files' hashes computed anew, and `cell.json` compared with what it is about."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import VisitlabError
from visitlab_cli.storage.arrays import read_trials
from visitlab_cli.storage.cell_folder import (
    CELL,
    FACTS,
    MODEL,
    SOURCES,
    STEPS,
    TRIALS,
    describe,
    one_line,
    to_json,
)
from visitlab_cli.storage.facts import malformed
from visitlab_cli.storage.on_disk import was_set_aside
from visitlab_cli.storage.reading import UnreadableError, parse_json, read_text, size_of
from visitlab_cli.wording import printable

MEANS = {"mean_reward_last_hundredth": 100, "mean_reward_last_tenth": 10}
"""Which part of the trials a mean is of: the last 1%, the last tenth."""
MOST_DIGITS_WRONG = 16
"""The hash of another file agrees in 4 of 64 digits, not in 48."""
ROUNDING = 1e-14
"""How far, relatively, two sums of the same numbers may lie apart."""


def cell_faults(folder: Path, path: str, digest: str | None, steps: int | None) -> list[tuple[str, str]]:
    """What is wrong with a cell, as pairs of file and problem.

    Args:
        folder: the cell's folder.
        path: what it should say that its path in the run is.
        digest: the config hash that it should state; None where that is in doubt.
        steps: how many steps it should have; None where that is not known.

    Raises:
        UnreadableError: nobody can tell.
    """
    file = folder / CELL
    try:
        text = read_text(file)
        cell = parse_json(text)
    except FileNotFoundError:
        return [(CELL, "set aside as damaged by an earlier verify" if was_set_aside(file) else "missing")]
    except OSError as error:
        return [(CELL, one_line(error))]
    except ValueError as error:
        return [(CELL, f"damaged: not JSON: {printable(str(error))}")]
    malformed = _malformed(cell, text)
    if malformed:
        return [(CELL, malformed)]
    faults = [problem for name in _names(folder, cell) if (problem := _file_fault(folder, name, cell["files"]))]
    said = {"cell": path, "seed": int(folder.name.removeprefix("seed-")), "config_hash": digest, "steps": steps}
    faults += [
        (CELL, f"{key} is {cell[key]}, not {value}")
        for key, value in said.items()
        if value is not None and cell[key] != value
    ]
    if not any(name == TRIALS for name, _ in faults):
        faults += _rewards_faults(folder, cell)
    return faults


def _malformed(cell: Any, text: str) -> str | None:
    if problem := malformed(cell):
        return problem
    if SOURCES not in cell and (unknown := cell.keys() - {"format", "files", *FACTS}):
        return f"damaged: says {min(unknown)!r}, which no cell of before {SOURCES} says"
    return None if text == to_json(cell) else "damaged: not written as visitlab writes it"


def _names(folder: Path, cell: dict[str, Any]) -> list[str]:
    """The files that must be looked at: what the cell lists, what every cell has, and a log that is there."""
    log = {STEPS} if (folder / STEPS).exists() else set()
    return sorted({*cell["files"], TRIALS, MODEL} | log)


def _file_fault(folder: Path, name: str, files: dict[str, dict[str, Any]]) -> tuple[str, str] | None:
    file, described = folder / name, files.get(name)
    if described is None:
        return CELL, f"does not list {name}"
    try:
        size = size_of(file)
        digest = describe(file)["sha256"] if size == described["size"] else ""
    except FileNotFoundError:
        return name, "missing"
    except OSError as error:
        return name, one_line(error)
    if size != described["size"]:
        return name, f"has {size:,} bytes, {CELL} says {described['size']:,}"
    if digest != described["sha256"]:
        return _hash_fault(name, digest, described["sha256"])
    return None


def _hash_fault(name: str, actual: str, stated: str) -> tuple[str, str]:
    """Another hash differs in nearly all digits; where few do, what is stated was damaged, not the file."""
    wrong = sum(a != b for a, b in zip(actual, stated, strict=False)) + abs(len(actual) - len(stated))
    if wrong <= MOST_DIGITS_WRONG:
        return CELL, f"the sha256 that it states of {name} is damaged, in {wrong} of {len(actual)} digits"
    return name, f"its sha256 is {actual[:12]}..., {CELL} says {stated[:12]}..."


def _rewards_faults(folder: Path, cell: dict[str, Any]) -> list[tuple[str, str]]:
    try:
        rewards = read_trials(folder / TRIALS)["reward"]
    except UnreadableError:
        raise
    except VisitlabError:
        return [(TRIALS, "no table of trials")]
    if cell["trials"] != len(rewards):
        return [(CELL, f"trials is {cell['trials']}, not {len(rewards)}")]
    return [
        (CELL, f"{key} is {cell[key]!r}, not {mean!r}")
        for key, part in MEANS.items()
        if not math.isclose(cell[key], mean := _last_mean(rewards, part), rel_tol=ROUNDING)
    ]


def _last_mean(rewards: npt.NDArray[np.float64], part: int) -> float:
    return math.fsum(rewards[-max(1, len(rewards) // part) :]) / max(1, len(rewards) // part)
