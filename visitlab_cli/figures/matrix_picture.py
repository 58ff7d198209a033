"""Every trained human against every human as two heat maps, frozen and adapting, with the numbers in their cells."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from visitlab_cli.pictures.style import FONT_SIZE, GREY, INK, SMALL, STYLE, VERMILION, save, styled
from visitlab_cli.pictures.words import fitting, height_of, in_lines, width_of
from visitlab_cli.results.matrix import ADAPTING, FROZEN, MODES, Goals, Matrix, Pairing

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

COLOURS = "cividis"  # the same to people with and without colour vision deficiency; grows lighter evenly
CELL_WIDTH, CELL_HEIGHT = 0.78, 0.5  # inches
MARGIN_WIDTH, MARGIN_HEIGHT = 1.5, 0.85  # beside and above the names and the caption
NAME_WIDTH, NAME_HEIGHT, NAME_EDGE = 1.4, 1.3, 0.06
"""How wide a row's name may be, how high a column's, and what is kept free around both."""
LIGHT = 0.52  # of the colours from which on dark numbers are read better
TITLES = {FROZEN: "frozen", ADAPTING: "adapting"}


class Names(NamedTuple):
    """The humans' names in lines, each with its font size."""

    rows: list[tuple[str, float]]
    columns: list[tuple[str, float]]

    @property
    def width(self) -> float:
        """Inches that the rows' names take."""
        return max(width_of(line, size) for text, size in self.rows for line in text.splitlines())

    @property
    def height(self) -> float:
        """Inches that the columns' names take."""
        return max(height_of(text, size) for text, size in self.columns)


def save_matrix(matrix: Matrix, target: Path) -> None:
    """Write the picture in the format of the target's ending: svg, png or pdf; the same bytes for the same matrix.

    Raises:
        UsageError: what is there is not visitlab's.
        RunError: it cannot be written.
    """
    with styled(STYLE):
        save(draw_matrix(matrix), target)


def draw_matrix(matrix: Matrix) -> "Figure":
    """Rows: the human trained with; columns: the human met; one colour scale for both panels.

    A frame marks those who were trained with the human that they meet.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

    names = Names(
        [fitting(name, NAME_WIDTH, CELL_HEIGHT - NAME_EDGE, FONT_SIZE) for name in matrix.trained],
        [fitting(name, CELL_WIDTH - NAME_EDGE, NAME_HEIGHT, FONT_SIZE) for name in matrix.met],
    )
    width = len(MODES) * len(names.columns) * CELL_WIDTH + names.width + MARGIN_WIDTH
    caption = in_lines(_caption(matrix), width - 2 * NAME_EDGE, SMALL)
    height = len(names.rows) * CELL_HEIGHT + names.height + height_of(caption, SMALL) + MARGIN_HEIGHT
    figure = Figure(figsize=(width, height), layout="constrained")
    panels = figure.subplots(1, len(MODES), sharey=True, squeeze=False)[0]
    known = [goals.value.mean for goals in matrix.goals.values() if goals.value]
    scale = Normalize(0.0, max(known, default=0.0) or 1.0)
    for axes, mode in zip(panels, MODES, strict=True):
        _draw_panel(axes, matrix, mode, scale)
        _name(axes.xaxis, names.columns)
    _name(panels[0].yaxis, names.rows)
    panels[0].set_ylabel("trained with")
    bar = figure.colorbar(ScalarMappable(scale, COLOURS), ax=panels, pad=0.02, label="goals a trial")
    bar.outline.set_visible(False)
    figure.supxlabel(caption, fontsize=SMALL, color=GREY, linespacing=1.2)
    return figure


def _caption(matrix: Matrix) -> str:
    told = (
        f"{matrix.visit} with {matrix.social}, {matrix.n}: mean ± half of the 95% interval; "
        f"frozen: all {matrix.trials:,} trials, adapting: their last tenth; framed: who was trained with"
    )
    return f"{told}. {matrix.rows}" if matrix.rows else told


def _draw_panel(axes: "Axes", matrix: Matrix, mode: str, scale: "Normalize") -> None:
    from matplotlib.patches import Rectangle

    trained, met = matrix.trained, matrix.met
    found = [[matrix.goals[Pairing(row, column, mode)] for column in met] for row in trained]
    means = np.array([[goals.value.mean if goals.value else np.nan for goals in row] for row in found])
    axes.imshow(means, cmap=COLOURS, norm=scale, aspect="auto")
    for row, column in np.ndindex(means.shape):
        colour = INK if np.isnan(means[row, column]) or scale(means[row, column]) > LIGHT else "white"
        axes.text(column, row, _words(found[row][column]), ha="center", va="center", color=colour, linespacing=1.4)
        if trained[row].rpartition("/")[2] == met[column]:
            axes.add_patch(Rectangle((column - 0.47, row - 0.46), 0.94, 0.92, fill=False, color=VERMILION, lw=1.6))
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    axes.set_title(TITLES[mode])
    axes.set_xlabel("leads")


def _name(axis: "Axis", names: Sequence[tuple[str, float]]) -> None:
    axis.set_ticks(range(len(names)), [text for text, _ in names])
    for label, (_, size) in zip(axis.get_ticklabels(), names, strict=True):
        label.set_fontsize(size)


def _words(goals: Goals) -> str:
    if goals.value is None:
        return "–"
    half = "" if np.isnan(goals.value.half) else f"\n± {goals.value.half:.2f}"
    return f"{goals.value.mean:.2f}{half}"
