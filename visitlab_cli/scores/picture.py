"""A scorecard as bars: a panel for each agent, a bar for each row, from 0 (random) to 1 (the best that is known)."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from visitlab_cli.colours import looks_of
from visitlab_cli.pictures.style import FONT_SIZE, GREY, INK, PAGE, SMALL, STYLE, save, styled
from visitlab_cli.pictures.words import height_of, in_lines, width_of
from visitlab_cli.scores.judging import Card, Scorecard
from visitlab_cli.scores.words import row_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANELS = 3
"""Side by side."""
BAR, THICK = 0.17, 0.66
"""Inches from bar to bar, and the part of that which is bar."""
TITLE = 8  # points
HEAD, FOOT, EDGE = 0.5, 0.45, 0.08  # inches
ROOM = 1.32
"""How far the axis goes, so that a number finds room behind a bar that reaches 1."""
LEAST = -0.08
FAR = 0.03
"""Between a bar's interval and its number, in scores."""


def save_scores(card: Scorecard, target: Path) -> None:
    """Write the picture in the format of the target's ending: svg, png or pdf; the same bytes for the same scores.

    Raises:
        UsageError: what is there is not visitlab's.
        RunError: it cannot be written.
    """
    with styled(STYLE):
        save(draw_scores(card), target)


def draw_scores(card: Scorecard) -> "Figure":
    """The rows from above; a bar is the mean over seeds, its line the 95% interval; what has no answer says so."""
    from matplotlib.figure import Figure

    rows = card.scored
    across = min(len(card.cards), PANELS)
    down = math.ceil(len(card.cards) / PANELS)
    exact = card.is_exact
    names = [row_words(row) + ("" if exact.get(row, True) else " *") for row in rows]
    caption = in_lines(_caption(card), PAGE - 2 * EDGE, SMALL)
    height = down * (len(rows) * BAR + HEAD) + height_of(caption, SMALL) + FOOT
    figure = Figure(figsize=(PAGE, height))
    left = max(width_of(name, FONT_SIZE) for name in names) + 3 * EDGE
    panels = figure.subplots(down, across, sharey=True, squeeze=False)
    figure.subplots_adjust(
        left=left / PAGE,
        right=1 - EDGE / PAGE,
        top=1 - 0.3 / height,
        bottom=(height_of(caption, SMALL) + FOOT) / height,
        wspace=0.08,
        hspace=HEAD / (len(rows) * BAR) if down > 1 else None,
    )
    looks = looks_of(each.agent for each in card.cards)
    for number, axes in enumerate(panels.flat):
        if number >= len(card.cards):
            axes.set_visible(False)
            continue
        each = card.cards[number]
        _draw(axes, each, rows, looks[each.agent].colour)
        axes.set_title(_cut(each.agent, (PAGE - left) / across))
    panels[0, 0].set_yticks(range(len(rows)), names)
    panels[0, 0].invert_yaxis()  # all share it
    for axes in panels[:, 0]:
        axes.tick_params(axis="y", length=0)
    figure.text(EDGE / PAGE, EDGE / height, caption, fontsize=SMALL, color=GREY, linespacing=1.2, va="bottom")
    return figure


def _cut(name: str, width: float) -> str:
    """A name, or as much of it as a title has room for, in inches."""
    cut = name
    while width_of(cut, TITLE, "bold") > width:
        cut = cut[:-2] + "…"
    return cut


def _draw(axes: "Axes", card: Card, rows: list[str], colour: str) -> None:
    lines = {line.row: line for line in card.lines}
    for value, style in ((0.0, "-"), (1.0, (0, (2, 3)))):
        axes.axvline(value, color=GREY, linewidth=0.7, linestyle=style)
    for place, row in enumerate(rows):
        score = lines[row].score
        if score is None:
            why = (lines[row].reason or "not known").split(";")[0]
            axes.text(
                FAR, place, why if width_of(why, SMALL) < 1.4 else "no answer", fontsize=SMALL, color=GREY, va="center"
            )
            continue
        mean, half = score
        axes.barh(place, max(mean, LEAST), THICK, color=colour, alpha=0.75, linewidth=0)
        known = 0.0 if math.isnan(half) else half
        if known:
            axes.plot([max(mean - half, LEAST), mean + half], [place, place], color=INK, linewidth=0.9)
        end = max(mean + known, 0.0)
        words = axes.text(end + FAR, place, f"{mean:z.2f}", fontsize=SMALL, color=INK, va="center")
        words.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 0.6})  # over the line at 1
    axes.set_xlim(LEAST - 0.02, ROOM)
    axes.set_xticks([0, 0.5, 1], ["random", "0.5", "best"])
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)


def _caption(card: Scorecard) -> str:
    n = max((line.n for each in card.cards for line in each.lines), default=0)
    starred = "" if all(card.is_exact.values()) else "; where a row has a star, the best that is known"
    return (
        f"Rows of {card.rows}: 0 is what random actions reach, 1 the exact optimum of whoever sees the whole state"
        f"{starred}. Bars: mean over {n} seed{'' if n == 1 else 's'}; lines: 95% intervals (Student's t)."
    )
