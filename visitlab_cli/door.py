"""The door for Python: a run's trials, steps and models as arrays, and as data frames where pandas is installed."""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from visitlab_cli.config.canonical import canonical
from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.log.reader import Columns, read_steps, read_trial
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.plan.evaluation import Evaluation
from visitlab_cli.plan.saved import model_of as model_in
from visitlab_cli.plan.saved import trials_of as trials_in
from visitlab_cli.results.evaluated import evaluated
from visitlab_cli.results.export import results_table
from visitlab_cli.results.groups import point_of
from visitlab_cli.results.metrics import group_metrics
from visitlab_cli.results.phases import FIRST, phase_results
from visitlab_cli.results.summary import summaries
from visitlab_cli.results.tables import Reader, model_of, stacked, steps_of, trials_of
from visitlab_cli.storage.arrays import Arrays
from visitlab_cli.storage.cell_folder import STEPS, read_cell
from visitlab_cli.storage.made_by import sources_of
from visitlab_cli.storage.run_folder import find_run, read_config, read_versions
from visitlab_cli.whole_number import whole_number
from visitlab_cli.wording import or_else


@dataclass(frozen=True)
class LoadedCell:
    """A finished cell of a run; what it holds is read when it is asked for, as numpy arrays by name.

    `facts` is what its `cell.json` says, `point` the values of a grid at which it lies, by their paths.
    """

    folder: Path
    path: str
    experiment: str
    agent: str
    human: str
    point: dict[str, str]
    seed: int
    facts: dict[str, Any] = field(repr=False)
    _run: Path = field(repr=False)
    _planned: Cell = field(repr=False)

    @property
    def sources(self) -> str:
        """The hash of the code that made the cell; 'unknown' for one of before cells said it."""
        return sources_of(self.facts)

    @property
    def trials(self) -> Arrays:
        """`trial`, `reward`, in a visit `goals`, with phases `phase`, each of shape (trials,)."""
        return trials_in(self._run, self._planned)

    @property
    def model(self) -> Arrays:
        """What the agent learned: `q` of shape (states, actions), and the other arrays of `model.npz`."""
        return model_in(self._run, self._planned)

    def steps(self, columns: Sequence[str] | None = None) -> Columns:
        """The recorded steps: the log's columns, or the one or those asked for, of shape (steps,), enums as numbers."""
        return read_steps(self.folder / STEPS, columns)

    def trial(self, number: int, columns: Sequence[str] | None = None) -> Columns:
        """As `steps`, of one trial, from its step 0, the state that it starts in.

        Raises:
            UsageError: `number` is none.
            NotFoundError: the trial is not recorded.
        """
        whole = whole_number(number)
        if whole is None:
            raise UsageError(f"trial {number!r}: must be a number")
        return read_trial(self.folder / STEPS, whole, columns)


@dataclass(frozen=True)
class LoadedRun:
    """A run: its config as plain values, its versions, its finished cells, its cells' content as data frames.

    `select` and each method that makes a data frame choose cells by `experiment`, `agent`, `human`, `seed`.
    A frame's first columns say which cell a row is of: these four, and the settings that vary. `evaluations` are
    what `visitlab eval` played with options of its own, each as a run, by the words that `visitlab runs show` has
    for it ("frozen, 500 trials"); where humans were chosen, these follow ("frozen: human_1").
    """

    path: Path
    config: dict[str, Any] = field(repr=False)
    versions: dict[str, str] = field(repr=False)
    cells: list[LoadedCell] = field(repr=False)
    evaluations: dict[str, "LoadedRun"] = field(repr=False)
    _plan: list[Cell] = field(repr=False)

    def select(self, **wanted: str | int) -> list[LoadedCell]:
        """The finished cells of this `experiment`, `agent`, `human`, `seed`, as far as they are given.

        Raises:
            UsageError: of another keyword.
            NotFoundError: there is none.
        """
        for name in wanted:
            if name not in KEYS:
                raise UsageError(f"select: no {name!r}{or_else(name, KEYS)}")
        found = [cell for cell in self.cells if all(getattr(cell, name) == value for name, value in wanted.items())]
        if not found:
            words = " ".join(f"{name}={value}" for name, value in wanted.items())
            raise NotFoundError(f"{self.path}: no finished cell {f'with {words}' if words else 'at all'}")
        return found

    def results(self) -> Any:
        """A data frame with a row for each experiment, agent, human and point: what `visitlab runs show` shows."""
        _pandas()
        return results_table(summaries(self.path, self._plan)).to_pandas()

    def trials(self, **wanted: str | int) -> Any:
        """A data frame with a row a trial: `trial`, `reward`, in visits `goals`, with phases `phase`."""
        return self._frame(trials_of, wanted)

    def steps(self, columns: Sequence[str] | None = None, **wanted: str | int) -> Any:
        """A data frame with a row a recorded step: the log's columns, or those asked for; enums by their names."""
        return self._frame(partial(steps_of, columns=columns), wanted)

    def models(self, **wanted: str | int) -> Any:
        """A data frame with a row a state and action: `state`, `action`, `q`, `visits`, `reward_sums`."""
        return self._frame(model_of, wanted)

    def phases(self, first: int = FIRST, **wanted: str | int) -> Any:
        """A data frame with a row for each group and phase: what `visitlab compare --by phase` shows.

        `first`, from 1, is how many trials of a phase are its first ones.

        Raises:
            UsageError: `first` is no such number, or there is another keyword.
            NotFoundError: there is no such cell.
        """
        chosen = {cell.path for cell in self.select(**wanted)}
        found = phase_results(self.path, [cell for cell in self._plan if cell.path in chosen], first)
        return _pandas().DataFrame([each.as_row() for each in found])

    def metrics(self, first: int = FIRST, **wanted: str | int) -> Any:
        """A data frame with a row for each group and metric: what `visitlab metrics` shows (docs/metrics.md).

        Where there are phases, a row for the `first` trials of each and one for the rest; of a `human` those with it.

        Raises:
            UsageError, NotFoundError: as `phases`.
        """
        human = str(wanted.pop("human", ""))
        chosen = {cell.path for cell in self.select(**wanted)}
        groups = group_metrics(self.path, [cell for cell in self._plan if cell.path in chosen], first, human)
        rows = [row for each in groups for row in each.as_rows()]
        for row in rows:
            row["low"], row["high"] = row.pop("interval") or (None, None)
            row.update(row.pop("point"))
        return _pandas().DataFrame(rows)

    def _frame(self, read: Reader, wanted: dict[str, str | int]) -> Any:
        _pandas()
        chosen = {cell.path for cell in self.select(**wanted)}
        return stacked(self.path, [cell for cell in self._plan if cell.path in chosen], read).to_pandas()


KEYS = ("experiment", "agent", "human", "seed")


def load(run: str | Path, out: str | Path = "runs") -> LoadedRun:
    """Open a run.

    Args:
        run: its folder, its name in `out`, a unique beginning of it, or 'latest'.
        out: the folder of all runs.

    Raises:
        NotFoundError: there is none.
        UsageError: several begin so.
        RunError: its config is damaged.
    """
    folder = find_run(str(run), Path(out))
    config = read_config(folder)
    settings, versions = canonical(config), read_versions(folder)

    def opened(cells: list[Cell], evaluations: dict[str, LoadedRun]) -> LoadedRun:
        done = [_loaded(folder, cell, facts) for cell in cells if (facts := read_cell(folder / cell.path)) is not None]
        return LoadedRun(folder, settings, versions, done, evaluations, cells)

    played = {_name(options): opened(cells, {}) for options, cells in evaluated(folder, config).items()}
    return opened(plan(config), played)


def _name(evaluation: Evaluation) -> str:
    return ": ".join(filter(None, (evaluation.words, ", ".join(evaluation.humans))))


def _loaded(run: Path, cell: Cell, facts: dict[str, Any]) -> LoadedCell:
    names = cell.experiment, cell.agent, cell.human
    return LoadedCell(run / cell.path, cell.path, *names, dict(point_of(cell)), cell.seed, facts, run, cell)


def _pandas() -> Any:
    try:
        return importlib.import_module("pandas")
    except ImportError as error:
        raise UsageError("data frames need pandas: pip install pandas; a cell's arrays do without") from error
