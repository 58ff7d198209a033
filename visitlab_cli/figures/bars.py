"""Panels of bars side by side, a row for each condition: means with their intervals and numbers."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from visitlab_cli.colours import PALETTE
from visitlab_cli.pictures.style import GREY, INK, PAGE, SMALL
from visitlab_cli.pictures.words import height_of
from visitlab_cli.results.estimates import Estimate
from visitlab_cli.results.units import Units, mean_over

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

BAR, THICK = 0.2, 0.66
"""Inches from bar to bar, and the part of that which is bar."""
HEAD, FOOT, KEY = 0.3, 0.75, 0.2  # inches
KEY_SIZE = SMALL + 0.4
ROOM, NUMBER = 1.08, 0.32
"""How far an axis goes beyond the longest bar, and inches for its number."""


class Bar(NamedTuple):
    """A mean, and over how many it is one."""

    value: Estimate
    units: Units


class Panel(NamedTuple):
    """Bars by their rows; a row may have none."""

    title: str
    measure: str
    bars: Mapping[str, Bar]


def draw_bars(
    rows: Mapping[str, str], panels: Sequence[Panel], note: str, kinds: Mapping[str, str], *, shared: bool = False
) -> "Figure":
    """A figure of the panels.

    Args:
        rows: what each row is called, by its name.
        panels: what is drawn.
        note: said below, in lines.
        kinds: of what kind each row is, which its colour tells; a key says so where there are several.
        shared: whether all panels have the same axis.
    """
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine
    from matplotlib.patches import Patch
    from matplotlib.ticker import MaxNLocator

    several = list(dict.fromkeys(kinds[row] for row in rows))
    colours = {kind: PALETTE[place % len(PALETTE)].light for place, kind in enumerate(several)}
    more = height_of(note, SMALL) - height_of("", SMALL)
    height = len(rows) * BAR + HEAD + FOOT + more + (KEY if len(several) > 1 else 0)
    figure = Figure(figsize=(PAGE, height), layout=ConstrainedLayoutEngine(w_pad=0.05, h_pad=0.05, wspace=0.02))
    drawn = figure.subplots(1, len(panels), sharey=True, squeeze=False)[0]
    room = ROOM * PAGE / (PAGE - NUMBER * len(panels))
    ends = [room * max(_ends(bar) for bar in panel.bars.values()) for panel in panels]
    for axes, panel, end in zip(drawn, panels, ends, strict=True):
        _draw(axes, panel, {row: colours[kinds[row]] for row in rows})
        axes.set_xlim(0, (max(ends) if shared else end) or 1)
        axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
    drawn[0].set_yticks(range(len(rows)), [*rows.values()])
    drawn[0].invert_yaxis()  # all share it
    keys = [Patch(color=colour, alpha=0.75, linewidth=0, label=kind) for kind, colour in colours.items()]
    draw_note(figure, note, keys if len(several) > 1 else [], len(keys))
    return figure


def draw_note(figure: "Figure", note: str, keys: Sequence["Artist"], columns: int) -> None:
    """Say something below a figure, and under it the key, if there is one."""
    if not keys:
        figure.supxlabel(note, fontsize=SMALL, color=GREY)
        return
    place: Any = {"loc": "outside lower center", "ncols": columns, "handlelength": 2.6, "columnspacing": 1.4}
    key = figure.legend(handles=[*keys], title=note, title_fontsize=SMALL, fontsize=KEY_SIZE, **place)
    key.get_title().set_color(GREY)


def _ends(bar: Bar) -> float:
    """Where the line of its interval ends."""
    mean, half = bar.value
    return mean + (0.0 if math.isnan(half) else half)


def _draw(axes: "Axes", panel: Panel, rows: Mapping[str, str]) -> None:
    """The bars of a panel; `rows` has the colour of each."""
    for place, (row, colour) in enumerate(rows.items()):
        if row not in panel.bars:
            continue
        bar = panel.bars[row]
        mean, end = bar.value.mean, _ends(bar)
        axes.barh(place, mean, THICK, color=colour, alpha=0.75, linewidth=0, gid=f"{panel.title}/{row}")
        if end > mean:
            axes.plot([max(2 * mean - end, 0), end], [place, place], color=INK, linewidth=0.9)
        axes.text(end, place, f"  {mean:.2f}", fontsize=SMALL, color=INK, va="center")
    axes.tick_params(axis="y", length=0)
    axes.set_title(panel.title, loc="left")
    axes.set_xlabel(f"{panel.measure}\n({mean_over([bar.units for bar in panel.bars.values()])})")
