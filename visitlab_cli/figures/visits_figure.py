"""The figure of visits: how many goals a trial each visit of a run reaches, a panel for each human."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from visitlab_cli.colours import PALETTE
from visitlab_cli.paper.figures.source import Group, Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.style import FONT_SIZE, GREY, INK, PAGE, SMALL
from visitlab_cli.pictures.words import width_of
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.units import by_unit

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BAR, THICK = 0.2, 0.66
"""Inches from bar to bar, and the part of that which is bar."""
HEAD, FOOT = 0.3, 0.75  # inches
ROOM = 1.22
"""How far an axis goes beyond the longest bar, for its number."""


def draw_visits(source: Source) -> Drawing:
    """Bars of the second half of the trials, for visits without phases of a run that has several."""
    visits = [group for group in source.groups.values() if _counts(group)]
    names = list(dict.fromkeys(group.cells[0].experiment for group in visits))
    return Drawing(_figure(visits, names) if len(names) > 1 else None, [])


def _counts(group: Group) -> bool:
    cell = group.cells[0]
    return cell.settings.assembled and not cell.settings.phases and not cell.point and not cell.frozen


def second_half(group: Group) -> tuple[Estimate, int]:
    """Goals a trial in the second half of the trials, the mean over independent units, and how many these are."""
    rewards = group.rewards()
    reached = rewards[:, rewards.shape[1] // 2 :].mean(axis=1)
    place = {cell.path: float(value) for cell, value in zip(group.cells, reached, strict=True)}
    units = [np.mean([place[cell.path] for cell in cells]) for cells in by_unit(group.cells).values()]
    return mean_of([float(value) for value in units]), len(units)


def _figure(visits: Sequence[Group], names: Sequence[str]) -> "Figure":
    from matplotlib.figure import Figure

    humans = list(dict.fromkeys(group.cells[0].human for group in visits))
    height = len(names) * BAR + HEAD + FOOT
    figure = Figure(figsize=(PAGE, height))
    left = max(width_of(name, FONT_SIZE) for name in names) + 0.2
    panels = figure.subplots(1, len(humans), sharey=True, squeeze=False)[0]
    figure.subplots_adjust(
        left=left / PAGE, right=1 - 0.1 / PAGE, top=1 - HEAD / height, bottom=FOOT / height, wspace=0.08
    )
    for axes, human in zip(panels, humans, strict=True):
        met = {group.cells[0].experiment: group for group in visits if group.cells[0].human == human}
        n = _draw(axes, met, names)
        axes.set_title(human, loc="left")
        axes.set_xlabel(f"goals a trial (n = {n} runs)")
    panels[0].set_yticks(range(len(names)), names)
    panels[0].invert_yaxis()  # all share it
    note = "second half of the trials; lines: 95% interval of the mean (Student's t)"
    figure.text(0.02, 0.08 / height, note, fontsize=SMALL, color=GREY)
    return figure


def _draw(axes: "Axes", met: dict[str, Group], names: Sequence[str]) -> str:
    """The bars of a human; how many runs each stands for, in words."""
    controllers = list(dict.fromkeys(_controller(group) for group in met.values()))
    longest, sizes = 0.0, set()
    for place, name in enumerate(names):
        if name not in met:
            continue
        (mean, half), n = second_half(met[name])
        known = 0.0 if math.isnan(half) else half
        colour = PALETTE[controllers.index(_controller(met[name])) % len(PALETTE)].light
        axes.barh(place, mean, THICK, color=colour, alpha=0.75, linewidth=0)
        if known:
            axes.plot([max(mean - known, 0), mean + known], [place, place], color=INK, linewidth=0.9)
        axes.text(mean + known, place, f"  {mean:.2f}", fontsize=SMALL, color=INK, va="center")
        longest = max(longest, mean + known)
        sizes.add(n)
    axes.set_xlim(0, ROOM * longest or 1)
    axes.tick_params(axis="y", length=0)
    return " to ".join(map(str, sorted(sizes))) if len(sizes) < 3 else f"{min(sizes)} to {max(sizes)}"


def _controller(group: Group) -> str:
    return str(getattr(group.cells[0].settings, "controller", ""))
