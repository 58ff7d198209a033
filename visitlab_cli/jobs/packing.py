"""How many jobs a run's missing cells make: as few as are worth a start, as many as the time of a job asks for."""

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.errors import UsageError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.estimate import earliest_ends, seconds_of
from visitlab_cli.plan.shards import shards

AROUND = 180.0
"""Seconds of a job in which it does not play: it starts, compiles, and is asked to end before its time is over."""
LEAST = 300.0
"""Estimated seconds of play that are worth a job of its own."""
ROUND = 600
"""A time that is proposed is a multiple of so many seconds."""
TIME = re.compile(r"(?:(\d{1,3})-)?(\d{1,4}):([0-5]\d):([0-5]\d)")


class Limits(NamedTuple):
    """What jobs may be: at most so many, of at most so many `seconds` (None: any), each with so many `workers`.

    `cells` is how many a job should do, 0 by what they cost; `margin` what estimated times are multiplied by.
    """

    jobs: int
    seconds: int | None
    cells: int
    workers: int
    margin: float


class Job(NamedTuple):
    """The number of its shard, from 1, how many cells it has to do, and its estimated seconds with the margin."""

    shard: int
    cells: int
    seconds: float


class Packing(NamedTuple):
    """Those of `total` shards in which something is missing."""

    total: int
    jobs: tuple[Job, ...]

    @property
    def longest(self) -> float:
        """The seconds of the longest job."""
        return max((job.seconds for job in self.jobs), default=0.0)


def pack(cells: Sequence[Cell], missing: Sequence[Cell], limits: Limits) -> Packing:
    """The `missing` ones of a plan's `cells` as jobs within limits.

    Raises:
        UsageError: they don't fit; with what would.
    """
    if not missing:
        return Packing(0, ())
    if limits.cells and (count := math.ceil(len(missing) / limits.cells)) > limits.jobs:
        raise UsageError(
            f"--cells-per-job {limits.cells} makes {count} jobs of {len(missing)} cells; --jobs {count} fits"
        )
    work = _Work(cells, missing, limits)
    if limits.cells:
        found = work.packing(math.ceil(len(missing) / limits.cells))
    else:
        found = work.packing_within(limits.seconds, work.worthwhile(), limits.jobs)
    if limits.seconds is not None and found.longest > limits.seconds:
        raise UsageError(work.refusal(limits.seconds, found))
    return found


class _Work:
    """What is to be done, with what each cell is taken to cost."""

    def __init__(self, cells: Sequence[Cell], missing: Sequence[Cell], limits: Limits) -> None:
        self.cells, self.limits = cells, limits
        self.seconds = {cell.path: limits.margin * seconds_of(cell) for cell in missing}
        self.ends = earliest_ends(missing, self.seconds)

    def worthwhile(self) -> int:
        """How many jobs are worth their start."""
        return max(1, int(sum(self.seconds.values()) / self.limits.margin / self.limits.workers / LEAST))

    def packing_within(self, seconds: float | None, count: int, most: int) -> Packing:
        """The packing from `count` shards on of which no job is too long; where there is none, that of `most`."""
        most = min(most, len(self.cells))
        while True:
            count = min(count, most)
            found = self.packing(count)
            if seconds is None or found.longest <= seconds or count == most:
                return found
            count = max(count + 1, int(count * found.longest / seconds))

    def packing(self, count: int) -> Packing:
        """What is missing in each of `count` shards."""
        jobs = []
        for number, shard in enumerate(shards(self.cells, count), 1):
            paths = [cell.path for cell in shard if cell.path in self.seconds]
            if paths:
                shared = sum(self.seconds[path] for path in paths) / self.limits.workers
                jobs.append(Job(number, len(paths), AROUND + max(shared, *(self.ends[path] for path in paths))))
        return Packing(count, tuple(jobs))

    def refusal(self, seconds: int, found: Packing) -> str:
        """Why a packing does not fit, and what would."""
        fitting = [f"--time {in_clock(found.longest)}"]
        if AROUND + max(self.ends.values()) <= seconds:  # else the longest chain of cells alone does not fit
            more = self.packing_within(seconds, found.total + 1, len(self.cells))
            if more.longest <= seconds:
                fitting.append(f"--jobs {len(more.jobs)}{' without --cells-per-job' if self.limits.cells else ''}")
        jobs = f"{len(found.jobs)} job{'s' if len(found.jobs) > 1 else ''}"
        told = f"the longest of {jobs} would take {in_clock(found.longest, 60)}"
        told += f", {AROUND / 60:g} minutes around playing and {self.limits.margin:g} times its estimate"
        return f"--time {in_clock(seconds, 1)}: {told}; {' or '.join(fitting)} fits"


def seconds_in(clock: str) -> int:
    """The seconds of a time such as 1:30:00 or 2-12:00:00.

    Raises:
        UsageError: it is no such time.
    """
    found = TIME.fullmatch(clock)
    days, hours, minutes, seconds = (int(part or 0) for part in found.groups()) if found else (0, 0, 0, 0)
    told = ((days * 24 + hours) * 60 + minutes) * 60 + seconds
    if not told:
        raise UsageError(
            f"--time {clock}: must be hours:minutes:seconds, such as 1:30:00, or days-hours:minutes:seconds"
        )
    return told


def in_clock(seconds: float, step: int = ROUND) -> str:
    """A time as hours:minutes:seconds, rounded up to a multiple of `step` seconds."""
    whole = math.ceil(seconds / step) * step
    return f"{whole // 3600}:{whole // 60 % 60:02}:{whole % 60:02}"
