"""Recovery: what is whole of a damaged log, written as a whole log beside it.

The damaged file is only read. Where files were joined, each of them becomes a log of its own.
"""

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import BinaryIO

import numpy as np
from mcap.opcode import Opcode
from mcap.records import Header

from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.log.decoding import RefusedError
from visitlab_cli.log.log import Log
from visitlab_cli.log.mcap_file import HEADER, McapFile
from visitlab_cli.log.recovery.salvage import Salvage
from visitlab_cli.log.source import MAGIC, DamagedError, McapSource, NotMcapError, too_short
from visitlab_cli.whole_file import new_file

SUFFIX = ".recovered.mcap"


@dataclass(frozen=True)
class Recovered:
    """What was saved to the log `path`; `trials` are whole, `parts` those that lost steps.

    `lost_bytes` of the original belong to no whole record; `was_whole`: there was nothing to mend. `others` are the
    logs of the files that were joined behind it, `first_byte` is where in the original each begins; `left_out` tells of
    files among them that hold no log.
    """

    path: Path
    steps: int
    trials: int
    parts: int
    lost_bytes: int
    was_whole: bool
    first_byte: int = 0
    others: tuple["Recovered", ...] = ()
    left_out: tuple[str, ...] = ()


class _NothingError(Exception):
    """Of a file, whose next begins at `end`, nothing can be saved; the message says why."""

    def __init__(self, reason: str, end: int):
        super().__init__(reason)
        self.end = end


def recover(broken: Path, fixed: Path | None = None) -> Recovered:
    """Save what is whole of a log to `fixed`, a new file, by default `NAME.recovered.mcap` beside it.

    Of files that were joined the second goes to `NAME.recovered-2.mcap`, and so on.

    Raises:
        NotFoundError: there is no such file.
        UsageError: `fixed` exists.
        RunError: nothing can be saved, or a file cannot be read or written.
    """
    if not broken.exists():
        raise NotFoundError(f"{broken}: no such file")
    if not broken.is_file():
        raise RunError(f"{broken}: cannot read the log: is no file")
    target = fixed or broken.with_name(broken.name.removesuffix(".mcap") + SUFFIX)
    if target.exists() and target.samefile(broken):
        raise UsageError(f"{target}: is the file to recover; choose another with -o")
    try:
        file = broken.open("rb")
    except OSError as error:
        raise RunError(f"{broken}: cannot read the log: {error.strerror}") from error
    saved: list[Recovered] = []
    left_out: list[str] = []
    lost, first = 0, 0
    with file:
        size = McapSource(file).size
        while first < size or not (saved or left_out):
            path = target if not saved else target.with_name(f"{target.stem}-{len(saved) + 1}{target.suffix}")
            if path.is_symlink() and (fixed is None or saved):
                raise UsageError(f"{path}: is a link, and nobody chose it; choose another file with -o")
            try:
                with new_file(path) as beside:
                    one, first = _one(file, first, path, beside)
                saved.append(one)
            except _NothingError as error:
                left_out.append(f"{error.end - first:,} bytes from byte {first:,} on: {error}")
                lost, first, reason = lost + error.end - first, error.end, str(error)
    if not saved:
        raise RunError(f"{broken}: {reason}")
    whole = saved[0].was_whole and len(saved) == 1 and not left_out
    lost += sum(each.lost_bytes for each in saved)
    return replace(saved[0], lost_bytes=lost, was_whole=whole, others=tuple(saved[1:]), left_out=tuple(left_out))


def _one(file: BinaryIO, first: int, path: Path, beside: Path) -> tuple[Recovered, int]:
    """What was saved to `beside` of the file that begins at the byte `first`, and where the next begins, or the end."""
    source = McapSource(file, first)
    salvage = _salvage(source, beside)
    if salvage.end < source.size:
        source = McapSource(file, first, first + salvage.end)  # its summary is at the end of its own bytes
        salvage = _salvage(source, beside)
    count = _count(beside)
    is_damaged = isinstance(count, DamagedError) or not salvage.was_whole
    if isinstance(count, Exception) and is_damaged and salvage.has_messages:
        salvage = _salvage(source, beside, each_message=True)
        count = _count(beside)
    end = first + source.size
    if isinstance(count, Exception) and salvage.was_whole:
        why = "it is no log of visitlab" if isinstance(count, NotMcapError) else count
        raise _NothingError(f"is whole, there is nothing to recover: {why}", end)
    if not source.size:
        raise _NothingError("nothing in it can be saved: it is empty", end)
    if isinstance(count, Exception):
        why = "what is whole of it is no log" if isinstance(count, NotMcapError) else count
        raise _NothingError(f"nothing in it can be saved: {why}{too_short(source)}", end)
    if not (any(count) or salvage.was_whole):
        why = "no step of it is whole" if salvage.lost_bytes else "no step had been written to it"
        raise _NothingError(f"nothing in it can be saved: {why}", end)
    if salvage.was_whole:
        with beside.open("wb") as copy:
            copy.writelines(source.windows(0, source.size))
    return Recovered(path, *count, salvage.lost_bytes, salvage.was_whole, first), end


def _salvage(source: McapSource, beside: Path, *, each_message: bool = False) -> Salvage:
    target = McapFile(beside, _header(source))
    try:
        salvage = Salvage(source, target, each_message=each_message)
        salvage.run()
        target.finish()
    finally:
        target.abandon()
    return salvage


def _header(source: McapSource) -> Header:
    """The file's own header; ours, where that is lost."""
    try:
        place = source.place_at(len(MAGIC))
        return source.parse(Header, place) if place.opcode == Opcode.HEADER else HEADER
    except DamagedError:
        return HEADER


def _count(path: Path) -> tuple[int, int, int] | NotMcapError | DamagedError | RefusedError:
    """The steps, whole trials and parts of trials of a log, or why it cannot be read as one."""
    try:
        return _counted(path)
    except (NotMcapError, DamagedError, RefusedError) as error:
        return error


def _counted(path: Path) -> tuple[int, int, int]:
    steps = 0
    rows: Counter[int] = Counter()
    lengths: dict[int, int] = {}
    with path.open("rb") as file:
        log = Log(file)
        for block in log.blocks():
            steps += int(np.count_nonzero(block.steps["step"]))
            numbers, counts = np.unique(block.steps["trial"], return_counts=True)
            rows.update(dict(zip(numbers.tolist(), counts.tolist(), strict=True)))
            lengths.update(zip(block.trials["trial"].tolist(), block.trials["steps"].tolist(), strict=True))
        if not log.has_steps:
            raise NotMcapError
        whole = sum(rows[trial] == length + 1 for trial, length in lengths.items()) if log.has_trials else len(rows)
    return steps, whole, len(rows) - whole
