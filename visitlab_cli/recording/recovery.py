"""Recovery: what is whole of a damaged log, written as a whole log beside it.

Chunks are copied as they are; what can be derived from them (their indexes, the summary, its CRCs) is made anew.
The damaged file is only read.
"""

from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.recording.log import open_log
from visitlab_cli.recording.mcap_file import McapFile
from visitlab_cli.recording.salvage import Salvage
from visitlab_cli.recording.schema import STEP_TOPIC
from visitlab_cli.recording.source import McapSource
from visitlab_cli.whole_file import new_file

SUFFIX = ".recovered.mcap"


@dataclass(frozen=True)
class Recovered:
    """What was saved to the log `path`; `trials` are whole, `parts` those that lost steps.

    `lost_bytes` of the original belong to no whole record; `was_whole`: there was nothing to mend.
    """

    path: Path
    steps: int
    trials: int
    parts: int
    lost_bytes: int
    was_whole: bool


def recover(broken: Path, fixed: Path | None = None) -> Recovered:
    """Save what is whole of a log to `fixed`, a new file, by default `NAME.recovered.mcap` beside it.

    Raises:
        NotFoundError: there is no such file.
        UsageError: `fixed` exists.
        RunError: nothing can be saved, or a file cannot be read or written.
    """
    target = fixed or broken.with_name(broken.name.removesuffix(".mcap") + SUFFIX)
    if not broken.exists():
        raise NotFoundError(f"{broken}: no such file")
    if target.exists() and target.samefile(broken):
        raise UsageError(f"{target}: is the file to recover; choose another with -o")
    with new_file(target) as beside:
        salvage = _salvage(broken, beside)
        try:
            found = _count(beside) if STEP_TOPIC in salvage.topics else None
        except RunError:
            found = None
        if found is None:
            raise RunError(f"{broken}: nothing in it can be saved: what is whole of it is no log")
    return Recovered(target, *found, salvage.lost_bytes, salvage.was_whole)


def _salvage(broken: Path, beside: Path) -> Salvage:
    if broken.exists() and not broken.is_file():
        raise RunError(f"{broken}: cannot read the log: is no file")
    try:
        file = broken.open("rb")
    except OSError as error:
        raise RunError(f"{broken}: cannot read the log: {error.strerror}") from error
    with file:
        target = McapFile(beside)
        try:
            salvage = Salvage(McapSource(file), target)
            salvage.run()
            target.finish()
        finally:
            target.abandon()
    return salvage


def _count(path: Path) -> tuple[int, int, int]:
    """The steps, whole trials and parts of trials of a log."""
    steps = 0
    rows: Counter[int] = Counter()
    lengths: dict[int, int] = {}
    with open_log(path) as log:
        for block in log.blocks():
            steps += int(np.count_nonzero(block.steps["step"]))
            numbers, counts = np.unique(block.steps["trial"], return_counts=True)
            rows.update(dict(zip(numbers.tolist(), counts.tolist(), strict=True)))
            lengths.update(zip(block.trials["trial"].tolist(), block.trials["steps"].tolist(), strict=True))
        whole = sum(rows[trial] == length + 1 for trial, length in lengths.items()) if log.has_trials else len(rows)
    return steps, whole, len(rows) - whole
