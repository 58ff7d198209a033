"""What came of each phase: its first trials, the rest, against the phase before, and against the first meeting."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import trials_of
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import Group, groups_of
from visitlab_cli.results.trained import trained_with
from visitlab_cli.results.units import Units, by_unit
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.whole_number import whole_number
from visitlab_cli.wording import shown

Floats = npt.NDArray[np.float64]

FIRST = 20
"""So many trials of a phase are its first ones, unless said."""


class PhaseResult(NamedTuple):
    """A phase of a group: means over independent units of the reward a trial.

    `place` says in words what of its lab and doors is another than in the phase before. `begins` is the number of its
    first trial, `trials` how many it has. `first` is of its first trials, `rest` of the others (None where there are
    none). `change` is the first trials less the rest of the phase before, or all of it where it has no rest.
    `met_before` is the phase in which its human was first met, and `again` the first trials of this one less as many
    of that: what was kept of an old friend. Differences are of the same robots, so paired.
    """

    group: Group
    phase: int
    human: str
    place: str
    begins: int
    trials: int
    first: Estimate
    rest: Estimate | None
    change: Estimate | None
    met_before: int | None
    again: Estimate | None
    units: Units

    def as_json(self) -> dict[str, Any]:
        """The phase as plain values; what it does not have is null."""
        told = {name: getattr(self, name) for name in ("first", "rest", "change", "again")}
        return {
            "experiment": self.group.experiment,
            "agent": self.group.agent,
            "point": dict(self.group.point),
            "phase": self.phase,
            "human": self.human or None,
            **({"place": self.place} if self.place else {}),
            "first_trial": self.begins,
            "trials": self.trials,
            "measure": self.group.measure,
            "n": self.units.n,
            "n_of": self.units.of,
            "met_before": self.met_before,
            **{name: None if value is None else value.as_json() for name, value in told.items()},
        }

    def as_row(self) -> dict[str, Any]:
        """The phase as one level of plain values: of each estimate the mean, `_low` and `_high`."""
        told = self.as_json()
        for name in ("first", "rest", "change", "again"):
            estimate = told.pop(name) or {"mean": None, "interval": None}
            low, high = estimate["interval"] or (None, None)
            told |= {name: estimate["mean"], f"{name}_low": low, f"{name}_high": high}
        return {**told.pop("point"), **told}


def checked_first(first: Any) -> int:
    """How many trials of a phase are its first ones, as an int.

    Raises:
        UsageError: it is no whole number from 1.
    """
    number = whole_number(first)
    if number is None or number < 1:
        raise UsageError(f"first={shown(first)}: must be a whole number, at least 1")
    return number


def phase_results(run: Path, cells: Sequence[Cell], first: int = FIRST) -> list[PhaseResult]:
    """Each phase of each group of a run's finished cells that has phases; an empty list where none has.

    Args:
        run: the run's folder.
        cells: its plan.
        first: how many trials are a phase's first ones, fewer where it has no more.

    Raises:
        UsageError: `first` is no such number.
        RunError: a table of trials is damaged.
    """
    first = checked_first(first)
    done = [cell for cell in cells if cell.settings.phases and read_cell(run / cell.path) is not None]
    return [result for group in groups_of(done) for result in _of_group(run, group, first)]


class Meetings(NamedTuple):
    """Reward a trial of each independent unit with humans who are new, and who come again: arrays of shape (units,).

    `first` is of a phase's first trials, `rest` of the others, each the mean over such phases; empty where there are
    none. The first phase is neither, nor is one whose human stood there before. Of the `new` humans so many are
    `known`: the robot was trained with them.
    """

    first_new: Floats
    rest_new: Floats
    first_again: Floats
    rest_again: Floats
    met_again: bool
    new: int
    known: int


def meetings(run: Path, cells: Sequence[Cell], first: int = FIRST) -> Meetings | None:
    """What came of the meetings of finished cells that differ in nothing but their seeds; None without humans.

    Raises:
        RunError: a table of trials is damaged.
    """
    humans = [phase.met for phase in cells[0].settings.phases]
    places = range(1, len(humans))
    new = [place for place in places if humans[place] not in humans[:place]]
    again = [place for place in places if humans[place] in humans[:place] and humans[place] != humans[place - 1]]
    if not any(humans):
        return None
    known = trained_with(cells[0])
    by_phase, begin, rest = _by_phase(run, cells), slice(first), slice(first, None)
    return Meetings(
        first_new=_mean_in(by_phase, new, begin),
        rest_new=_mean_in(by_phase, new, rest),
        first_again=_mean_in(by_phase, again, begin),
        rest_again=_mean_in(by_phase, again, rest),
        met_again=bool(again),
        new=len(new),
        known=sum(humans[place] in known for place in new),
    )


def _mean_in(by_phase: Sequence[Sequence[Floats]], phases: Sequence[int], part: slice) -> Floats:
    """The mean of each unit over those phases that have such trials."""
    found = [[unit[phase][part].mean() for phase in phases if len(unit[phase][part])] for unit in by_phase]
    return np.array([np.mean(values) for values in found if values])


def _by_phase(run: Path, cells: Sequence[Cell]) -> list[list[Floats]]:
    """The trials of each independent unit in each phase, the mean over its cells."""
    ends = np.cumsum(cells[0].settings.phase_trials)
    units = by_unit(cells)
    rewards = [np.mean([trials_of(run, cell)["reward"] for cell in members], axis=0) for members in units.values()]
    return [np.split(of_unit, ends[:-1]) for of_unit in rewards]


def check_any(run: Path, cells: Sequence[Cell], found: Sequence[PhaseResult]) -> None:
    """Refuse where nothing was found.

    Raises:
        NotFoundError: with the reason.
    """
    if not found:
        what = "no finished cell with phases" if any(cell.settings.phases for cell in cells) else "no phases"
        raise NotFoundError(f"{run}: has {what}; an experiment gets them by phases: [{{trials: 200, human: ...}}, ...]")


def _of_group(run: Path, group: Group, first: int) -> list[PhaseResult]:
    settings = group.cells[0].settings
    lengths = settings.phase_trials
    ends = np.cumsum(lengths)
    units = by_unit(group.cells)
    parts = _by_phase(run, group.cells)
    met: dict[str, int] = {}
    places = settings.changes_of_place
    found = []
    for number, phase in enumerate(settings.phases):
        own = [each[number] for each in parts]
        before = None if number == 0 else [_settled(each[number - 1], first) for each in parts]
        earlier = met.get(phase.met) if phase.met else None
        shared = min(first, lengths[number], lengths[number if earlier is None else earlier])
        found.append(
            PhaseResult(
                group,
                number,
                phase.met,
                places[number],
                int(ends[number] - lengths[number]),
                lengths[number],
                mean_of([float(each[:first].mean()) for each in own]),
                mean_of([float(each[first:].mean()) for each in own]) if lengths[number] > first else None,
                None if before is None else _differences([each[:first].mean() for each in own], before),
                earlier,
                None
                if earlier is None
                else _differences(
                    [each[number][:shared].mean() for each in parts], [each[earlier][:shared].mean() for each in parts]
                ),
                Units(len(units), len(group.cells)),
            )
        )
        if phase.met:
            met.setdefault(phase.met, number)
    return found


def _settled(rewards: npt.NDArray[np.float64], first: int) -> np.float64:
    rest = rewards[first:] if len(rewards) > first else rewards
    return np.float64(rest.mean())


def _differences(now: Sequence[np.float64], then: Sequence[np.float64]) -> Estimate:
    return mean_of([float(a - b) for a, b in zip(now, then, strict=True)])
