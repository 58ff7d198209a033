"""Which curve of ours belongs to which published one, and ours in the published batches."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.paper.published.as_published import essence, in_words, paper_cells, unlike
from visitlab_cli.paper.published.curves import PublishedCurve, published_curves
from visitlab_cli.plan.cells import Cell
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

Condition = tuple[str, str]
"""A published figure and a condition of it."""

NOT_PLANNED = "not in the config"


class Counterpart(NamedTuple):
    """What a run has for a published curve: a group of cells, one of them, and what of it is not as published.

    Where anything is not, the published curve is no measure of it. `points` counts the points of a grid that the
    group was chosen from as the nearest; 1 where one is as published, or there is no grid.
    """

    group: str
    cell: Cell
    unlike: list[str]
    points: int = 1

    @property
    def reason(self) -> str:
        """What is not as published, in a line; empty where all of it is."""
        if self.points > 1:
            return f"no point of the grid is as published; the nearest has {in_words(self.unlike)}"
        return in_words(self.unlike)


def counterparts(cells: Sequence[Cell]) -> dict[Condition, Counterpart]:
    """What a run with these cells has for each published curve; without those for which it has nothing.

    Of the experiment of the same name that is the group as published, whatever its agent and human are called and
    wherever in a grid it lies; else that of the same agent and human.
    """
    groups: dict[str, dict[str, Cell]] = {}
    for cell in cells:
        groups.setdefault(cell.experiment, {}).setdefault(cell.group, cell)
    essences = {group: essence(cell) for members in groups.values() for group, cell in members.items()}
    found: dict[Condition, Counterpart] = {}
    for key, name in COUNTERPARTS.items():
        paper = paper_cells()[name]
        members = groups.get(paper.experiment, {})
        if alike := [cell for group, cell in members.items() if essences[group] == essence(paper)]:
            best = max(alike, key=lambda cell: (_called(cell) == _called(paper), -abs(cell.steps - paper.steps)))
            found[key] = Counterpart(best.group, best, [])
    for key, name in COUNTERPARTS.items():
        paper = paper_cells()[name]
        taken = {each.group for (figure, _), each in found.items() if figure == key[0]}
        others = [cell for group, cell in groups.get(paper.experiment, {}).items() if group not in taken]
        named = [cell for cell in others if _called(cell) == _called(paper)]
        if key not in found and named:
            nearest = min(named, key=lambda cell: len(unlike(cell, paper)))
            found[key] = Counterpart(nearest.group, nearest, unlike(nearest, paper), len(named))
    return found


def _called(cell: Cell) -> tuple[str, str]:
    return cell.agent, cell.human


class OurCurve(NamedTuple):
    """Our curve in the published batches; `cell` is one of its cells."""

    group: str
    cell: Cell
    curve: Curve


class Absent(NamedTuple):
    """Why there is no curve of ours to compare; `unlike` where there is one, but it is not as published."""

    group: str
    reason: str
    unlike: bool = False

    @property
    def is_planned(self) -> bool:
        """Whether the config has the group at all."""
        return self.reason != NOT_PLANNED


def curve_of_group(run: Path, cells: Sequence[Cell], group: str, published: PublishedCurve) -> OurCurve | Absent:
    """The finished cells of a group, whatever is set in them, in the batches of a published curve.

    Args:
        run: the run's folder.
        cells: all cells of its plan.
        group: the group's path.
        published: the curve.
    """
    planned = [cell for cell in cells if cell.group == group]
    done = [cell for cell in planned if read_cell(run / cell.path) is not None]
    if not done:
        return Absent(group, "not run yet" if planned else NOT_PLANNED)
    if done[0].settings.trial_steps != published.trial_steps:
        return Absent(group, f"has trials of {done[0].settings.trial_steps} steps, not {published.trial_steps}")
    if done[0].trials < published.trials:
        return Absent(group, f"has {done[0].trials:,} trials, fewer than the {published.trials:,} published")
    return OurCurve(group, done[0], curve_of(run, done, published.edges))


def our_curves(run: Path, cells: Sequence[Cell]) -> list[tuple[PublishedCurve, OurCurve | Absent]]:
    """Each published curve with ours, where that is as published."""
    found = counterparts(cells)
    return [(each, _ours(run, cells, each, found.get((each.figure, each.condition)))) for each in published_curves()]


def _ours(run: Path, cells: Sequence[Cell], published: PublishedCurve, found: Counterpart | None) -> OurCurve | Absent:
    if found is None:
        return Absent(COUNTERPARTS[published.figure, published.condition], NOT_PLANNED)
    if found.unlike:
        return Absent(found.group, f"not as published: {found.reason}", unlike=True)
    return curve_of_group(run, cells, found.group, published)
