"""What a user's words choose: the logs of a run's cells, and the trial in them."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.log.reader import read_steps, trials
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.plan.selection import MOST_NAMED, Selection
from visitlab_cli.scene.trial import phase_trials_of_log
from visitlab_cli.storage.arrays import read_trials
from visitlab_cli.storage.cell_folder import STEPS, TRIALS, read_cell, reason
from visitlab_cli.storage.reading import check_damage
from visitlab_cli.storage.run_folder import find_run, read_config
from visitlab_cli.wording import few, printable
from visitlab_cli.world.enums import InteractionLevel

Numbers = npt.NDArray[np.int64]
Rewards = npt.NDArray[np.float64]
BEST, WORST, MEDIAN, LONGEST_ENGAGEMENT = SELECTORS = ("best", "worst", "median", "longest-engagement")
MOST_DIGITS = 9
CHOOSE = "--experiment, --human, --agent, --seed and --at choose"


class Log(NamedTuple):
    """A log, and the cell that it is of: its path in the run, or the file's own.

    In a run, one trial in `one_in` was recorded, and a table of all trials lies beside the log; of a file it is 0.
    """

    path: Path
    cell: str
    one_in: int = 0

    def trials(self, phase: int | None = None) -> tuple[Numbers, Rewards]:
        """The numbers and rewards of the recorded trials, or of those of a phase, each of shape (trials,).

        Raises:
            NotFoundError: there is no such phase.
            RunError: the log, or the table, is damaged.
        """
        if self.one_in:
            table = read_trials(self.path.with_name(TRIALS))
            rewards = table["reward"][:: self.one_in]
            numbers = np.arange(len(rewards)) * self.one_in
        else:
            found = trials(self.path)
            numbers, rewards = found["trial"].astype(np.int64), found["reward"].astype(np.float64)
        if phase is None:
            return numbers, rewards
        kept = np.isin(numbers, self.trials_in(phase))
        return numbers[kept], rewards[kept]

    def trials_in(self, phase: int) -> Numbers:
        """The numbers of the recorded trials of a phase, at least one.

        Raises:
            NotFoundError: there is none.
        """
        try:
            steps = read_steps(self.path, ["trial", "phase"])
        except UsageError:
            raise NotFoundError(f"{self.path}: --phase {phase}: has no phases") from None
        if not (steps["phase"] == phase).any():
            last = int(steps["phase"].max())
            raise NotFoundError(f"{self.path}: has no recorded trial of phase {phase}; its phases are 0 to {last}")
        return np.unique(steps["trial"][steps["phase"] == phase]).astype(np.int64)

    def nth_of(self, phase: int, nth: int) -> int:
        """The number of a trial of a phase that is counted from the phase's first one, recorded or not.

        Raises:
            NotFoundError: there is no such phase, or it has fewer trials.
        """
        recorded = self.trials_in(phase)
        begins, count = int(recorded[0]), int(recorded[-1] - recorded[0]) + 1
        with contextlib.suppress(
            LookupError, TypeError, ValueError, ArithmeticError
        ):  # of another writer, whose config may say nothing
            trials = phase_trials_of_log(self.path)
            begins, count = sum(trials[:phase]), trials[phase]
        if nth >= count:
            raise NotFoundError(f"{self.path}: --trial {nth}: phase {phase} has trials 0 to {count - 1}")
        return begins + nth


@dataclass(frozen=True)
class Logs:
    """The logs that a user's words fit, at least one: `first` of the same experiment, then `others`.

    In a `run` these are of the `cells` that are done.
    """

    first: tuple[Log, ...]
    others: tuple[Log, ...] = ()
    run: Path = Path()
    cells: tuple[Cell, ...] = ()


class Chosen(NamedTuple):
    """A trial of a log; `note` says what it was chosen from, empty where nothing else would have done."""

    log: Log
    trial: int
    note: str


def find_logs(word: str, out: Path, selection: Selection) -> Logs:
    """The logs that `word`, a run or an .mcap file, and the selection choose; without an experiment visits first.

    Raises:
        NotFoundError: no such run or file, no such cell, or the cell has no log.
        UsageError: a selection within a file.
    """
    file = Path(word)
    try:
        is_file = file.is_file()
    except (OSError, ValueError) as error:
        if isinstance(error, OSError):
            check_damage(file, error)
        raise NotFoundError(f"{printable(word)}: {reason(error)}") from None
    if is_file or file.suffix == ".mcap":
        if str(selection):
            raise UsageError(f"{printable(word)}: is one log; {selection} choose within a run")
        if not is_file:
            raise NotFoundError(f"{printable(word)}: no such file")
        return Logs((Log(file, str(file)),))
    run = find_run(word, out)
    wanted = _wanted(run, selection)
    done = _done(run, wanted)
    found = [(cell, Log(run / cell.path / STEPS, cell.path, cell.config.record.one_trial_in)) for cell in done]
    recorded = [(cell, log) for cell, log in found if log.path.is_file()]
    if not recorded:
        raise NotFoundError(
            f"{run / done[0].path}: has no log, its config records no steps; run it with record.steps=every"
        )
    experiment = recorded[0][0].experiment
    first = [log for cell, log in recorded if cell.experiment == experiment]
    others = tuple(log for cell, log in recorded if cell.experiment != experiment)
    return Logs(tuple(first), others, run, tuple(wanted))


def _wanted(run: Path, selection: Selection) -> list[Cell]:
    """The cells of the run's plan that match; without an experiment only its visits, if it has any."""
    matching = selection.of(run, plan(read_config(run)))
    visits = [cell for cell in matching if cell.settings.assembled]
    return visits if visits and not selection.experiment else matching


def _done(run: Path, cells: Sequence[Cell]) -> list[Cell]:
    done = [cell for cell in cells if read_cell(run / cell.path) is not None]
    if not done:
        damaged = [cell.path for cell in cells if (run / cell.path / STEPS).exists()]
        if damaged:
            how = f"visitlab recover {run / damaged[0] / STEPS} saves what is whole of its log"
            raise RunError(f"{run}: damaged: {few(damaged, MOST_NAMED)}; running again redoes it, {how}")
        missing = few([cell.path for cell in cells], MOST_NAMED)
        raise NotFoundError(
            f"{run}: not run yet: {missing}; finish with visitlab run {run}/config.yaml --out {run.parent}"
        )
    return done


def choose_trial(logs: Logs, word: str, phase: int | None = None) -> Chosen:
    """The trial that `word` means: a number, in the first log, or one of `SELECTORS` over all recorded trials.

    Of equals the earliest in the first log. `median` is the trial in the middle by reward; `longest-engagement` has
    the longest unbroken time in which the human is greeted, called or following. With a `phase` only its trials count,
    and a number is counted from its first one.

    Raises:
        UsageError: the word means nothing, or the task knows no engagement.
        NotFoundError: the logs hold no trial.
        RunError: a log is damaged.
    """
    log, count = logs.first[0], len(logs.first) + len(logs.others)
    if word.isdecimal():
        if len(word) > MOST_DIGITS:
            raise NotFoundError(f"{log.path}: no log has a trial of that number")
        number = int(word) if phase is None else log.nth_of(phase, int(word))
        following = (*logs.first, *logs.others)[1:2]
        note = f"chose {log.cell} of {count} cells; the next is {following[0].cell}; {CHOOSE}" if following else ""
        return Chosen(log, number, note)
    if word not in SELECTORS:
        raise UsageError(f"--trial {printable(word)}: must be a number or one of {', '.join(SELECTORS)}")
    ties = 1
    if word == LONGEST_ENGAGEMENT:
        lengths, numbers = zip(*(_longest_engaged(each.path, phase) for each in logs.first), strict=True)
        place = int(np.argmax(lengths))
        log, number = logs.first[place], numbers[place]
    else:
        log, number, ties = _by_reward(logs.first, word, phase)
    among = f" of {len(logs.first)} cells" if len(logs.first) > 1 else ""
    rest = f"; {len(logs.others)} of other experiments were not looked at; {CHOOSE}" if logs.others else ""
    equals = f", one of {ties:,} with the same reward" if ties > 1 else ""
    return Chosen(log, number, f"the {word} trial{among} is {log.cell}, trial {number}{equals}{rest}")


def _by_reward(logs: Sequence[Log], word: str, phase: int | None) -> tuple[Log, int, int]:
    """The trial in question, and how many have the same reward."""
    tables = [log.trials(phase) for log in logs]
    rewards = np.concatenate([rewards for _, rewards in tables])
    if not len(rewards):
        raise NotFoundError(f"{logs[0].path}: the log holds no trial")
    order = np.argsort(rewards, kind="stable")
    best = int(np.argmax(rewards))
    place = {BEST: best, WORST: int(order[0]), MEDIAN: int(order[(len(order) - 1) // 2])}[word]
    of_log = np.repeat(np.arange(len(logs)), [len(numbers) for numbers, _ in tables])
    numbers = np.concatenate([numbers for numbers, _ in tables])
    return logs[of_log[place]], int(numbers[place]), int(np.count_nonzero(rewards == rewards[place]))


def _longest_engaged(path: Path, phase: int | None) -> tuple[int, int]:
    """The most steps without a break, and the trial that has them."""
    steps = read_steps(path)
    if "desired_direction" not in steps:
        raise UsageError(f"--trial {LONGEST_ENGAGEMENT}: nobody is engaged in this task")
    engaged = steps["interaction_level"].astype(np.int64) >= InteractionLevel.GREETED
    if phase is not None:
        engaged &= np.isin(steps["trial"], Log(path, "").trials_in(phase))
    changes = engaged[1:] != engaged[:-1]
    starts = np.concatenate([[0], np.flatnonzero(changes | (steps["trial"][1:] != steps["trial"][:-1])) + 1])
    lengths = np.diff(np.concatenate([starts, [len(engaged)]])) * engaged[starts]
    longest = int(np.argmax(lengths))
    return int(lengths[longest]), int(steps["trial"][starts[longest]])
