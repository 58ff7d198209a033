"""What several models believe, drawn: all as one, whose each model is, each learned Fig. 4, and where they differ."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from visitlab_cli.affordances.changes_picture import arrow_name
from visitlab_cli.affordances.graph_picture import HEIGHT, WIDTH, draw_graph, draw_small_graph
from visitlab_cli.affordances.picture import EDGE, GAP, GRAPH, NAMES, TITLE, TITLE_SIZE, Sheet, check_ending, in_words
from visitlab_cli.affordances.several import COMPARED, OfModel, Several, Verdict
from visitlab_cli.colours import PALETTE
from visitlab_cli.pictures.style import GREY, INK, PAGE, SMALL, STYLE, save, styled
from visitlab_cli.pictures.words import fitting, height_of, in_lines

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# In inches.
ACROSS = 3
SMALL_GRAPH = (PAGE - (ACROSS + 1) * EDGE) / ACROSS
LINE, VERDICTS, AXIS, BELOW = 0.24, 1.15, 0.37, 0.08
ABOVE = 0.2
MODEL_NAMES, TOP_NAMES = 0.62, 0.5
MARKER, MARKER_PLACE = 3.4, 5.6
"""The size of a model's marker beside its name, and how far left of the table its middle is, in points."""
DARK = 0.6
"""A share of a model's steps from which on its number is written in white."""
SPREAD = 0.6
"""Of a line that the models take, one above the other."""
DIFFERS = (Verdict.DEGREE, Verdict.SPECIFIC)
"""What is said in ink and coloured in the small graphs; all else is grey."""
SPACING = 1.3
MEANING = (
    "General: each model affords it, in more than 1 of 20 tries; by degree: and two models differ; specific: two "
    "differ, and not each affords it (99% intervals).\nWhat depends on engagement is counted where the distance is "
    "right, in the graphs, too; all else at any distance. Ticks: true of the model's human.\n"
    "Coloured in the small graphs: by degree and specific; losing attention, if it is for any way of moving. Grey: all "
    "else.\nNot compared, so grey and not below: go to view, which teleports in training and walks in a visit."
)


def save_several(found: Several, target: Path) -> None:
    """Write the picture as .svg, .png or .pdf; the same bytes for the same models.

    Raises:
        UsageError: another ending.
        RunError: it cannot be written.
    """
    check_ending(target)
    with styled(STYLE):
        save(draw_several(found), target)


def draw_several(found: Several) -> "Figure":
    """Above all models as one and whose each is; each model's graph; a line for each arrow."""
    rows = -(-len(found.models) // ACROSS)
    small = SMALL_GRAPH * HEIGHT / WIDTH
    big = TITLE + 0.14 + GRAPH * HEIGHT / WIDTH + GAP
    lines = LINE * len(COMPARED)
    titles = [in_lines(_title(model), SMALL_GRAPH - EDGE, TITLE_SIZE, "bold") for model in found.models]
    above = ABOVE + max(height_of(title, TITLE_SIZE) for title in titles)
    last = GAP + ABOVE + height_of("", TITLE_SIZE)
    sheet = Sheet(big + rows * (above + small) + last + lines + AXIS + height_of(MEANING, SPACING * SMALL) + BELOW)
    sheet.top = TITLE + 0.14
    _draw_whose(sheet, found)
    draw_graph(
        sheet.axes(EDGE, GRAPH, GRAPH * HEIGHT / WIDTH), found.compared, "All models as one (times tried)", true=False
    )
    sheet.top = big
    differing = {arrow for arrow, verdict in found.verdicts.items() if verdict in DIFFERS}
    for place, (model, title) in enumerate(zip(found.models, titles, strict=True)):
        column = place % ACROSS
        sheet.top = big + place // ACROSS * (above + small) + above
        axes = sheet.axes(EDGE + column * (SMALL_GRAPH + EDGE), SMALL_GRAPH, small)
        draw_small_graph(axes, model.compared, title, differing)
    sheet.top = big + rows * (above + small) + last
    _draw_lines(sheet.axes(NAMES, PAGE - NAMES - VERDICTS, lines), found)
    sheet.top += lines + AXIS
    sheet.write(MEANING, fontsize=SMALL, linespacing=SPACING)
    return sheet.figure


def _title(model: OfModel) -> str:
    return f"Model {model.number}: {in_words(model.human) or 'several humans'}"


def _paint(model: OfModel) -> dict[str, Any]:
    paint = PALETTE[model.number % len(PALETTE)]
    return {"color": paint.light, "marker": paint.marker}


def _draw_whose(sheet: Sheet, found: Several) -> None:
    """A row for each model: the steps that it counts, by who was there; shaded by the share of the row."""
    from matplotlib.transforms import ScaledTranslation

    humans = ["", *found.models[0].steps]
    counted = np.array([[model.trained, *model.steps.values()] for model in found.models])
    shares = counted / counted.sum(axis=1, keepdims=True)
    sheet.top += TOP_NAMES
    left = 2 * EDGE + GRAPH + MODEL_NAMES
    height = min(0.26 * len(counted), GRAPH * HEIGHT / WIDTH - TOP_NAMES - 0.2)
    axes = sheet.axes(left, PAGE - EDGE - left, height)
    sheet.top -= TOP_NAMES
    axes.imshow(shares, cmap="Greys", vmin=0, vmax=1.25, aspect="auto")
    for row, column in np.ndindex(counted.shape):
        share = float(shares[row, column])
        text = axes.text(column, row, f"{counted[row, column]:,}" if counted[row, column] else "-")
        text.set(ha="center", va="center", fontsize=SMALL, color="white" if share > DARK else INK)
    width = (PAGE - EDGE - left) / len(humans)
    names = [fitting(in_words(human) or "before the visit", width * 0.94, TOP_NAMES - 0.1, SMALL) for human in humans]
    axes.set_xticks(range(len(humans)), [name for name, _ in names])
    axes.set_yticks(range(len(counted)), [f"model {model.number}" for model in found.models])
    beside = axes.get_yaxis_transform() + ScaledTranslation(-MARKER_PLACE / 72, 0, sheet.figure.dpi_scale_trans)
    for row, model in enumerate(found.models):
        axes.plot(0, row, markersize=MARKER, linewidth=0, clip_on=False, transform=beside, **_paint(model))
    axes.tick_params(axis="x", length=0, labelsize=min(size for _, size in names), labeltop=True, labelbottom=False)
    axes.tick_params(axis="y", length=0, labelsize=SMALL, pad=MARKER_PLACE + MARKER + 1)
    axes.set_xlim(-0.5, len(humans) - 0.5)
    axes.spines[:].set_visible(False)
    place = (left - MODEL_NAMES) / PAGE, 1 - sheet.top / sheet.height + 0.083 / sheet.height
    sheet.figure.text(*place, "Steps that each model counts, by who was there", fontsize=TITLE_SIZE, weight="bold")


def _draw_lines(axes: "Axes", found: Several) -> None:
    """A line for each arrow: what each model believes, with its interval, beside what is true; and what it is."""
    n = len(found.models)
    for row, arrow in enumerate(COMPARED):
        for place, model in enumerate(found.models):
            y = row + SPREAD * ((place + 0.5) / n - 0.5)
            belief, paint = model.beliefs[arrow], _paint(model)
            if math.isnan(belief.probability):
                continue
            axes.plot([belief.low, belief.high], [y, y], color=paint["color"], linewidth=0.8, alpha=0.6, zorder=2)
            axes.plot(belief.true, y, marker="|", color=INK, markersize=6, markeredgewidth=0.9, zorder=3)
            (drawn,) = axes.plot(belief.probability, y, markersize=2.6, linewidth=0, zorder=4, **paint)
            drawn.set_gid(f"{model.number}/{row}")
        verdict = found.verdicts[arrow]
        axes.text(1.04, row, str(verdict), va="center", fontsize=SMALL, color=INK if verdict in DIFFERS else GREY)
        if row:
            axes.axhline(row - 0.5, color="0.93", linewidth=0.5, zorder=0)
    axes.set(xlim=(-0.02, 1.02), ylim=(len(COMPARED) - 0.5, -0.5), yticks=range(len(COMPARED)))
    axes.set_yticklabels([arrow_name(arrow) for arrow in COMPARED])
    axes.tick_params(axis="y", length=0, labelsize=SMALL)
    axes.spines["left"].set_visible(False)
    axes.set_title("What is general, and what is specific", loc="left", x=-0.38)
    axes.set_xlabel("probability that each model believes", fontsize=SMALL, color=INK)
