"""The figure of curves: agents or visits side by side, a panel for each human; if asked, what a step costs."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visitlab_cli.colours import Look, looks_of
from visitlab_cli.config.figure import NO_FIGURE
from visitlab_cli.figures.bars import KEY_SIZE, draw_note
from visitlab_cli.paper.figures.learning import measure_of, x_of
from visitlab_cli.paper.figures.source import Group, Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.height import top_of
from visitlab_cli.pictures.style import PAGE, SMALL
from visitlab_cli.pictures.words import width_of
from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.costs import microseconds, updates
from visitlab_cli.results.curves import Curve, Integers, curve_of, equal_edges
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import unit_values
from visitlab_cli.results.units import mean_over
from visitlab_cli.wording import few

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMNS, PANEL_HEIGHT, KEY_LINE, NOTE_HEIGHT = 3, 2.3, 0.16, 0.35  # inches
BATCHES, VISIT_BATCHES, MARKERS = 50, 25, 8
MOST_NAMED = 6
"""Of what is left out for one reason."""
TOP = 1.08
"""How far a panel reaches above the highest mean."""
COSTS: Mapping[str, tuple[Callable[[Path, Cell], float | None], str]] = {
    "updates": (updates, "values updated\na step, in the end"),
    "cpu": (microseconds, "µs of a core\na step, as measured"),
}
WIDE, NARROW = 2.6, 0.8
"""How the width is shared between curves and costs."""
BEYOND = 6.0
"""How far, as a factor, an axis of costs goes beyond the dearest, for its number."""
NOTE = "each point: the mean of {} trials; shades and bars: 95% interval of the mean over seeds (Student's t)"
HANDLE = 0.43
"""Inches that a line of the key takes beside its words."""
Lines = Mapping[str, Group]


def draw_curves(source: Source) -> Drawing:
    """A panel for each human with a curve for each visit; before them trainings' with one for each agent, if more."""
    visits, trainings = (panels_of(source, visits=visits) for visits in (True, False))
    panels = trainings | visits if _size(trainings) > _size(visits) else visits
    if not panels:
        return Drawing(None)
    costs = (source.config.figure or NO_FIGURE).costs
    without = ["without costs, which are of trainings alone"] if visits and costs else []
    return Drawing(_figure(source, panels), [*_left_out(source, panels), *without])


def panels_of(source: Source, *, visits: bool) -> dict[tuple[str, str], Lines]:
    """By experiment (of visits '') and human the groups, by the experiment or agent that tells them apart; two or more.

    No group with phases or of a grid is among them: these have figures of their own.
    """
    panels: dict[tuple[str, str], dict[str, Group]] = {}
    for group in source.groups.values():
        cell = group.cells[0]
        if cell.settings.assembled == visits and not cell.point and not cell.settings.phases:
            place = "" if visits else cell.experiment, cell.human
            panels.setdefault(place, {})[cell.experiment if visits else cell.agent] = group
    return {place: lines for place, lines in panels.items() if len(lines) > 1}


def _left_out(source: Source, panels: Mapping[tuple[str, str], Lines]) -> list[str]:
    """A line on visits, and on all with phases or of a grid, of which nothing is drawn."""
    drawn = {group.name for lines in panels.values() for group in lines.values()}
    why: dict[str, dict[str, None]] = {}
    for group in source.groups.values():
        cell = group.cells[0]
        if group.name in drawn:
            continue
        if cell.point:
            why.setdefault("of a grid, which the figure grid draws", {})[cell.experiment] = None
        elif cell.settings.phases:
            why.setdefault("with phases, which the figures phases and meetings draw", {})[cell.experiment] = None
        elif cell.settings.assembled:
            why.setdefault("the only visit of its human", {})[group.name] = None
    told = [f"{few(list(names), MOST_NAMED)} ({reason})" for reason, names in why.items()]
    return [f"without {', '.join(told)}"] if told else []


def _size(panels: Mapping[tuple[str, str], Lines]) -> int:
    return sum(map(len, panels.values()))


def _figure(source: Source, panels: Mapping[tuple[str, str], Lines]) -> "Figure":
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.lines import Line2D

    told = source.config.figure or NO_FIGURE
    costs = COSTS if told.costs and "" not in {experiment for experiment, _ in panels} else {}
    names = list(dict.fromkeys(name for lines in panels.values() for name in lines))
    looks = looks_of([name for name in names if told.dashed.get(name) not in names])
    looks |= {name: looks[told.dashed[name]] for name in names if name not in looks}
    columns = len(panels) if costs else min(COLUMNS, len(panels))
    rows = -(-len(panels) // columns)
    in_key = 1 if costs else _columns([*map(told.words, names)])
    key_lines = 0 if costs else -(-len(names) // in_key)
    figure = Figure(
        figsize=(PAGE, rows * PANEL_HEIGHT + NOTE_HEIGHT + key_lines * KEY_LINE),
        layout=ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.05),
    )
    ratios = [WIDE] * columns + [NARROW] * len(costs)
    places = [*figure.subplots(rows, len(ratios), squeeze=False, width_ratios=ratios).flat]
    alike = len({experiment for experiment, _ in panels}) == 1
    curves: dict[str, list[Curve]] = {}
    for axes, ((experiment, _), lines) in zip(places, panels.items(), strict=False):
        curves.setdefault(experiment, []).extend(_draw(axes, lines, looks, told.dashed))
    for axes, (experiment, human) in zip(places, panels, strict=False):
        axes.set_ylim(0, top_of(curves[experiment], TOP))
        first = places[0].get_ylabel()
        if axes.get_subplotspec().colspan.start and axes.get_ylabel() == first:
            axes.set_ylabel("")
        title = [] if alike and human else [told.words(experiment) if experiment else "visits"]
        axes.set_title(", ".join([*title, *([told.words(human)] if human else [])]), loc="left")
    for axes, name in zip(places[len(panels) :], costs, strict=False):
        _draw_costs(axes, source.run, name, panels, looks)
    if costs:
        places[len(panels)].set_yticks(range(len(names)), map(told.words, names))
        for axes in places[len(panels) :]:
            axes.set_ylim(len(names) - 0.5, -0.5)
            axes.tick_params(axis="y", length=0)
        places[-1].set_yticks(range(len(names)), [""] * len(names))
    else:
        for axes in places[len(panels) :]:
            axes.set_axis_off()
    keys = [Line2D([], [], label=told.words(name), **_style(name, looks, told.dashed)) for name in names]
    in_rows = [key for column in range(in_key) for key in keys[column::in_key]]  # a key is filled column by column
    draw_note(figure, NOTE.format(_trials_a_point(panels)), [] if costs else in_rows, in_key)
    return figure


def _trials_a_point(panels: Mapping[tuple[str, str], Lines]) -> str:
    sizes = [_edges(group) for lines in panels.values() for group in lines.values()]
    several = sorted({round(float(edges[1] - edges[0])) for edges in sizes})
    return " to ".join(f"{size:,}" for size in (several[0], several[-1])[: len(several)])


def _edges(group: Group) -> Integers:
    cell = group.cells[0]
    return equal_edges(cell.trials, VISIT_BATCHES if cell.settings.assembled else BATCHES)


def _style(name: str, looks: Mapping[str, Look], dashed: Mapping[str, str]) -> Any:
    look = looks[name]
    lines = {"linestyle": (0, (3.5, 1.2)) if name in dashed else "-", "linewidth": 1.2}
    return {"color": look.colour, "marker": look.marker, "markersize": 3.2, **lines}


def _draw(axes: "Axes", lines: Lines, looks: Mapping[str, Look], dashed: Mapping[str, str]) -> list[Curve]:
    """Its curves, which are given back."""
    curves, end = [], 0.0
    for place, (name, group) in enumerate(lines.items()):
        curve = curve_of(group.run, group.cells, _edges(group))
        if curve.counted.n > 1:
            low, high = curve.mean - curve.half, curve.mean + curve.half
            axes.fill_between(curve.x, low, high, color=looks[name].colour, alpha=0.15, lw=0)
        every = max(1, len(curve.x) // MARKERS)
        style = _style(name, looks, dashed)
        axes.plot(curve.x, curve.mean, gid=group.name, markevery=(place * every // len(lines), every), **style)
        curves.append(curve)
        end = max(end, float(curve.edges[-1] * curve.trial))
    cell = next(iter(lines.values())).cells[0]
    unit, x_label = x_of(cell, end)
    axes.set_xlabel(x_label)
    axes.set_ylabel(f"{measure_of(cell)}\n({mean_over([curve.counted for curve in curves])})")
    axes.set_xlim(0, end)
    axes.xaxis.set_major_formatter(lambda x, _: f"{x / unit:g}")
    axes.grid(axis="y", color="0.92", linewidth=0.5)
    return curves


def _columns(names: Sequence[str]) -> int:
    """How many columns a key has: as few rows as its words allow, these as long as each other."""
    for rows in range(1, len(names)):
        columns = -(-len(names) // rows)
        widths = [max(width_of(name, KEY_SIZE) for name in names[at::columns]) + HANDLE for at in range(columns)]
        if sum(widths) <= PAGE:
            return columns
    return 1


def _draw_costs(
    axes: "Axes", run: Path, cost: str, panels: Mapping[tuple[str, str], Lines], looks: Mapping[str, Look]
) -> None:
    """A dot for each agent, the mean over all that is drawn of it, on a logarithmic axis."""
    from matplotlib.ticker import LogLocator, NullFormatter

    measure, label = COSTS[cost]
    places = list(dict.fromkeys(name for lines in panels.values() for name in lines))
    found = {
        name: estimate
        for name in places
        if (estimate := _cost(run, [lines[name] for lines in panels.values() if name in lines], measure)) is not None
    }
    for name, (mean, half) in found.items():
        place, look = places.index(name), looks[name]
        axes.plot(
            mean, place, color=look.colour, marker=look.marker, markersize=4.5, linestyle="", gid=f"cost/{cost}/{name}"
        )
        if half > 0:
            ends = [max(mean - half, mean / BEYOND), mean + half]
            axes.plot(ends, [place, place], color=look.colour, linewidth=0.9)
        number = f"{mean:.3g}" if mean < 1000 else f"{mean:,.0f}"
        axes.annotate(
            number, (max(mean, mean + half), place), (5, 0), textcoords="offset points", fontsize=SMALL, va="center"
        )
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(lambda x, _: f"{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())
    if found:
        means = [estimate.mean for estimate in found.values()]
        axes.set_xlim(min(means) / 1.6, max(means) * BEYOND)
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0,) if max(means) > 10 * min(means) else (1.0, 3.0)))
    axes.set_xlabel(label)
    axes.grid(axis="x", color="0.92", linewidth=0.5)


def _cost(run: Path, groups: Sequence[Group], measure: Callable[[Path, Cell], float | None]) -> Estimate | None:
    values = [*unit_values(run, [cell for group in groups for cell in group.cells], measure).values()]
    return mean_of(values) if values and min(values) > 0 else None
