"""The learning curves of a run: a chart for each experiment with a curve for each group, thinned to be small."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.analysis.exact_values import Possible, possible
from visitlab_cli.analysis.summary_estimate import mean_of
from visitlab_cli.analysis.summary_groups import Group, unit_of
from visitlab_cli.execution.cells import Cell
from visitlab_cli.storage.arrays import read_trials
from visitlab_cli.storage.cell_folder import TRIALS, read_cell
from visitlab_cli.world.columns import VISIT

MOST_POINTS = 200
"""Of a curve."""
ALL_POINTS, FEWEST_POINTS = 40_000, 10
"""Of a page: the curves of a large grid share so many, and each has at least so few."""
DIGITS = 3


class Curve(NamedTuple):
    """Mean reward a trial in equal batches of trials, and half its 95% interval (None for one seed).

    `end` is where the last batch ends, in the chart's units; `n` counts independent seeds.
    """

    name: str
    end: int
    n: int
    mean: list[float]
    half: list[float] | None


class Chart(NamedTuple):
    """The curves of an experiment over `x`, trials or steps; `bounds` are the exact values where they are known."""

    title: str
    x: str
    y: str
    bounds: Possible | None
    curves: list[Curve]

    def as_json(self) -> dict[str, Any]:
        """The chart as plain values."""
        bounds = self.bounds
        return {
            "title": self.title,
            "x": self.x,
            "y": self.y,
            "optimum": None if bounds is None else round(bounds.optimum, DIGITS),
            "random": None if bounds is None else round(bounds.random, DIGITS),
            "curves": [curve._asdict() for curve in self.curves],
        }


def charts_of(run: Path, groups: Sequence[Group]) -> list[Chart]:
    """A chart for each experiment that has a finished cell.

    Raises:
        RunError: a table of trials is damaged.
    """
    points = max(FEWEST_POINTS, min(MOST_POINTS, ALL_POINTS // max(1, len(groups))))
    by_experiment: dict[str, list[Group]] = {}
    for group in groups:
        by_experiment.setdefault(group.experiment, []).append(group)
    charts = [_chart(run, name, members, points) for name, members in by_experiment.items()]
    return [chart for chart in charts if chart.curves]


def names_within(groups: Sequence[Group]) -> list[str]:
    """What tells the groups of an experiment apart: agent, human or point of the grid, as far as they differ."""
    parts = [
        [group.agent, group.human, ", ".join(f"{path}={value}" for path, value in group.point)] for group in groups
    ]
    differs = [len({part[place] for part in parts}) > 1 for place in range(3)]
    return [
        " · ".join(word for word, wanted in zip(part, differs, strict=True) if word and wanted)
        or " · ".join(filter(None, part))
        for part in parts
    ]


def bounds_of(groups: Sequence[Group]) -> Possible | None:
    """The exact values that all groups of an experiment share."""
    settings = {(group.cells[0].settings, group.cells[0].config.interaction.distances) for group in groups}
    found = {possible(*each) for each in settings}
    return found.pop() if len(found) == 1 else None


def _chart(run: Path, title: str, groups: Sequence[Group], points: int) -> Chart:
    visit = groups[0].cells[0].task == VISIT
    curves = []
    for name, group in zip(names_within(groups), groups, strict=True):
        done = [cell for cell in group.cells if read_cell(run / cell.path) is not None]
        if done:
            curves.append(_curve(run, name, done, points, visit))
    return Chart(title, "trials" if visit else "steps", groups[0].measure, bounds_of(groups), curves)


def _curve(run: Path, name: str, cells: Sequence[Cell], points: int, visit: bool) -> Curve:
    of_unit: dict[str, list[npt.NDArray[np.float64]]] = {}
    trials = 0
    for cell in cells:
        rewards = read_trials(run / cell.path / TRIALS)["reward"]
        trials = len(rewards)
        of_unit.setdefault(unit_of(cell), []).append(in_batches(rewards, points))
    samples = np.array([np.mean(batches, axis=0) for batches in of_unit.values()])
    estimates = [mean_of(column.tolist()) for column in samples.T]
    half = [round(each.half, DIGITS) for each in estimates] if len(samples) > 1 else None
    end = trials if visit else trials * cells[0].settings.trial_steps
    return Curve(name, end, len(samples), [round(each.mean, DIGITS) for each in estimates], half)


def in_batches(rewards: npt.NDArray[np.float64], points: int) -> npt.NDArray[np.float64]:
    """The means of `points` equal parts of the trials, of all trials where these are fewer."""
    edges = np.linspace(0, len(rewards), min(points, len(rewards)) + 1).round().astype(int)
    means: npt.NDArray[np.float64] = np.add.reduceat(rewards, edges[:-1]) / np.diff(edges)
    return means
