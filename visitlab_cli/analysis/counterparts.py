"""Which curve of ours belongs to which published one, and ours in the published batches."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.analysis.published_curves import PublishedCurve, published_curves
from visitlab_cli.execution.cells import Cell
from visitlab_cli.results.curves import Curve, curve_of
from visitlab_cli.storage.cell_folder import read_cell

COUNTERPARTS = {
    ("fig6_navigation", "rmax"): "navigation/rmax",
    ("fig6_navigation", "epsilon_greedy_mb"): "navigation/mb",
    ("fig6_navigation", "epsilon_greedy_mf"): "navigation/mf",
    ("fig6_go_to_human", "rmax"): "go_to_human/rmax",
    ("fig6_go_to_human", "epsilon_greedy_mb"): "go_to_human/mb",
    ("fig6_go_to_human", "epsilon_greedy_mf"): "go_to_human/mf",
    ("fig6_social", "rmax"): "social/rmax/human_1",
    ("fig6_social", "epsilon_greedy_mb"): "social/mb/human_1",
    ("fig6_social", "epsilon_greedy_mf"): "social/mf/human_1",
    ("fig6_mb_mf", "mf_bootstrapped"): "social/mf_after_mb/human_1",
    ("fig6_mb_mf", "epsilon_greedy_mb"): "social/mb/human_1",
    ("fig6_mb_mf", "epsilon_greedy_mf"): "social/mf/human_1",
    ("fig8_humans", "human_1"): "social_humans/mb/human_1",
    ("fig8_humans", "human_2"): "social_humans/mb/human_2",
    ("fig8_humans", "human_3"): "social_humans/mb/human_3",
    ("fig8_adaptation", "human_1"): "visit/human_1",
    ("fig8_adaptation", "human_2"): "visit/human_2",
    ("fig8_adaptation", "human_2_pointing"): "visit/human_2_pointing",
}
"""The group of cells (experiment, agent, human as `configs/paper.yaml` names them) of each figure and condition."""


class OurCurve(NamedTuple):
    """Our curve in the published batches; `cell` is one of its cells."""

    group: str
    cell: Cell
    curve: Curve


class Absent(NamedTuple):
    """Why there is no curve of ours to compare."""

    group: str
    reason: str


def our_curve(run: Path, cells: Sequence[Cell], published: PublishedCurve) -> OurCurve | Absent:
    """The finished cells of a run that a published curve is compared with, in its batches.

    Args:
        run: the run's folder.
        cells: all cells of its plan.
        published: the curve.
    """
    group = COUNTERPARTS[published.figure, published.condition]
    planned = [cell for cell in cells if cell.group == group]
    done = [cell for cell in planned if read_cell(run / cell.path) is not None]
    if not done:
        return Absent(group, "not run yet" if planned else "not in the config")
    settings = done[0].settings
    trials = settings.n_trials
    if settings.trial_steps != published.trial_steps:
        return Absent(group, f"has trials of {settings.trial_steps} steps, not {published.trial_steps}")
    if trials < published.trials:
        return Absent(group, f"has {trials:,} trials, fewer than the {published.trials:,} published")
    return OurCurve(group, done[0], curve_of(run, done, published.edges))


def our_curves(run: Path, cells: Sequence[Cell]) -> list[tuple[PublishedCurve, OurCurve | Absent]]:
    """Each published curve with ours."""
    return [(published, our_curve(run, cells, published)) for published in published_curves()]
