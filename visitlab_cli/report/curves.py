"""The learning curves of a run: a chart for each experiment, one for visits alike, thinned to be small and readable."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.colours import Look, looks_of
from visitlab_cli.config.experiment import Experiment
from visitlab_cli.exact.values import Possible
from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.curves import curve_of
from visitlab_cli.results.groups import Group
from visitlab_cli.results.possible import possible_in
from visitlab_cli.results.varying import names_within, varying
from visitlab_cli.storage.cell_folder import read_cell

MOST_POINTS = 100
"""Of a curve."""
ALL_POINTS, FEWEST_POINTS = 40_000, 10
"""Of a page: the curves of a large grid share so many, and each may have at least so few."""
MOST_TOGETHER = 8
"""Visits as long share a chart where it has no more curves than these."""
ENOUGH_TRIALS, ENOUGH_POINTS = 10, 15
"""A point is the mean of so many trials, of fewer where a curve would have fewer points than these."""
DIGITS = 3


class Curve(NamedTuple):
    """Mean reward a trial in batches of trials, and half its 95% interval (None for one seed).

    `line` is the place of its group in the table of results, `hue` and `marker` are its agent's. `end` is where the
    last batch ends, in the chart's units; `n` counts independent seeds; `batch` are the fewest and the most trials of
    a batch.
    """

    name: str
    line: int
    hue: int
    marker: str
    end: int
    n: int
    batch: tuple[int, int]
    mean: list[float]
    half: list[float] | None


class Chart(NamedTuple):
    """Curves over `x`, trials or steps; `bounds` are the exact values where they are known.

    `phases` are where each phase ends, in the chart's units, and its name.
    """

    title: str
    x: str
    y: str
    bounds: Possible | None
    curves: list[Curve]
    phases: list[tuple[int, str]]

    @property
    def batch(self) -> str:
        """How many trials a point is the mean of: '10', '8 or 9', '2 to 10'."""
        fewest = min(curve.batch[0] for curve in self.curves)
        most = max(curve.batch[1] for curve in self.curves)
        if fewest == most:
            return str(most)
        return f"{fewest} {'or' if most == fewest + 1 else 'to'} {most}"

    def as_json(self) -> dict[str, Any]:
        """The chart as plain values."""
        bounds = self.bounds
        return {
            "title": self.title,
            "x": self.x,
            "y": self.y,
            "batch": self.batch,
            "optimum": None if bounds is None else round(bounds.optimum, DIGITS),
            "random": None if bounds is None else round(bounds.random, DIGITS),
            "curves": [curve._asdict() for curve in self.curves],
            "phases": self.phases,
        }


def charts_of(run: Path, groups: Sequence[Group]) -> list[Chart]:
    """A chart for each experiment, or visits alike, of which a cell is finished.

    Raises:
        RunError: a table of trials is damaged.
    """
    points = max(FEWEST_POINTS, min(MOST_POINTS, ALL_POINTS // max(1, len(groups))))
    varied = varying(group.point for group in groups)
    looks = looks_of(agent for group in groups for agent in group.cells[0].config.agents)
    lines = {group.path: line for line, group in enumerate(groups)}
    begun = [group for group in groups if _done(run, group)]
    charts = []
    for members in _together(begun):
        curves = [
            _curve(run, _done(run, group), (name, lines[group.path]), looks[group.agent], points)
            for name, group in zip(names_within(members, varied), members, strict=True)
        ]
        charts.append(_chart(members, curves))
    return charts


def _together(groups: Sequence[Group]) -> list[list[Group]]:
    """The groups of each chart: of an experiment, or of visits as long, if these are few."""
    experiments: dict[str, list[Group]] = {}
    for group in groups:
        experiments.setdefault(group.experiment, []).append(group)
    alike: dict[object, list[list[Group]]] = {}
    for name, members in experiments.items():
        lengths = frozenset((each.n_trials, each.trial_steps, each.phases) for each in _visits(members))
        alike.setdefault(lengths or name, []).append(members)
    charts: list[list[Group]] = []
    for several in alike.values():
        as_one = [group for members in several for group in members]
        charts += [as_one] if len(as_one) <= MOST_TOGETHER else several
    return charts


def _visits(groups: Sequence[Group]) -> list[Experiment]:
    return [settings for group in groups if (settings := group.cells[0].settings).assembled]


def bounds_of(groups: Sequence[Group]) -> Possible | None:
    """The exact values that all groups of an experiment share."""
    cells = [group.cells[0] for group in groups]
    humans = {cell.config.humans[name] for cell in cells for name in cell.humans}
    found = {possible_in(cell) for cell in cells} if len(humans) <= 1 else set()  # a grid of humans would take long
    return found.pop() if len(found) == 1 else None


def _chart(groups: Sequence[Group], curves: list[Curve]) -> Chart:
    title = ", ".join(dict.fromkeys(group.experiment for group in groups))
    settings = groups[0].cells[0].settings
    alike = all(group.cells[0].settings.phases == settings.phases for group in groups)
    phases = _phases(settings) if alike else []
    return Chart(title, settings.counted_in, groups[0].measure, bounds_of(groups), curves, phases)


def _phases(settings: Experiment) -> list[tuple[int, str]]:
    unit = 1 if settings.counted_in == "trials" else settings.trial_steps
    ends = (int(end) * unit for end in np.cumsum(settings.phase_trials))
    new = settings.changes_of_place
    told = (", ".join(filter(None, (phase.met, place))) for phase, place in zip(settings.phases, new, strict=True))
    names = (": ".join(filter(None, (str(number), words))) for number, words in enumerate(told))
    return list(zip(ends, names, strict=True))


def _done(run: Path, group: Group) -> list[Cell]:
    return [cell for cell in group.cells if read_cell(run / cell.path) is not None]


def _curve(run: Path, cells: Sequence[Cell], named: tuple[str, int], look: Look, points: int) -> Curve:
    found = curve_of(run, cells, batch_edges(cells[0].trials, points, math.gcd(*cells[0].settings.phase_trials)))
    mean = [round(float(value), DIGITS) for value in found.mean]
    half = [round(float(value), DIGITS) for value in found.half] if found.counted.n > 1 else None
    sizes = np.diff(found.edges)
    end = int(found.edges[-1]) * found.trial
    return Curve(*named, look.hue, look.marker, end, found.counted.n, (int(sizes.min()), int(sizes.max())), mean, half)


def batch_edges(trials: int, most: int, phase: int = 0) -> npt.NDArray[np.int64]:
    """Where batches of trials begin and where the last one ends: equal ones if any are, else one trial apart.

    Args:
        trials: at least 1.
        most: batches.
        phase: the trials of each phase are a multiple of it, and no batch should lie in two of them; 0 without.
    """
    size = max(-(-trials // most), min(ENOUGH_TRIALS, trials // ENOUGH_POINTS), 1)
    for whole in (phase or trials, trials):
        size = next((larger for larger in range(size, 2 * size) if whole % larger == 0), size)
    return np.linspace(0, trials, max(1, trials // size) + 1).round().astype(np.int64)
