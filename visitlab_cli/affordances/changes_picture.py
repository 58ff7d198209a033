"""How what is believed changes in a visit: each arrow's probability before and after, beside the truth."""

import math
from typing import TYPE_CHECKING, Any

from visitlab_cli.affordances.graph_picture import KIND_NAMES
from visitlab_cli.affordances.learned import Adaptation, Affordances, Graph
from visitlab_cli.affordances.plain import ARROWS, Arrow, weight
from visitlab_cli.pictures.style import BLUE, GREY, INK, SMALL, VERMILION
from visitlab_cli.scene.words import LEVEL_NAMES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BEFORE, AFTER, TRUE = "before", "after", "true"
LOOKS: dict[str, Any] = {
    BEFORE: {"marker": "o", "markerfacecolor": "white", "markeredgecolor": GREY, "markersize": 5.2, "label": "before"},
    AFTER: {"marker": "o", "color": BLUE, "markersize": 3.4, "label": "after the visit"},
    TRUE: {
        "marker": "|",
        "color": VERMILION,
        "markersize": 9,
        "markeredgewidth": 1.6,
        "label": "true in the visit",
    },
}


def arrow_name(arrow: Arrow) -> str:
    """An arrow in words: 'hello: Robot faces to Greeted'."""
    outcome = LEVEL_NAMES[arrow.outcome] if arrow.outcome < len(LEVEL_NAMES) else "not engaged"
    return f"{KIND_NAMES.get(str(arrow.kind), str(arrow.kind))}: {LEVEL_NAMES[arrow.level]} to {outcome}"


def draw_changes(axes: "Axes", found: Affordances, adaptation: Adaptation, title: str, *, named: bool) -> None:
    """A line for each arrow of Fig. 4; at its end how often it was tried before, and in the visit.

    Args:
        axes: where.
        found: the module before.
        adaptation: after a visit.
        title: says whom it visited.
        named: whether the arrows' names stand at the left.
    """
    rows = range(len(ARROWS))
    for row, arrow in zip(rows, ARROWS, strict=True):
        before, after, saw = (weight(graph, arrow) for graph in (found.knows, adaptation.knows, adaptation.saw))
        if before.visits and after.visits:
            axes.plot([before.learned, after.learned], [row, row], color=GREY, linewidth=1.0, zorder=1)
        axes.text(1.1, row, f"{before.visits:,} + {saw.visits:,}", va="center", fontsize=5, color=GREY)
    _draw_points(axes, found.knows, BEFORE, 2)
    _draw_points(axes, adaptation.knows, AFTER, 4)
    truth = [_middle(adaptation.saw, arrow) for arrow in ARROWS]
    (drawn,) = axes.plot(truth, rows, linestyle="", zorder=3, **LOOKS[TRUE])
    drawn.set_gid(f"{TRUE}/{adaptation.cell.human}")
    axes.set(xlim=(-0.05, 1.72), ylim=(len(ARROWS) - 0.4, -0.6), yticks=rows, xticks=(0, 0.5, 1))
    axes.set_yticklabels([arrow_name(arrow) for arrow in ARROWS] if named else [])
    axes.tick_params(axis="y", length=0, labelsize=SMALL)
    axes.spines["left"].set_visible(False)
    axes.spines["bottom"].set_bounds(0, 1)
    axes.set_title(title, loc="left")
    axes.set_xlabel("probability (tried before + in the visit)", fontsize=SMALL, color=INK)
    axes.grid(axis="y", color="0.93", linewidth=0.5)


def _draw_points(axes: "Axes", graph: Graph, when: str, order: int) -> None:
    learned = [weight(graph, arrow).learned for arrow in ARROWS]
    (drawn,) = axes.plot(learned, range(len(ARROWS)), linestyle="", zorder=order, **LOOKS[when])
    drawn.set_gid(when)


def _middle(graph: Graph, arrow: Arrow) -> float:
    """The middle of the true range at the visits of a graph; nan where it is not decided."""
    found = weight(graph, arrow)
    return math.nan if math.isnan(found.low) else (found.low + found.high) / 2
