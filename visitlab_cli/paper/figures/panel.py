"""One panel of learning curves: ours with its interval, the published ones behind, and lines to measure them by."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from visitlab_cli.paper.published.curves import PublishedCurve
from visitlab_cli.pictures.height import top_of
from visitlab_cli.pictures.style import FONT_SIZE, GREY, INK, SMALL
from visitlab_cli.pictures.words import in_lines
from visitlab_cli.results.curves import Curve
from visitlab_cli.results.units import mean_over

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKERS_A_CURVE = 8
OPTIMUM, SCRIPT, CHANCE = "optimum", "script", "chance"
DASHES = {OPTIMUM: (0, ()), SCRIPT: (0, (5, 1.5, 1, 1.5)), CHANCE: (0, (1, 1.5))}
"""How each kind of reference line is drawn."""
MEANINGS = {OPTIMUM: "optimum, exact", SCRIPT: "script, told the rules", CHANCE: "random actions"}
DASHED = (0, (2.5, 1.3))
OUR_BAND, THEIR_BAND, THEIR_EDGE = 0.35, 0.06, 0.45
"""How opaque the bands are."""
TITLE_PAD = 15.0  # points
LINE_WIDTH = 3.0  # inches, of what is said below an axis
TOP = 1.06
"""How far a panel reaches above the highest mean and published band."""


class Line(NamedTuple):
    """A condition: where its data lie in the run (`group`), its name and look, its curve, what was published."""

    group: str
    name: str
    colour: str
    marker: str
    ours: Curve
    published: PublishedCurve | None = None


class Reference(NamedTuple):
    """A horizontal line: its kind, its value, and whose it is where there is one for each condition."""

    kind: str
    value: float
    colour: str = GREY


class Panel(NamedTuple):
    """What a panel shows, and what its axes say."""

    title: str
    x_label: str
    x_unit: float  # in a labelled unit of x
    y_label: str
    lines: Sequence[Line]
    references: Sequence[Reference] = ()
    end: float = 0.0
    """The last x that is shown."""
    mark: float | None = None
    """An x worth a vertical line."""
    note: str = ""
    """What else is to be said, in a corner."""
    unlike: str = ""
    """What is not as published, below the axis."""


def draw_panel(axes: "Axes", panel: Panel) -> None:
    """Draw the bands, then the published curves, ours, the reference lines and what the axes say."""
    from matplotlib.ticker import MaxNLocator

    for index, line in enumerate(panel.lines):
        if line.published is not None:
            _draw_published(axes, line, line.published)
        _draw_ours(axes, line, line.ours, index)
    if panel.mark is not None:
        axes.axvline(panel.mark, color=INK, linewidth=0.7, linestyle=(0, (1, 1.5)), zorder=1)
    _draw_references(axes, panel.references)
    if panel.note:
        corner: Any = {"transform": axes.transAxes, "ha": "right", "va": "bottom", "multialignment": "left"}
        box: Any = {"facecolor": "white", "alpha": 0.8, "linewidth": 0, "pad": 1.5}
        axes.text(0.985, 0.03, panel.note, fontsize=SMALL, color=INK, bbox=box, zorder=7, **corner)
    axes.set_title(panel.title, loc="left", pad=TITLE_PAD)
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), borderaxespad=0, ncols=3, handlelength=1.8, columnspacing=1.1)
    unlike = f"\n{in_lines(panel.unlike, LINE_WIDTH, FONT_SIZE)}" if panel.unlike else ""
    axes.set_xlabel(panel.x_label + unlike)
    axes.set_ylabel(f"{panel.y_label}\n({mean_over([line.ours.counted for line in panel.lines])})")
    axes.set_xlim(0, panel.end)
    axes.set_ylim(0, _top(panel))
    axes.xaxis.set_major_formatter(lambda x, _: f"{x / panel.x_unit:g}")
    axes.yaxis.set_major_locator(MaxNLocator(6, integer=True))
    axes.grid(axis="y", color="0.92", linewidth=0.5)


def _draw_published(axes: "Axes", line: Line, curve: PublishedCurve) -> None:
    from matplotlib import patheffects

    low, high = curve.mean - curve.band, curve.mean + curve.band
    area = axes.fill_between(curve.x, low, high, color=line.colour, alpha=THEIR_BAND, linewidth=0, zorder=1)
    area.set_gid(f"published-band/{line.group}")
    for edge in (low, high):
        axes.plot(curve.x, edge, color=line.colour, alpha=THEIR_EDGE, linewidth=0.5, zorder=1)
    (drawn,) = axes.plot(curve.x, curve.mean, color=line.colour, linewidth=0.9, linestyle=DASHED, zorder=4)
    drawn.set_path_effects([patheffects.Stroke(linewidth=1.8, foreground="black"), patheffects.Normal()])
    drawn.set_gid(f"published/{line.group}")


def _draw_ours(axes: "Axes", line: Line, curve: Curve, index: int) -> None:
    low, high = curve.mean - curve.half, curve.mean + curve.half
    area = axes.fill_between(curve.x, low, high, color=line.colour, alpha=OUR_BAND, linewidth=0, zorder=3)
    area.set_gid(f"interval/{line.group}")
    every = max(len(curve.x) // MARKERS_A_CURVE, 1)
    (drawn,) = axes.plot(
        curve.x,
        curve.mean,
        color=line.colour,
        marker=line.marker,
        markersize=3.6,
        markeredgecolor="white",
        markeredgewidth=0.5,
        markevery=(index * every // 4, every),
        label=line.name,
        zorder=5,
    )
    drawn.set_gid(line.group)


def _draw_references(axes: "Axes", references: Sequence[Reference]) -> None:
    for kind, value, colour in references:
        line = axes.axhline(value, color=colour, linewidth=0.8, linestyle=DASHES[kind], zorder=2)
        line.set_gid(f"reference/{kind}")
        beside = ("axes fraction", "data")
        axes.annotate(
            f"{kind} {value:.1f}",
            (1.015, value),
            xycoords=beside,
            va="center",
            fontsize=SMALL,
            color=colour,
            annotation_clip=False,
        )


def _top(panel: Panel) -> float:
    """A little more than the highest thing that is drawn."""
    values = [reference.value for reference in panel.references]
    for line in panel.lines:
        if line.published is not None:
            shown = line.published.x <= panel.end
            values.append(float((line.published.mean + line.published.band)[shown].max(initial=0.0)))
    return max(TOP * max(values, default=0.0), top_of([line.ours for line in panel.lines], TOP))


def draw_key(figure: "Figure", panels: Sequence[Panel]) -> None:
    """What each kind of line and band is, in grey, below all panels."""
    from matplotlib.colors import to_rgba
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    references = {reference.kind for panel in panels for reference in panel.references}
    curves = [line.ours for panel in panels for line in panel.lines]
    interval = Patch(color=GREY, alpha=OUR_BAND, linewidth=0, label="this run: 95% interval\nof the mean (Student's t)")
    spread = "published: standard deviation between the\n10 seeds of single trials, not of the mean"
    published = [
        Line2D([], [], color="k", linestyle=DASHED, linewidth=1.4, label="published: mean of 10 seeds"),
        Patch(facecolor=to_rgba(GREY, THEIR_BAND), edgecolor=to_rgba(GREY, THEIR_EDGE), linewidth=0.5, label=spread),
    ]
    figure.legend(
        handles=[
            Line2D([], [], color=GREY, marker="o", markersize=3.6, label="this run: mean"),
            *([interval] if any(curve.counted.n > 1 for curve in curves) else []),
            *(published if any(line.published is not None for panel in panels for line in panel.lines) else []),
            *(
                Line2D([], [], color=GREY, linewidth=0.8, linestyle=DASHES[kind], label=meaning)
                for kind, meaning in MEANINGS.items()
                if kind in references
            ),
        ],
        loc="outside lower center",
        ncols=4 if len(references) > 2 else 3,
        handlelength=2.6,
        columnspacing=1.6,
    )
