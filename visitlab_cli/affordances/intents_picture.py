"""Affordances as intents, drawn: what is kept of the reward against the size of a sweep, and how many pairs afford what."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visitlab_cli.affordances.intents import INTENTS
from visitlab_cli.affordances.picture import in_words
from visitlab_cli.affordances.restricted import PairSet, Restricted
from visitlab_cli.colours import PALETTE
from visitlab_cli.pictures.style import BLUE, GREY, INK, PAGE, SMALL, STYLE, VERMILION, save, styled
from visitlab_cli.pictures.words import in_lines

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST = 4
"""Groups of modules that are shown; the others are in `--json`."""
HEIGHT = 4.6
LEFT, RIGHT, TOP, BOTTOM = 0.55, 0.08, 0.42, 0.78  # inches
TITLE_SIZE = 8
LABEL_GAP = 4  # points
PERCENT = 100


def save_intents(found: Sequence[Restricted], target: Path) -> None:
    """Write the picture as .svg, .png or .pdf; the same bytes for the same modules.

    Raises:
        RunError: it cannot be written.
    """
    with styled(STYLE):
        save(draw_intents(found), target)


def draw_intents(found: Sequence[Restricted]) -> "Figure":
    """A column for each group: above reward against entries of a sweep, below pairs by intent against k."""
    from matplotlib.figure import Figure

    shown = found[:MOST]
    figure = Figure(figsize=(PAGE, HEIGHT))
    panels: Any = figure.subplots(2, len(shown), sharey="row", squeeze=False)
    figure.subplots_adjust(
        left=LEFT / PAGE, right=1 - RIGHT / PAGE, top=1 - TOP / HEIGHT, bottom=BOTTOM / HEIGHT, hspace=0.42, wspace=0.12
    )
    room = (PAGE - LEFT - RIGHT) / len(shown) - 0.1
    for module, above, below in zip(shown, *panels, strict=True):
        reward = f"{in_words(module.human)}: {module.whole.reward.mean():.2f} a trial with all pairs"
        above.set_title(in_lines(reward, room, TITLE_SIZE, "bold"), loc="left")
        _draw_reward(above, module)
        _draw_sizes(below, module)
    panels[0][0].set_ylabel("reward kept (% of that with all pairs)")
    panels[1][0].set_ylabel("pairs that afford it")
    handles = panels[1][0].get_legend_handles_labels()
    figure.legend(*handles, loc="lower left", ncols=len(INTENTS), bbox_to_anchor=(LEFT / PAGE, 0.055))
    more = f"; {len(found) - MOST} more in --json" if len(found) > MOST else ""
    n = len({seed for module in shown for seed in module.seeds})
    note = (
        f"n = {n} seed{'' if n == 1 else 's'}; bars: 95% interval of the difference from all pairs, by seed (Student's t). "
        f"At a point: k{more}."
    )
    figure.text(LEFT / PAGE, 0.02, note, fontsize=SMALL, color=GREY)
    return figure


def _draw_reward(axes: "Axes", module: Restricted) -> None:
    whole = module.whole
    asked = [each for each in module.sets if each.threshold is not None]
    axes.axhline(PERCENT, color="0.8", linewidth=0.8, zorder=0)
    axes.plot(*zip(*(_place(module, each) for each in asked), strict=True), color=BLUE, linewidth=0.8, zorder=1)
    for each in module.sets:
        x, y = _place(module, each)
        colour, marker = (BLUE, "o") if each.threshold is not None else (VERMILION, "s")
        half = PERCENT * module.difference(each).half / whole.reward.mean() if whole.reward.mean() else math.nan
        if half > 0:
            axes.plot([x, x], [y - half, y + half], color=colour, linewidth=0.7, alpha=0.6, zorder=2)
        axes.plot(x, y, marker=marker, color=colour, markersize=3.2, zorder=3)
        label = each.name if each.threshold is None else f"{each.threshold:g}"
        side: Any = {"textcoords": "offset points", "xytext": (-LABEL_GAP, LABEL_GAP / 2), "ha": "right"}
        axes.annotate(label, (x, y), fontsize=SMALL, color=INK, **side)
    axes.set_xlim(0, 1.06 * PERCENT)
    axes.set_xlabel("entries of a sweep (% of all)")


def _place(module: Restricted, found: PairSet) -> tuple[float, float]:
    return PERCENT * float(found.entries.mean() / module.whole.entries.mean()), PERCENT * module.kept(found)


def _draw_sizes(axes: "Axes", module: Restricted) -> None:
    asked = [each for each in module.sets if each.threshold is not None]
    for index, intent in enumerate(INTENTS):
        sizes = [float(each.affording[:, index].mean()) for each in asked]
        look: Any = {"color": PALETTE[index].light, "marker": PALETTE[index].marker, "markersize": 3, "linewidth": 0.9}
        axes.plot([each.threshold for each in asked], sizes, label=str(intent), **look)
    axes.set(yscale="log", xlim=(0, 1), xlabel="k")
