"""The paper's Fig. 4 with numbers: levels as circles, an arrow for each gesture, as learned or as it truly is."""

import math
from collections.abc import Set
from typing import TYPE_CHECKING, Any, NamedTuple

from visitlab_cli.affordances.learned import Graph
from visitlab_cli.affordances.plain import ARROWS, Arrow, Weight, weight
from visitlab_cli.affordances.truth import NOT_ENGAGED
from visitlab_cli.pictures.style import GREY, INK, SMALL, VERMILION
from visitlab_cli.scene.colours import ACTION_COLOURS, shares
from visitlab_cli.scene.words import ACTION_KINDS, CALLS, GOES, LEVEL_NAMES, LOOKS, MOVES, POINTS, SAYS_HELLO
from visitlab_cli.world.enums import InteractionLevel

if TYPE_CHECKING:
    from matplotlib.axes import Axes

PLACES = ((0.95, 4.3), (0.95, 1.1), (3.1, 5.5), (3.6, 1.1), (4.5, 3.2), (6.7, 1.9), (7.9, 0.7), (9.3, 2.9))
"""Where the middle of each level's circle lies; the drawing is 10.2 wide and 7 high."""
NAMES = ((0, -0.5), (0, -0.5), (0, 0.75), (0, -0.5), (-0.1, -0.5), (0.1, 0.75), (0, -0.5), (0.35, -0.5))
"""Where, from there, the top of its name's middle lies."""
LABELS = (
    *((1.35, 5.35), (2.4, 3.2), (2.3, 1.55), (4.75, 4.65), (5.1, 0.8), (6.3, 3.2)),
    *((6.65, 0.85), (7.75, 3.0), (9.35, 1.3)),
)
"""Where the middle of the label of each of the first arrows lies."""
SMALL_LABELS = (*LABELS[:4], (4.7, 0.8), *LABELS[5:])
LOSSES = (5.75, 4.75)
"""Where the words on losing attention end below, at the left."""
LOST = tuple(arrow for arrow in ARROWS if arrow.outcome == NOT_ENGAGED)
"""The last arrows: what loses attention. They are drawn as one."""
PALE = "0.78"
WIDTH, HEIGHT, RADIUS = 10.2, 7.0, 0.42
UNENGAGED = (0.05, 0.1, 5.5, 6.5)
"""West, south, east and north of the box around the levels 0 to 4."""
THICKEST, THINNEST = 3.2, 0.5
"""Of an arrow, in points: certain, and never."""
KIND_NAMES = {"go_to_human_vision": "go to view", "look": "look", "hello": "hello", "come": "come", "point": "point"}
_KIND_OF = {"go_to_human_vision": GOES, "look": LOOKS, "hello": SAYS_HELLO, "come": CALLS, "point": POINTS}


class Told(NamedTuple):
    """What is written at an arrow; `probability` is nan where there is nothing to say."""

    probability: float
    text: str


def colour_of(arrow: Arrow) -> tuple[float, float, float]:
    """The colour of an arrow's action, as in the replay."""
    return shares(ACTION_COLOURS[ACTION_KINDS.index(_KIND_OF.get(str(arrow.kind), MOVES))])


def as_learned(found: Weight) -> Told:
    """The learned probability, and the visits behind it."""
    if not found.visits:
        return Told(math.nan, "never tried")
    return Told(found.learned, f"{found.learned:.3f} ({found.visits:,})")


def as_true(found: Weight) -> Told:
    """The true probability, or its range."""
    if math.isnan(found.low):
        return Told(math.nan, "varies" if found.visits else "never tried")
    low, high = f"{found.low:.3f}", f"{found.high:.3f}"
    return Told((found.low + found.high) / 2, low if low == high else f"{low} to {high}")


def draw_graph(axes: "Axes", graph: Graph, title: str, *, true: bool) -> None:
    """Draw the learned graph, or the true one for the same visits."""
    _empty(axes, title)
    west, _, _, north = UNENGAGED
    axes.text(west + 0.2, north - 0.15, "not engaged", fontsize=SMALL, color=GREY, va="top", style="italic")
    tell = as_true if true else as_learned
    for arrow, label in zip(ARROWS, LABELS, strict=False):
        told = tell(weight(graph, arrow))
        _draw_arrow(axes, arrow, told, colour_of(arrow))
        _write(axes, arrow, label, _two_lines(KIND_NAMES[str(arrow.kind)], told.text))
    _draw_loss(axes, GREY)
    lines = [f"{arrow.kind}: {tell(weight(graph, arrow)).text}" for arrow in LOST]
    _write_losses(axes, "\n".join(["loses attention, the robot moving", *lines]))
    _draw_levels(axes, 8)
    for (x, y), (right, up), name in zip(PLACES, NAMES, LEVEL_NAMES, strict=True):
        axes.text(x + right, y + up, name, ha="center", va="top", fontsize=SMALL, weight="bold", zorder=5)


def draw_small_graph(axes: "Axes", graph: Graph, title: str, coloured: Set[Arrow]) -> None:
    """Draw the learned graph small: no names, no visits; arrows are grey but for some."""
    _empty(axes, title)
    for arrow, label in zip(ARROWS, SMALL_LABELS, strict=False):
        found = weight(graph, arrow)
        told = Told(found.learned, f"{found.learned:.2f}" if found.visits else "-")
        _draw_arrow(axes, arrow, told, colour_of(arrow) if arrow in coloured else PALE, shrink=6)
        _write(axes, arrow, label, told.text)
    _draw_loss(axes, PALE if coloured.isdisjoint(LOST) else VERMILION)  # moves are grey
    lost = [found.learned for arrow in LOST if (found := weight(graph, arrow)).visits]
    ends = f"{min(lost):.2f} to {max(lost):.2f}" if lost else "never there"
    _write_losses(axes, f"loses attention\n{ends}")
    _draw_levels(axes, SMALL)


def _empty(axes: "Axes", title: str) -> None:
    """Nothing but the box around the levels without engagement."""
    from matplotlib.patches import FancyBboxPatch

    axes.set(xlim=(0, WIDTH), ylim=(0, HEIGHT), aspect="equal")
    axes.set_axis_off()
    axes.set_title(title, loc="left")
    west, south, east, north = UNENGAGED
    box: Any = {"boxstyle": "round,pad=0,rounding_size=0.3", "facecolor": "0.965", "edgecolor": "0.8", "linewidth": 0.5}
    axes.add_patch(FancyBboxPatch((west, south), east - west, north - south, **box))


def _draw_levels(axes: "Axes", size: float) -> None:
    """A circle for each, with its number."""
    from matplotlib.patches import Circle

    for level, (x, y) in enumerate(PLACES):
        engaged = level >= InteractionLevel.GREETED
        circle = Circle((x, y), RADIUS, facecolor="white", edgecolor=INK, linewidth=1.2 if engaged else 0.8, zorder=4)
        axes.add_patch(circle)
        axes.text(x, y - 0.02, str(level), ha="center", va="center", weight="bold", fontsize=size, zorder=5)


def _draw_arrow(axes: "Axes", arrow: Arrow, told: Told, colour: Any, shrink: float = 10) -> None:
    """From circle to circle, as thick as it is probable; dotted where nothing is known."""
    from matplotlib.patches import FancyArrowPatch

    (x, y), (to_x, to_y) = PLACES[arrow.level], PLACES[arrow.outcome]
    known = not math.isnan(told.probability)
    width = THINNEST + (THICKEST - THINNEST) * told.probability if known else THINNEST
    head = f"-|>,head_width={0.07 * width + 0.12},head_length={0.1 * width + 0.22}"
    look: Any = {"linestyle": "-" if known else (0, (1, 2)), "shrinkA": shrink, "shrinkB": shrink, "arrowstyle": head}
    for shade, extra, order in ((INK, 0.7, 2), (colour, 0.0, 3)):
        drawn = FancyArrowPatch(
            (x, y), (to_x, to_y), color=shade, linewidth=width + extra, mutation_scale=8, zorder=order, **look
        )
        axes.add_patch(drawn)
    drawn.set_gid(_name_of(arrow))  # the upper one


def _write(axes: "Axes", arrow: Arrow, place: tuple[float, float], words: str) -> None:
    text = axes.text(*place, words)
    text.set(ha="center", va="center", fontsize=SMALL, linespacing=1.1, zorder=6)
    text.set_gid(_name_of(arrow))


def _name_of(arrow: Arrow) -> str:
    return f"{arrow.kind}/{int(arrow.level)}/{arrow.outcome}"


def _two_lines(name: str, told: str) -> str:
    """An action and what is told of it: the visits below, or all that is longer than a word."""
    first, _, visits = told.partition(" (")
    if visits:
        return f"{name} {first}\n({visits}"
    return f"{name} {told}" if " " not in told else f"{name}\n{told}"


def _draw_loss(axes: "Axes", colour: Any) -> None:
    """Back from following: one arrow for all that loses attention."""
    from matplotlib.patches import FancyArrowPatch

    east = UNENGAGED[2]
    x, y = PLACES[InteractionLevel.FOLLOWS]
    _, below = LOSSES
    style: Any = {"arrowstyle": "-|>", "connectionstyle": "angle3,angleA=90,angleB=0", "mutation_scale": 7}
    start, end = (x, y + RADIUS), (east, below - 0.2)
    drawn = FancyArrowPatch(start, end, color=colour, linewidth=1.0, linestyle=(0, (4, 1.5)), zorder=2, **style)
    drawn.set_gid("loss")
    axes.add_patch(drawn)


def _write_losses(axes: "Axes", words: str) -> None:
    """What each way of moving costs."""
    text = axes.text(*LOSSES, words)
    text.set(fontsize=SMALL, linespacing=1.15, va="bottom")
    text.set_gid("losses")
