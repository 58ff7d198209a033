"""The figure of a grid: the level against each varied setting, and beside it a learning curve for each value."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from visitlab_cli.figures.grid import Axis, Level, Line, levels_of
from visitlab_cli.paper.figures.learning import measure_of, x_of
from visitlab_cli.paper.figures.source import Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.height import top_of
from visitlab_cli.pictures.style import BLUE, FONT_SIZE, GREEN, GREY, INK, ORANGE, PAGE, PURPLE, SMALL, VERMILION
from visitlab_cli.pictures.words import in_lines
from visitlab_cli.results.curves import curve_of, equal_edges
from visitlab_cli.results.units import mean_over

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

COLUMNS, PANEL_HEIGHT = 2, 2.4  # inches
MOST_LINES, MOST_NAMED_CURVES, MOST_CURVE_PANELS = 6, 6, 6
"""Beyond these: lines are grey with their mean, curves have a scale of colours, panels are left out."""
MOST_LABELS, CLOSEST, AXIS_WIDTH = 8, 0.08, 2.3
"""Values that an axis names, how close they may lie as a share of it, and how wide it is in inches."""
BARS = "bars and bands: 95% interval of the mean (Student's t), where several seeds are done and curves are few"
KEY_WIDTH = 1.7  # inches
KEY: Any = {"loc": "best", "fontsize": SMALL, "frameon": True, "framealpha": 0.8, "edgecolor": "none"}
FIXED: Any = ((0, (5, 1.5)), (0, (1, 1.5)), (0, (5, 1.5, 1, 1.5)), (0, (2, 3)))
"""How the lines of what does not depend on an axis are dashed."""
SMOOTH, SMOOTHER = 50, 25  # batches of a curve, and where there are many curves
LOOKS = ((VERMILION, "s"), (BLUE, "o"), (GREEN, "^"), (ORANGE, "D"), (PURPLE, "v"), (GREY, "P"))
COLOURS, DARKEST = "viridis", 0.9  # of the colours; the lightest can't be seen on white
RANGE_OF_LOG = 50.0
"""An axis of positive numbers is logarithmic where the last is so many times the first."""
TITLE_WIDTH, TOP = 3.1, 1.15  # inches; how far a panel reaches above the highest mean
Draw = Callable[["Axes"], None]


def draw_grid(source: Source) -> Drawing:
    """A panel for each experiment and varied setting, and panels of learning curves over the first of them."""
    panels: list[Draw] = []
    notes = []
    drawn: set[str] = set()
    for level in levels_of(source):
        panels.append(partial(_draw_level, level=level))
        of_line = {line.name: {group.path for group in line.groups.values()} for line in level.lines}
        lines = [line for line in level.lines if len(line.groups) > 1 and of_line[line.name] - drawn]
        drawn = drawn.union(*of_line.values())
        for line in lines[:MOST_CURVE_PANELS]:
            panels.append(partial(_draw_curves, source=source, level=level, line=line))
        if len(lines) > MOST_CURVE_PANELS:
            notes.append(f"{level.experiment}: learning curves of {len(lines) - MOST_CURVE_PANELS} more are not drawn")
    return Drawing(_figure(panels) if panels else None, notes)


def _figure(panels: Sequence[Draw]) -> "Figure":
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    rows = -(-len(panels) // COLUMNS)
    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06)
    figure = Figure(figsize=(PAGE, rows * PANEL_HEIGHT), layout=layout)
    figure.supxlabel(BARS, fontsize=SMALL, color=GREY)
    places = [*figure.subplots(rows, COLUMNS, squeeze=False).flat]
    for axes, draw in zip(places, panels, strict=False):
        draw(axes)
        axes.grid(axis="y", color="0.92", linewidth=0.5)
    for axes in places[len(panels) :]:
        axes.set_axis_off()
    return figure


def _draw_level(axes: "Axes", level: Level) -> None:
    """A line over the values for each of the other settings; of many, their mean."""
    few = len(level.lines) <= MOST_LINES
    for index, line in enumerate(level.lines):
        x = [level.axis.place[place] for place in line.levels]
        y, half = zip(*((each.mean, each.half) for each in line.levels.values()), strict=True)
        colour, marker = LOOKS[index] if few else (GREY, "")
        look: Any = {"color": colour, "marker": marker, "label": _in_key(line.name) if few else None}
        if few and not np.isnan(half).any():
            axes.errorbar(x, y, half, elinewidth=0.8, capsize=2, linestyle="", color=colour)
        (drawn,) = axes.plot(
            x, y, linewidth=1.1 if few else 0.4, linestyle="-" if level.axis.numbers else ":", markersize=3.6, **look
        )
        drawn.set_gid(f"level/{level.experiment}/{level.axis.path}/{line.name}")
    if not few:
        _draw_mean(axes, level)
    fixed = level.fixed if len(level.fixed) <= len(FIXED) else {}
    for dashes, (name, value) in zip(FIXED, fixed.items(), strict=False):
        axes.axhline(value.mean, color=GREY, linewidth=0.8, linestyle=dashes, label=_in_key(name))
    _draw_places(axes, level.axis)
    title = f"{level.experiment}: level against {level.axis.head}"
    axes.set_title(in_lines(title, TITLE_WIDTH, FONT_SIZE + 1, "bold"), loc="left")
    units = [each for line in level.lines for each in line.units.values()]
    axes.set_ylabel(f"{level.measure}, last tenth\n({mean_over(units)})")
    axes.set_xlabel(level.axis.head)
    axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    if len(level.lines) + len(fixed) > 1:
        axes.legend(**KEY)


def _draw_mean(axes: "Axes", level: Level) -> None:
    """The mean over the lines, at each value that some have."""
    found = [
        (level.axis.place[place], [line.levels[place].mean for line in level.lines if place in line.levels])
        for place in range(len(level.axis.values))
    ]
    x, y = zip(*((place, np.mean(values)) for place, values in found if values), strict=True)
    label = f"mean over the other settings ({len(level.lines)} grey lines)"
    (drawn,) = axes.plot(x, y, color=INK, marker="o", markersize=3.6, label=label)
    drawn.set_gid(f"level/{level.experiment}/{level.axis.path}")


def _draw_places(axes: "Axes", axis: Axis) -> None:
    """Numbers as a scale, words as places with names."""
    if axis.numbers:
        if _logarithmic(axis):
            axes.set_xscale("log")
        if _apart(axis):
            axes.set_xticks(axis.numbers, axis.values)
            axes.set_xticks([], minor=True)
        return
    axes.set_xticks(*_labels(axis))
    axes.tick_params(axis="x", labelsize=SMALL)
    axes.set_xlim(-0.5, len(axis.values) - 0.5)


def _apart(axis: Axis) -> bool:
    """Whether the numbers lie far enough from each other to be named each."""
    place = np.log(axis.place) if _logarithmic(axis) else np.array(axis.place)
    return bool(np.diff(place).min() >= CLOSEST * (place[-1] - place[0]))


def _labels(axis: Axis) -> tuple[list[int], list[str]]:
    """Places of words, and these in lines."""
    places = [*range(0, len(axis.values), -(-len(axis.values) // MOST_LABELS))]
    width = AXIS_WIDTH / len(places)
    parts = [
        [axis.values[place]] if axis.values[place][0] == "[" else axis.values[place].split(", ") for place in places
    ]
    return places, ["\n".join(in_lines(part, width, SMALL) for part in each) for each in parts]


def _in_key(name: str) -> str:
    return in_lines(name, KEY_WIDTH, SMALL)


def _logarithmic(axis: Axis) -> bool:
    return axis.numbers is not None and axis.numbers[0] > 0 and axis.numbers[-1] >= RANGE_OF_LOG * axis.numbers[0]


def _draw_curves(axes: "Axes", source: Source, level: Level, line: Line) -> None:
    """A learning curve for each value, in colours that grow lighter with it."""
    from matplotlib import colormaps

    named = len(line.groups) <= MOST_NAMED_CURVES
    scale = _scale(level.axis)
    curves, end = [], 0.0
    for place, group in line.groups.items():
        cell = group.cells[0]
        curve = curve_of(source.run, group.cells, equal_edges(cell.trials, SMOOTH if named else SMOOTHER))
        curves.append(curve)
        colour = colormaps[COLOURS](DARKEST * scale(level.axis.place[place]))
        if named and curve.counted.n > 1:
            axes.fill_between(curve.x, curve.mean - curve.half, curve.mean + curve.half, color=colour, alpha=0.2, lw=0)
        label = level.axis.values[place] if named else None
        (drawn,) = axes.plot(curve.x, curve.mean, color=colour, linewidth=1.2 if named else 0.8, label=label)
        drawn.set_gid(group.path)
        end = max(end, float(curve.edges[-1] * curve.trial))
    cell = next(iter(line.groups.values())).cells[0]
    unit, x_label = x_of(cell, end)
    title = ": ".join(filter(None, (level.experiment, line.name)))
    axes.set_title(in_lines(title, TITLE_WIDTH, FONT_SIZE + 1, "bold"), loc="left")
    axes.set_xlabel(x_label)
    axes.set_ylabel(f"{measure_of(cell)}\n({mean_over([*line.units.values()])})")
    axes.set_xlim(0, end)
    axes.set_ylim(0, top_of(curves, TOP))
    axes.xaxis.set_major_formatter(lambda x, _: f"{x / unit:g}")
    if named:
        axes.legend(title=level.axis.head, title_fontsize=SMALL, **KEY)
    else:
        _draw_scale(axes, level.axis, scale)


def _scale(axis: Axis) -> "Normalize":
    from matplotlib.colors import LogNorm, Normalize

    return (LogNorm if _logarithmic(axis) else Normalize)(axis.place[0], axis.place[-1])


def _draw_scale(axes: "Axes", axis: Axis, scale: "Normalize") -> None:
    """What the colours mean."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import ListedColormap

    colours = ListedColormap(colormaps[COLOURS](np.linspace(0, DARKEST, 256)))
    bar = axes.figure.colorbar(ScalarMappable(scale, colours), ax=axes, label=axis.head, pad=0.02)
    bar.outline.set_visible(False)
    if axis.numbers is None:
        places, labels = _labels(axis)
        bar.set_ticks(places, labels=labels)
