"""The figure of visits: how many goals a trial each visit of a run reaches, a panel for each human."""

import numpy as np

from visitlab_cli.config.figure import NO_FIGURE
from visitlab_cli.figures.bars import Bar, Panel, draw_bars
from visitlab_cli.paper.figures.source import Group, Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.results.estimates import mean_of
from visitlab_cli.results.units import Units, by_unit

NOTE = "second half of the trials; lines: 95% interval of the mean (Student's t)"


def draw_visits(source: Source) -> Drawing:
    """Bars of the second half of the trials, for visits without phases of a run that has several."""
    visits = [group for group in source.groups.values() if _counts(group)]
    names = list(dict.fromkeys(group.cells[0].experiment for group in visits))
    if len(names) < 2:
        return Drawing(None)
    words = (source.config.figure or NO_FIGURE).words
    met: dict[str, dict[str, Bar]] = {}
    for group in visits:
        met.setdefault(group.cells[0].human, {})[group.cells[0].experiment] = second_half(group)
    panels = [Panel(words(human), "goals a trial", bars) for human, bars in met.items()]
    kinds = {group.cells[0].experiment: controller_of(group) for group in visits}
    return Drawing(draw_bars({name: words(name) for name in names}, panels, NOTE, kinds))


def _counts(group: Group) -> bool:
    cell = group.cells[0]
    return cell.settings.assembled and not cell.settings.phases and not cell.point and not cell.frozen


def second_half(group: Group) -> Bar:
    """Goals a trial in the second half of the trials, the mean over independent units, and how many these are."""
    rewards = group.rewards()
    reached = rewards[:, rewards.shape[1] // 2 :].mean(axis=1)
    place = {cell.path: float(value) for cell, value in zip(group.cells, reached, strict=True)}
    units = [float(np.mean([place[cell.path] for cell in cells])) for cells in by_unit(group.cells).values()]
    return Bar(mean_of(units), Units(len(units), len(group.cells)))


def controller_of(group: Group) -> str:
    """'controller: lead'; of what is no visit nothing."""
    controller = getattr(group.cells[0].settings, "controller", "")
    names = [controller] if isinstance(controller, str) else controller
    return f"controller: {', '.join(names)}" if controller else ""
