"""Affordances as intents, drawn: reward kept against the size of a sweep, and how many pairs afford what."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visitlab_cli.affordances.intents import INTENTS
from visitlab_cli.affordances.picture import in_words
from visitlab_cli.affordances.restricted import PairSet, Restricted
from visitlab_cli.colours import PALETTE
from visitlab_cli.pictures.style import BLUE, GREY, INK, PAGE, SMALL, STYLE, VERMILION, save, styled
from visitlab_cli.pictures.words import height_of, in_lines

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST = 4
"""Groups of modules that are shown; the others are in `--json`."""
HEIGHT = 4.6
LEFT, RIGHT, TOP, BOTTOM = 0.62, 0.14, 0.42, 0.78  # inches
TITLE_SIZE = 8
TWO_LINES = "Human\na trial"
"""A title for which `TOP` has room."""
GAP = 3  # points
PERCENT, MOST_PERCENT = 100, 106
SHOWN, EDGE = (80.0, 105.0), 0.1
"""Percent of the reward that are shown at least, so that noise does not look large; the part left free."""


def save_intents(found: Sequence[Restricted], target: Path, names: Mapping[str, str]) -> None:
    """Write the picture as .svg, .png or .pdf; the same bytes for the same modules.

    Args:
        found: what is drawn.
        target: where.
        names: what humans are called, by their names in the config; others by these.

    Raises:
        RunError: it cannot be written.
    """
    with styled(STYLE):
        save(draw_intents(found, names), target)


def draw_intents(found: Sequence[Restricted], names: Mapping[str, str]) -> "Figure":
    """A column for each group: above reward against entries of a sweep, below pairs by intent against k."""
    from matplotlib.figure import Figure

    shown = found[:MOST]
    room = (PAGE - LEFT - RIGHT) / len(shown) - 0.35
    humans = [names.get(module.human) or in_words(module.human) for module in shown]
    titles = [
        f"{in_lines(human, room, TITLE_SIZE, 'bold')}\n{module.whole.reward.mean():.2f} a trial"
        for human, module in zip(humans, shown, strict=True)
    ]
    more_lines = max(height_of(title, TITLE_SIZE) for title in titles) - height_of(TWO_LINES, TITLE_SIZE)
    top, height = TOP + more_lines, HEIGHT + more_lines
    figure = Figure(figsize=(PAGE, height))
    panels: Any = figure.subplots(2, len(shown), squeeze=False)
    figure.subplots_adjust(
        left=LEFT / PAGE, right=1 - RIGHT / PAGE, top=1 - top / height, bottom=BOTTOM / height, hspace=0.42, wspace=0.32
    )
    ends = [SHOWN]
    for title, module, above, below in zip(titles, shown, *panels, strict=True):
        above.set_title(title, loc="left")
        ends.append(_draw_reward(above, module))
        _draw_sizes(below, module)
    lowest, highest = min(low for low, _ in ends), max(high for _, high in ends)
    edge = EDGE * (highest - lowest)
    for above in panels[0]:
        above.set_ylim(lowest - edge, highest + edge)
        above.tick_params(labelleft=above is panels[0][0])
    largest = max(float(each.affording.mean(axis=0).max()) for module in shown for each in _asked(module))
    for below in panels[1]:
        below.set_ylim(1, 2 * max(1.0, largest))
        below.tick_params(labelleft=below is panels[1][0])
    panels[0][0].set_ylabel("reward kept (% of that with all pairs)")
    panels[1][0].set_ylabel("pairs that afford it")
    handles = panels[1][0].get_legend_handles_labels()
    figure.legend(*handles, loc="lower left", ncols=len(INTENTS), bbox_to_anchor=(LEFT / PAGE, 0.055))
    more = f"; {len(found) - MOST} more in --json" if len(found) > MOST else ""
    n = len({seed for module in shown for seed in module.seeds})
    note = (
        f"n = {n} seed{'' if n == 1 else 's'}; bars: 95% interval of the difference by seed (Student's t) "
        f"from all pairs that were tried, at 100%. Along the line k rises{more}."
    )
    figure.text(LEFT / PAGE, 0.02, note, fontsize=SMALL, color=GREY)
    return figure


def _draw_reward(axes: "Axes", module: Restricted) -> tuple[float, float]:
    """Its points; the lowest and the highest end of a bar, in percent."""
    whole = float(module.whole.reward.mean())
    asked = _asked(module)
    axes.axhline(PERCENT, color="0.8", linewidth=0.8, zorder=0)
    axes.plot(*zip(*(_place(module, each) for each in asked), strict=True), color=BLUE, linewidth=0.8, zorder=1)
    ends = []
    for each in module.sets:
        x, y = _place(module, each)
        colour, marker = (VERMILION, "s") if each.threshold is None else (BLUE, "o")
        half = PERCENT * module.difference(each).half / whole if whole else 0.0
        half = 0.0 if math.isnan(half) else half
        axes.plot([x, x], [y - half, y + half], color=colour, linewidth=0.7, alpha=0.6, zorder=2)
        axes.plot(x, y, marker=marker, color=colour, markersize=3.2, zorder=3)
        ends += [y - half, y + half]
        words: Any = {"textcoords": "offset points", "fontsize": SMALL, "color": INK}
        if each is not module.whole and each.threshold is None:
            axes.annotate(each.name, (x, y + half), xytext=(GAP, GAP), ha="right", **words)
        elif each is asked[0] or each is asked[-1]:
            axes.annotate(f"{each.threshold:g}", (x, y), xytext=(GAP, -GAP), va="top", **words)
    axes.set(xlim=(0, MOST_PERCENT), xlabel="entries of a sweep (% of all)")
    return min(ends), max(ends)


def _asked(module: Restricted) -> list[PairSet]:
    """The sets in which an intent is asked for, k rising."""
    return [each for each in module.sets if each.threshold is not None]


def _place(module: Restricted, found: PairSet) -> tuple[float, float]:
    return PERCENT * float(found.entries.mean() / module.whole.entries.mean()), PERCENT * module.kept(found)


def _draw_sizes(axes: "Axes", module: Restricted) -> None:
    asked = _asked(module)
    for index, intent in enumerate(INTENTS):
        sizes = [float(each.affording[:, index].mean()) for each in asked]
        look: Any = {"color": PALETTE[index].light, "marker": PALETTE[index].marker, "markersize": 3, "linewidth": 0.9}
        axes.plot([each.threshold or 0.0 for each in asked], sizes, label=str(intent), **look)
    axes.set(yscale="log", xlim=(0, 1), xticks=(0, 0.5, 1), xlabel="k")
    axes.yaxis.set_major_formatter(lambda size, _: f"{size:,.0f}")
    axes.yaxis.set_minor_formatter(lambda size, _: "")
