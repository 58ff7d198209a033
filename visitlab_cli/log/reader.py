"""Reading a log back: one trial in milliseconds, the whole as columns, or block by block in bounded memory.

Everything that reads a log notices a broken one and says so in one line, which names `visitlab recover`:
where the whole is read every byte is checked, where a trial is, the chunks that are looked at and the file's frame.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.log.decoding import fitted, impossible
from visitlab_cli.log.layout import Layout, Records
from visitlab_cli.log.log import Log, open_log
from visitlab_cli.log.lookup import Found, looked_up, searched
from visitlab_cli.log.schema import ONE_TRIAL_IN, TRIAL
from visitlab_cli.wording import or_else
from visitlab_cli.world.columns import COLUMNS
from visitlab_cli.world.enums import N_DISTANCES, Action
from visitlab_cli.world.lab import Lab
from visitlab_cli.world.tasks import TASKS

Columns = dict[str, npt.NDArray[np.generic]]

LARGEST_ARENA = 10_000
"""The largest side of a square world that a config may have, in cells."""
_LOG_TIME = "log_time"
_TRIAL_PARTS = ("trial", "step", "reward", _LOG_TIME)


def read_metadata(path: Path) -> dict[str, str]:
    """The cell's attributes; of a log of another writer at least `task`, `cell` (maybe empty) and `one_trial_in`.

    Raises:
        NotFoundError: there is no such file.
        RunError: it is not a log of visitlab, or damaged.
    """
    with open_log(path) as log:
        return log.attributes


def read_steps(path: Path, columns: Sequence[str] | None = None) -> Columns:
    """All recorded steps: for each of the `columns`, else of the task's, an array of shape (steps,).

    Raises:
        NotFoundError: there is no such file.
        UsageError: the task has no such column.
        RunError: it is not a log of visitlab, or damaged.
    """
    with open_log(path) as log:
        names = _names(path, log, columns)
        return _gather(names, log.step_layout, (block.steps for block in log.blocks()))


def iter_steps(path: Path, columns: Sequence[str] | None = None) -> Iterator[Columns]:
    """What `read_steps` gives, in blocks of a chunk each: memory does not grow with the log.

    Raises:
        NotFoundError: there is no such file.
        UsageError: the task has no such column.
        RunError: it is not a log of visitlab, or damaged.
    """
    with open_log(path) as log:
        names = _names(path, log, columns)
        for block in log.blocks():
            yield {name: block.steps[name].copy() for name in names}


def whole_trials(path: Path, blocks: Iterable[Columns]) -> Iterator[Columns]:
    """Steps that come in `blocks`, with all of the task's columns, as one block for each trial, from its step 0 on.

    Raises:
        RunError: a part of a trial is missing.
    """
    begun: Columns = {}
    for block in blocks:
        rows = {name: np.concatenate([begun[name], values]) for name, values in block.items()} if begun else block
        trial, step = (rows[name].astype(np.int64) for name in ("trial", "step"))
        goes_on = (np.diff(step, prepend=-1) == 1) & (np.diff(trial, prepend=trial[:1]) == 0)
        if not (wrong := goes_on | (step == 0)).all():
            row = int(np.argmin(wrong))
            raise RunError(f"{path}: trial {trial[row]} lacks what comes before its step {step[row]}")
        bounds = np.flatnonzero(step == 0).tolist()
        for start, end in pairwise(bounds):
            yield {name: values[start:end] for name, values in rows.items()}
        begun = {name: values[bounds[-1] :] for name, values in rows.items()} if bounds else {}
    if begun:
        yield begun


def trials(path: Path) -> Columns:
    """The `/trial` messages: for each of their fields an array of shape (trials,), `goals` in a visit only.

    Where another writer left them out they are made from the steps.

    Raises:
        NotFoundError: there is no such file.
        RunError: it is not a log of visitlab, or damaged.
    """
    with open_log(path) as log:
        layout = log.trial_layout
        found = _gather(layout.fields, layout, (block.trials for block in log.blocks()))
        if log.has_trials:
            return found
        steps = _gather(_TRIAL_PARTS, log.step_layout, (block.steps for block in log.blocks()))
        return _gather(layout.fields, layout, [_trials_of(steps, layout)])


def read_trial(path: Path, trial: int, columns: Sequence[str] | None = None) -> Columns:
    """The steps of one trial, from its step 0 on: for each column an array of shape (steps + 1,).

    In a log that this package wrote the trial is found by bisection: a few chunks are read, whatever its length. In
    any other, and where that finds less than the whole trial, the whole log is searched.

    Raises:
        NotFoundError: there is no such file, or the trial is not recorded.
        UsageError: the task has no such column.
        RunError: it is not a log of visitlab, or damaged, or lacks a part of the trial.
    """
    with open_log(path) as log:
        names = _names(path, log, columns)
        found = looked_up(log, trial) or searched(log, trial)
        if not len(found.rows):
            raise NotFoundError(f"{path}: trial {trial} is not recorded; {_recorded(log, found)}")
        if not found.is_whole(log.has_trials):
            raise RunError(f"{path}: {found.what_is_wrong(trial)}")
        return {name: found.rows[name].copy() for name in names}


def read_attachment(path: Path, name: str) -> bytes | None:
    """The first attachment of a name, None where there is none.

    Raises:
        NotFoundError: there is no such file.
        RunError: it is not a log of visitlab, or damaged.
    """
    with open_log(path) as log:
        return log.attachment(name)


def check_values(path: Path, steps: Columns, task: str, lab: Lab) -> None:
    """Refuse what no simulation of `task` in `lab` can have logged, and no word or picture exists for.

    Raises:
        RunError: it names the first step of `steps`, the columns of a trial, with such a value.
    """
    most: dict[str, int] = {column.name: int(max(column.enum)) for column in COLUMNS if column.enum is not None}
    n_states, n_actions = TASKS[task].size(lab)
    most |= {"goal_room": lab.n_rooms - 1, "distance": N_DISTANCES - 1, "state": n_states - 1}
    known = {
        "action": [*range(n_actions), Action.NO_ACTION],
        "executed_action": [*range(Action.GO_TO_HUMAN_VISION), Action.NO_ACTION],
    }
    in_arena = "goal_room" not in steps and "human_row" in steps
    for axis, size in (("row", lab.rows), ("col", lab.cols)):
        most |= dict.fromkeys((f"robot_{axis}", f"human_{axis}"), (LARGEST_ARENA if in_arena else size) - 1)
        most |= dict.fromkeys((f"wanted_robot_{axis}", f"wanted_human_{axis}"), size - 1)
    for name, column in steps.items():
        values: npt.NDArray[Any] = column
        if name in known:
            wrong = ~np.isin(values, known[name])
        elif name in most:
            wrong = values > most[name]
        else:
            wrong = ~np.isfinite(values)
        if wrong.any():
            row = int(np.argmax(wrong))
            is_named = "step" in steps and "trial" in steps
            where = f"step {steps['step'][row]} of trial {steps['trial'][row]}" if is_named else f"row {row}"
            there = f" in {task}" if name in known and values[row] <= max(Action) else ""
            raise RunError(f"{path}: {where} has {name} {values[row]}, which there is not{there}")


def _recorded(log: Log, found: Found) -> str:
    """Which trials the log holds, in words."""
    if found.numbers is None:
        return "the log holds none"
    thinned = log.attributes.get(ONE_TRIAL_IN, "1")
    return f"the log holds {found.numbers[0]} to {found.numbers[1]}" + (f", one in {thinned}" if thinned != "1" else "")


def _names(path: Path, log: Log, columns: Sequence[str] | None) -> tuple[str, ...]:
    """The names of the columns that are asked for, each known."""
    known = log.step_layout.fields
    columns = (columns,) if isinstance(columns, str) else columns
    for name in columns or ():
        if name not in known:
            raise UsageError(f"{path}: its steps have no column {name}{or_else(name, known)}")
    return known if columns is None else tuple(columns)


def _gather(names: Iterable[str], layout: Layout, blocks: Iterable[Records]) -> Columns:
    """The fields `names` of all `blocks` as arrays of their own, so that no block outlives its turn."""
    parts: dict[str, list[npt.NDArray[np.generic]]] = {name: [np.empty(0, layout.dtype[name])] for name in names}
    for block in blocks:
        for name, arrays in parts.items():
            arrays.append(block[name].copy())
    return {name: np.concatenate(parts.pop(name)) for name in list(parts)}


def _trials_of(steps: Columns, layout: Layout) -> Records:
    """The trials that the steps of a whole log are, one for each run of equal trial numbers.

    Raises:
        RefusedError: one has a value that there is not.
    """
    numbers = steps["trial"]
    firsts = np.flatnonzero(np.append(True, numbers[1:] != numbers[:-1])[: len(numbers)])
    trials = layout.blank(len(firsts))
    if len(firsts):
        with np.errstate(invalid="ignore", over="ignore"):  # others' rewards may be infinite
            rewards = np.add.reduceat(steps["reward"].astype(np.float64), firsts)
        last_rows = np.append(firsts[1:], len(numbers)) - 1
        values = {
            "trial": numbers[firsts],
            "first_step_time": steps[_LOG_TIME][firsts],
            "reward": rewards,
            "steps": steps["step"][last_rows],
            "goals": rewards,
        }
        for name in layout.fields:
            trials[name], is_right = fitted(values[name], values[name].dtype, trials.dtype[name])
            if not is_right.all():
                wrong = int(np.argmin(is_right))
                raise impossible(TRIAL, numbers[firsts[wrong]], 0, name, values[name][wrong])
    return trials
