"""The figure of doors: how navigation recovers when one closes, from those starts that it affects."""

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from visitlab_cli.colours import looks_of
from visitlab_cli.config.experiment import Experiment
from visitlab_cli.exact.closing import affected_starts, reward_from
from visitlab_cli.exact.navigation import navigation_optimal_q
from visitlab_cli.log.reader import check_values, read_steps
from visitlab_cli.paper.figures.source import Floats, Group, Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.style import FONT_SIZE, GREY, PAGE, SMALL
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import values_of
from visitlab_cli.results.estimates import half_width
from visitlab_cli.storage.cell_folder import STEPS
from visitlab_cli.world.lab import Lab, starts_of
from visitlab_cli.world.tasks import NAVIGATION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

EDGES = (0, 50, 100, 200, 350, 500, 750, 1000)
"""Trials after the closure, between which rewards are averaged, as far as there are so many."""
PANEL_HEIGHT = 2.6  # inches
NOTE = "starts from which less can be reached than before; shades: 95% interval of the mean (Student's t)"


class Closing(NamedTuple):
    """The first phase of an experiment that takes place in another lab than the one before."""

    number: int
    before: Lab
    after: Lab


def draw_doors(source: Source) -> Drawing:
    """A panel for each training of navigation in which a phase's lab is another than the one before."""
    panels: dict[str, list[Group]] = {}
    for group in source.groups.values():
        if group.cells[0].task == NAVIGATION and closing_of(group.cells[0].settings):
            panels.setdefault(group.cells[0].experiment, []).append(group)
    missing = [
        f"without {group.name}: it records no steps"
        for groups in panels.values()
        for group in groups
        if not _logged(group)
    ]
    logged = {name: [group for group in groups if _logged(group)] for name, groups in panels.items()}
    drawn = {name: groups for name, groups in logged.items() if groups}
    return Drawing(_figure(source, drawn) if drawn else None, missing)


def closing_of(settings: Experiment) -> Closing | None:
    """Where doors are shut or opened for good in it."""
    labs = settings.labs
    for number in range(1, len(labs)):
        before, after = labs[number - 1 : number + 1]
        if before is not after and (before.reach != after.reach).any():
            return Closing(number, before, after)
    return None


def _logged(group: Group) -> bool:
    return all((group.run / cell.path / STEPS).is_file() for cell in group.cells)


def rewards_after(group: Group, cell: Cell) -> tuple[Floats, Floats]:
    """Of each recorded trial from an affected start after the closure, its number from there on and its reward."""
    closing, settings = closing_of(cell.settings), cell.settings
    assert closing is not None
    file = group.run / cell.path / STEPS
    steps = read_steps(file, ["trial", "step", "reward", "robot_row", "robot_col", "goal_room", "phase"])
    check_values(file, steps, cell.task, closing.after)
    begins = np.flatnonzero(steps["step"] == 0)
    rewards = np.add.reduceat(steps["reward"].astype(np.float64), begins)
    first = {name: column[begins].astype(np.int64) for name, column in steps.items()}
    cells = first["robot_row"] * closing.after.cols + first["robot_col"]
    affected = affected_starts(closing.before, closing.after, settings.trial_steps)[cells, first["goal_room"]]
    chosen = affected & (first["phase"] == closing.number)
    return (first["trial"] - sum(settings.phase_trials[: closing.number]))[chosen], rewards[chosen]


def recovery(group: Group, edges: Sequence[int]) -> Floats:
    """The mean reward from affected starts between trials after the closure: shape (cells, batches), nan for none."""
    found = np.full((len(group.cells), len(edges) - 1), np.nan)
    for row, cell in enumerate(group.cells):
        trials, rewards = rewards_after(group, cell)
        for batch, (begin, end) in enumerate(pairwise(edges)):
            inside = (trials >= begin) & (trials < end)
            if inside.any():
                found[row, batch] = rewards[inside].mean()
    return found


def edges_of(group: Group) -> list[int]:
    """Those of `EDGES` that the phase has, and its end."""
    settings = group.cells[0].settings
    closing = closing_of(settings)
    assert closing is not None
    trials = settings.phase_trials[closing.number]
    return [*(edge for edge in EDGES if edge < trials), trials]


def bounds(source: Source, group: Group) -> Iterator[tuple[str, float]]:
    """What is known exactly: who knows of the door; and those who learned without it, and go on as they were."""
    cell = group.cells[0]
    closing, steps = closing_of(cell.settings), cell.settings.trial_steps
    assert closing is not None
    starts = affected_starts(closing.before, closing.after, steps)
    epsilon = float(getattr(cell.config.agents[cell.agent], "epsilon", 0.0))
    gamma = float(getattr(cell.config.agents[cell.agent], "gamma", 0.9))
    yield "knows of it", reward_from(closing.after, starts, steps, navigation_optimal_q(gamma, closing.after), epsilon)
    for other in source.groups.values():
        first = other.cells[0]
        same = first.task == NAVIGATION and not first.settings.phases and first.agent == cell.agent
        if same and first.settings.lab_in() is closing.before:
            values = [
                reward_from(closing.after, starts, steps, values_of(source.run, each), epsilon) for each in other.cells
            ]
            yield f"{other.name}, as it was", float(np.mean(values))


def _figure(source: Source, panels: dict[str, list[Group]]) -> "Figure":
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06)
    figure = Figure(figsize=(PAGE, len(panels) * PANEL_HEIGHT), layout=layout)
    figure.supxlabel(NOTE, fontsize=SMALL, color=GREY)
    for axes, (name, groups) in zip(figure.subplots(len(panels), squeeze=False).flat, panels.items(), strict=True):
        _draw(axes, source, groups)
        axes.set_title(name, loc="left")
    return figure


def _draw(axes: "Axes", source: Source, groups: Sequence[Group]) -> None:
    looks = looks_of(source.config.agents)
    lines: dict[str, float] = {}
    for group in groups:
        edges, look = edges_of(group), looks[group.cells[0].agent]
        values = recovery(group, edges)
        x, known = np.convolve(edges, [0.5, 0.5], "valid"), [batch[~np.isnan(batch)] for batch in values.T]
        mean = np.array([batch.mean() if len(batch) else np.nan for batch in known])
        half = np.array([float(half_width(batch)) for batch in known])
        axes.fill_between(x, mean - half, mean + half, color=look.colour, alpha=0.2, lw=0)
        axes.plot(x, mean, color=look.colour, marker=look.marker, markersize=3.2, linewidth=1.2, label=group.name)
        lines |= dict(bounds(source, group))
    for style, (name, value) in zip(("--", ":", "-.", (0, (1, 3))) * 2, lines.items(), strict=False):
        axes.axhline(value, color=GREY, linewidth=0.9, linestyle=style, label=name)
    cell = groups[0].cells[0]
    share = float(np.mean(_share(cell)))
    axes.set_xlabel("trials after the closure")
    axes.set_ylabel(f"reward a trial\n({share:.1%} of the starts, n = {len(groups[0].cells)} runs)")
    axes.set_xlim(0, edges_of(groups[0])[-1])
    axes.set_ylim(0, None)
    axes.legend(fontsize=SMALL, loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    axes.tick_params(labelsize=FONT_SIZE)


def _share(cell: Cell) -> float:
    closing = closing_of(cell.settings)
    assert closing is not None
    affected = affected_starts(closing.before, closing.after, cell.settings.trial_steps)
    return float(affected[starts_of(closing.after)].mean())
