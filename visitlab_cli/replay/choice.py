"""What a user's words choose: the log of a run's cell, and the trial in it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from visitlab_cli.config.problems import or_else, printable
from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.execution.cells import Cell, plan
from visitlab_cli.recording.reader import read_steps, trials
from visitlab_cli.storage.cell_folder import STEPS, read_cell, reason
from visitlab_cli.storage.run_folder import find_run, read_config
from visitlab_cli.world.columns import VISIT
from visitlab_cli.world.enums import InteractionLevel

BEST, WORST, MEDIAN, LONGEST_ENGAGEMENT = SELECTORS = ("best", "worst", "median", "longest-engagement")
MOST_NAMED = 3
MOST_DIGITS = 9


@dataclass(frozen=True)
class Selection:
    """What is wanted of a run; empty or None is anything, visits first."""

    experiment: str = ""
    human: str = ""
    agent: str = ""
    seed: int | None = None

    def matches(self, cell: Cell) -> bool:
        """Whether a cell is of the wanted kind."""
        return (
            self.experiment in ("", cell.experiment)
            and self.human in ("", cell.human)
            and self.agent in ("", cell.agent)
            and self.seed in (None, cell.seed)
        )

    def __str__(self) -> str:
        wanted = {"experiment": self.experiment, "human": self.human, "agent": self.agent, "seed": self.seed}
        return " ".join(f"--{name} {value}" for name, value in wanted.items() if value not in ("", None))


@dataclass(frozen=True)
class Log:
    """The log that was chosen, and the paths of the cells that would have done as well."""

    path: Path
    cell: str
    others: tuple[str, ...] = ()


def find_log(word: str, out: Path, selection: Selection) -> Log:
    """The log that `word`, a run or an .mcap file, and the selection choose: of several the first.

    Raises:
        NotFoundError: no such run or file, no such cell, or the cell has no log.
        UsageError: a selection within a file.
    """
    file = Path(word)
    try:
        is_file = file.is_file()
    except (OSError, ValueError) as error:
        raise NotFoundError(f"{printable(word)}: {reason(error)}") from None
    if is_file or file.suffix == ".mcap":
        if str(selection):
            raise UsageError(f"{printable(word)}: is one log; {selection} choose within a run")
        if not is_file:
            raise NotFoundError(f"{printable(word)}: no such file")
        return Log(file, str(file))
    run = find_run(word, out)
    chosen, *others = _done(run, _wanted(run, selection))
    log = run / chosen.path / STEPS
    if not log.is_file():
        raise NotFoundError(
            f"{run / chosen.path}: has no log, its config records no steps; run it with record.steps=every"
        )
    return Log(log, chosen.path, tuple(cell.path for cell in others))


def _wanted(run: Path, selection: Selection) -> list[Cell]:
    """The cells of the run's plan that match; without an experiment only its visits, if it has any."""
    cells = plan(read_config(run))
    matching = [cell for cell in cells if selection.matches(cell)]
    if not matching:
        for name in ("experiment", "human", "agent"):
            value, known = getattr(selection, name), sorted({getattr(cell, name) for cell in cells} - {""})
            if value and value not in known:
                raise NotFoundError(f"{run}: no {name} {value}{or_else(value, known)}")
        raise NotFoundError(f"{run}: no cell with {selection}; there are {_named([cell.path for cell in cells])}")
    visits = [cell for cell in matching if cell.task == VISIT]
    return visits if visits and not selection.experiment else matching


def _done(run: Path, cells: Sequence[Cell]) -> list[Cell]:
    done = [cell for cell in cells if read_cell(run / cell.path) is not None]
    if not done:
        damaged = [cell.path for cell in cells if (run / cell.path / STEPS).exists()]
        if damaged:
            how = f"visitlab recover {run / damaged[0] / STEPS} saves what is whole of its log"
            raise RunError(f"{run}: damaged: {_named(damaged)}; running again redoes it, {how}")
        missing = _named([cell.path for cell in cells])
        raise NotFoundError(
            f"{run}: not run yet: {missing}; finish with visitlab run {run}/config.yaml --out {run.parent}"
        )
    return done


def _named(paths: Sequence[str]) -> str:
    more = f" and {len(paths) - MOST_NAMED} more" if len(paths) > MOST_NAMED else ""
    return ", ".join(paths[:MOST_NAMED]) + more


def choose_trial(path: Path, word: str) -> int:
    """The number of the trial that `word` means: itself, or one of `SELECTORS` over the recorded trials.

    Of equals the earliest. `median` is the trial in the middle by reward; `longest-engagement` has the longest
    unbroken time in which the human is greeted, called or following.

    Raises:
        UsageError: the word means nothing, or the task knows no engagement.
        NotFoundError: the log holds no trial.
        RunError: the log is damaged.
    """
    if word.isdecimal():
        if len(word) > MOST_DIGITS:
            raise NotFoundError(f"{path}: no log has a trial of that number")
        return int(word)
    if word not in SELECTORS:
        raise UsageError(f"--trial {printable(word)}: must be a number or one of {', '.join(SELECTORS)}")
    table = trials(path)
    numbers = table["trial"]
    if not len(numbers):
        raise NotFoundError(f"{path}: the log holds no trial")
    if word == LONGEST_ENGAGEMENT:
        return _longest_engaged(path)
    order = np.argsort(table["reward"], kind="stable")
    if word == BEST:
        return int(numbers[np.argmax(table["reward"])])
    return int(numbers[order[0] if word == WORST else order[(len(order) - 1) // 2]])


def _longest_engaged(path: Path) -> int:
    steps = read_steps(path)
    if "desired_direction" not in steps:
        raise UsageError(f"--trial {LONGEST_ENGAGEMENT}: nobody is engaged in this task")
    engaged = steps["interaction_level"].astype(np.int64) >= InteractionLevel.GREETED
    changes = engaged[1:] != engaged[:-1]
    starts = np.concatenate([[0], np.flatnonzero(changes | (steps["trial"][1:] != steps["trial"][:-1])) + 1])
    lengths = np.diff(np.concatenate([starts, [len(engaged)]])) * engaged[starts]
    return int(steps["trial"][starts[np.argmax(lengths)]])
