"""One trial of a log: by bisection where the log is ours, else wherever its rows are."""

from bisect import bisect_left
from dataclasses import dataclass, field

import numpy as np

from visitlab_cli.log.decoding import RefusedError
from visitlab_cli.log.layout import Records
from visitlab_cli.log.log import Block, Log

MOST_ROWS = 2 * 10**6
"""No config has trials so long, by far."""


class _NotOursError(Exception):
    """A chunk is not as our writer writes it."""


@dataclass
class Found:
    """What was found of a trial: its `rows`, and its `steps` as each of its `/trial` messages tells them.

    `numbers`: the first and the last trial of all that was looked at.
    """

    rows: Records
    steps: list[int] = field(default_factory=list)
    numbers: tuple[int, int] | None = None

    def is_whole(self, has_trials: bool) -> bool:
        """Whether these are all rows of one trial, as its `/trial` message tells, where the log `has_trials`."""
        counted = self.steps == [len(self.rows) - 1] if has_trials else True
        return counted and len(self.rows) > 0 and bool((self.rows["step"] == np.arange(len(self.rows))).all())

    def what_is_wrong(self, trial: int) -> str:
        """Why they are not, in words."""
        starts = max(int(np.count_nonzero(self.rows["step"] == 0)), len(self.steps))
        numbers, counts = np.unique(self.rows["step"], return_counts=True)
        if starts > 1:
            return f"trial {trial} is there {starts} times, and nothing tells which is meant"
        if (counts > 1).any():
            return f"step {numbers[counts > 1][0]} of trial {trial} is there twice"
        if self.steps and len(self.rows) > self.steps[0] + 1:
            return f"trial {trial} has {len(self.rows)} rows, its /trial message says {self.steps[0] + 1}"
        if not self.steps and (numbers == np.arange(len(numbers))).all():
            return f"of trial {trial} only {len(self.rows)} rows are left, and no /trial message that ends it"
        return f"of trial {trial} only {len(self.rows)} rows are left, the log lost the others"


def looked_up(log: Log, trial: int) -> Found | None:
    """The trial in a log of ours, where trials lie in order, each before its message; None where it is not so found."""
    if not log.own_chunks:
        return None
    found, parts = Found(np.empty(0, log.step_layout.dtype)), []
    try:
        _own(log, len(log.own_chunks) - 1)
        chunks = range(len(log.own_chunks))
        for chunk in chunks[bisect_left(chunks, trial, key=lambda chunk: _last_trial(log, chunk)) :]:
            block = _own(log, chunk)
            parts.append(block.steps[block.steps["trial"] == trial])
            found.steps += _told(block, trial)
            if found.steps or (len(block.steps) and block.steps["trial"][-1] > trial):
                break
    except _NotOursError:
        return None
    found.rows = np.concatenate([found.rows, *parts])
    return found if found.is_whole(has_trials=True) else None


def searched(log: Log, trial: int) -> Found:
    """The trial wherever its rows are, in the order of their time; the whole log is read, none of it is kept."""
    found, parts, count = Found(np.empty(0, log.step_layout.dtype)), [], 0
    for block in log.blocks(checked=False):
        numbers = block.steps["trial"]
        if len(numbers):
            ends = found.numbers or (int(numbers[0]), int(numbers[0]))
            found.numbers = min(ends[0], int(numbers.min())), max(ends[1], int(numbers.max()))
        if (own := block.steps[numbers == trial]).size:
            parts.append(own)
            count += len(own)
            if count > MOST_ROWS:
                raise RefusedError(f"trial {trial} has more than {MOST_ROWS:,} rows")
        found.steps += _told(block, trial)
    rows = np.concatenate([found.rows, *parts])
    found.rows = rows[np.argsort(rows["log_time"], kind="stable")]
    return found


def _told(block: Block, trial: int) -> list[int]:
    told: list[int] = block.trials["steps"][block.trials["trial"] == trial].tolist()
    return told


def _own(log: Log, chunk: int) -> Block:
    block: Block | None = log.own_block(chunk)
    if block is None:
        raise _NotOursError
    return block


def _last_trial(log: Log, chunk: int) -> int:
    """The number of the trial that a chunk ends in; of a chunk without any step or trial -1."""
    block = _own(log, chunk)
    rows = block.steps if len(block.steps) else block.trials
    return int(rows["trial"][-1]) if len(rows) else -1
