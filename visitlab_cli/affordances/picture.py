"""What a social module believes, as a picture.

The learned Fig. 4 beside the true one, what it would do around the human, and how both change while it adapts to
another human.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visitlab_cli.affordances.changes_picture import draw_changes
from visitlab_cli.affordances.graph_picture import HEIGHT, WIDTH, draw_graph
from visitlab_cli.affordances.learned import Affordances
from visitlab_cli.affordances.maps_picture import draw_map, key
from visitlab_cli.errors import UsageError
from visitlab_cli.pictures.style import FORMATS, GREY, INK, PAGE, SMALL, STYLE, save, styled
from visitlab_cli.pictures.words import fitting, height_of, in_lines
from visitlab_cli.scene.words import LEVEL_NAMES
from visitlab_cli.world.enums import N_LEVELS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# In inches.
EDGE, TITLE, GAP = 0.08, 0.12, 0.12
GRAPH = (PAGE - 3 * EDGE) / 2
NAMES, CHANGE, LINES, BELOW, TRUTHS = 1.72, 1.8, 2.25, 0.56, 0.26
MAPS_TITLE, ROW_NAME, MAP, WORDS = 0.36, 0.56, 0.83, 0.66
ROW_WORDS = 0.48
"""What the words of a row's name may take of it."""
TITLE_SIZE = 8
MOST_VISITS = 3
"""Visits that are shown; the others are in `--json`."""
TWO_TRUTHS = (
    "True: what the human's parameters give, averaged over the distances at which the action was tried. These are "
    "others in the training\n(the graph at the top) than in the visit (red, here): one arrow can have two true values, "
    "even for one human."
)


class Sheet:
    """A figure that is filled from the top, in inches."""

    def __init__(self, height: float) -> None:
        """Begin a page of this height."""
        from matplotlib.figure import Figure

        self.figure = Figure(figsize=(PAGE, height))
        self.height = height
        self.top = 0.0

    def axes(self, left: float, width: float, height: float) -> "Axes":
        """Axes whose upper edge lies at `top`."""
        bottom = self.height - self.top - height
        return self.figure.add_axes(
            (left / PAGE, bottom / self.height, width / PAGE, height / self.height), facecolor="none"
        )

    def write(self, words: str, **look: Any) -> None:
        """Words below `top`, at the left."""
        self.figure.text(EDGE / PAGE, 1 - self.top / self.height, words, va="top", **look)


def save_affordances(found: Affordances, target: Path) -> None:
    """Write the picture as .svg, .png or .pdf; the same bytes for the same module.

    Raises:
        UsageError: another ending.
        RunError: it cannot be written.
    """
    check_ending(target)
    with styled(STYLE):
        save(draw_affordances(found), target)


def check_ending(target: Path) -> None:
    """Refuse a picture's file of another ending."""
    if target.suffix[1:] not in FORMATS:
        raise UsageError(f"--picture {target}: must end in {', '.join(f'.{kind}' for kind in FORMATS)}")


def draw_affordances(found: Affordances) -> "Figure":
    """The graphs; what each visit changed; the maps, a row for the trained module and one for each visit."""
    visits = found.adaptations[:MOST_VISITS]
    above_graphs, above_changes = graph_titles(found), change_titles(found)
    graphs = room_for(above_graphs) + GRAPH * HEIGHT / WIDTH + GAP
    changes = room_for(above_changes) + LINES + BELOW + TRUTHS + GAP if visits else 0.0
    maps = MAPS_TITLE + MAP * (1 + len(visits)) + WORDS
    sheet = Sheet(graphs + changes + maps)
    _graphs(sheet, found, above_graphs)
    if visits:
        _changes(sheet, found, above_changes)
    _maps(sheet, found)
    return sheet.figure


def in_words(human: str) -> str:
    """A human's name as a reader says it: 'human 2 pointing'."""
    return human.replace("_", " ")


def graph_titles(found: Affordances) -> list[str]:
    """Of the learned graph and the true one, in lines."""
    human = in_words(" and ".join(found.cell.humans))
    titles = (
        f"Learned with {in_words(found.learned_with)}: probability (times tried)",
        f"True for {human} (varies: with where both stand)"
        if len(found.cell.humans) == 1
        else f"No single truth of {human}",
    )
    return [in_lines(title, GRAPH - EDGE, TITLE_SIZE, "bold") for title in titles]


def change_titles(found: Affordances) -> list[str]:
    """Of what each visit changed, in lines."""
    titles = [f"Visiting {in_words(visit.cell.human)}" for visit in found.adaptations[:MOST_VISITS]]
    return [in_lines(title, CHANGE - GAP, TITLE_SIZE, "bold") for title in titles]


def room_for(titles: Sequence[str]) -> float:
    """The height that titles side by side need."""
    return TITLE + max((height_of(title, TITLE_SIZE) for title in titles), default=0.0)


def _graphs(sheet: Sheet, found: Affordances, titles: Sequence[str]) -> None:
    sheet.top += room_for(titles)
    height = GRAPH * HEIGHT / WIDTH
    learned, true = sheet.axes(EDGE, GRAPH, height), sheet.axes(2 * EDGE + GRAPH, GRAPH, height)
    draw_graph(learned, found.knows, titles[0], true=False)
    draw_graph(true, found.knows, titles[1], true=True)
    sheet.top += height + GAP


def _changes(sheet: Sheet, found: Affordances, titles: Sequence[str]) -> None:
    sheet.top += room_for(titles)
    for index, (visit, title) in enumerate(zip(found.adaptations, titles, strict=False)):
        axes = sheet.axes(NAMES + index * CHANGE, CHANGE - GAP, LINES)
        draw_changes(axes, found, visit, title, named=index == 0)
        if index == 0:
            place: Any = {"loc": "upper right", "bbox_to_anchor": (-0.02, -0.02), "handletextpad": 0.3}
            axes.legend(borderaxespad=0, **place)
    sheet.top += LINES + BELOW
    sheet.write(TWO_TRUTHS, fontsize=SMALL, linespacing=1.3)
    sheet.top += TRUTHS + GAP


def _maps(sheet: Sheet, found: Affordances) -> None:
    from matplotlib.patches import Patch

    visits = found.adaptations[:MOST_VISITS]
    rows = [("trained with", found.learned_with, found.policy)]
    rows += [("after visiting", visit.cell.human, visit.policy) for visit in visits]
    sheet.write("Best action around the human, by level", fontsize=8, weight="bold")
    sheet.top += MAPS_TITLE
    for index, (what, human, policy) in enumerate(rows):
        name, size = fitting(in_words(human), MAP, ROW_WORDS - height_of(what, SMALL), SMALL)
        for level in range(N_LEVELS):
            axes = sheet.axes(ROW_NAME + level * MAP, MAP * 0.98, MAP * 0.98)
            draw_map(axes, policy, level, found.policy if index else None)
            if index == 0:
                axes.set_title(f"{level} {LEVEL_NAMES[level]}", fontsize=SMALL, pad=3)
            if level == 0:
                axes.set_ylabel(f"{what}\n{name}", fontsize=size, color=INK)
        sheet.top += MAP
    sheet.top += GAP / 2
    sheet.write(_meaning(found), fontsize=SMALL, linespacing=1.3)
    handles = [Patch(facecolor=colour, edgecolor=GREY, linewidth=0.3, label=name) for name, colour in key()]
    look: Any = {"handlelength": 1.1, "columnspacing": 1.6, "handletextpad": 0.5}
    sheet.figure.legend(handles=handles, loc="lower center", ncols=len(handles), borderaxespad=0.1, **look)


def _meaning(found: Affordances) -> str:
    """What a map shows."""
    first, second, third, fourth = found.cell.config.interaction.distances
    rings = f"up to {first}, {_between(first, second)}, {_between(second, third)}, {_between(third, fourth)}, more"
    changed = "; outlined: not the best before the visit" if found.adaptations else ""
    return (
        "In the middle the human; up is the desired direction. A sector is where the robot stands, a ring how far "
        f"({rings} cells);\nbetween the circles the distance is right. Arrow: where the robot moves, longer is faster. "
        f"Strong colour: the best action for most\nof the eight desired directions, each turned up; white: never was "
        f"there{changed}."
    )


def _between(low: int, high: int) -> str:
    return str(high) if low + 1 == high else f"{low + 1} to {high}"
