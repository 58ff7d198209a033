"""Labs as a picture: a panel for each, its rooms, walls, and doors that are shut."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from visitlab_cli.pictures.style import PAGE, STYLE, save, styled
from visitlab_cli.replay import panel
from visitlab_cli.scene.lab import lab_shapes
from visitlab_cli.world.lab import Lab, open_at_first

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ACROSS = 3
"""Panels side by side."""
TITLE, EDGE = 0.3, 0.06  # inches
MARGIN = 0.4
"""Around a lab, in cells."""


def save_labs(labs: Mapping[str, Lab], target: Path) -> None:
    """Write the picture in the format of the target's ending: svg, png or pdf.

    Raises:
        UsageError: what is there is not visitlab's.
        RunError: it cannot be written.
    """
    with styled(STYLE):
        save(draw_labs(labs), target)


def draw_labs(labs: Mapping[str, Lab]) -> "Figure":
    """All of them to the scale of the one with most cells across, each under its name."""
    from matplotlib.figure import Figure

    across = min(ACROSS, len(labs))
    down = math.ceil(len(labs) / across)
    widest = max(lab.cols for lab in labs.values()) + 2 * MARGIN
    side = PAGE / across - EDGE
    rows = [list(labs.values())[row * across : (row + 1) * across] for row in range(down)]
    tall = [side / widest * (max(lab.rows for lab in row) + 2 * MARGIN) for row in rows]
    height = sum(tall) + down * TITLE + EDGE
    figure = Figure(figsize=(PAGE, height))
    for place, (name, lab) in enumerate(labs.items()):
        row, col = divmod(place, across)
        bottom = (row + 1) * TITLE + sum(tall[: row + 1])
        left = col * (side + EDGE) + EDGE / 2
        axes = figure.add_axes((left / PAGE, 1 - bottom / height, side / PAGE, tall[row] / height))
        axes.set(xlim=(-MARGIN, widest - MARGIN), ylim=(tall[row] * widest / side - MARGIN, -MARGIN), aspect="equal")
        panel.draw_shapes(axes, lab_shapes(lab, open_at_first(lab)))
        axes.set_axis_off()
        axes.set_title(name, loc="left")
    return figure
