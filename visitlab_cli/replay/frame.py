"""The last step of a trial as a picture in memory: a panel of the strip, for films and notebooks."""

from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import RunError
from visitlab_cli.replay import panel
from visitlab_cli.replay.strip import FONT_SIZE, GAP, PANEL, TITLE, title_of
from visitlab_cli.same_pictures import same_pictures
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.trial import Trial

PIXELS = 608
"""The width; a multiple of 16, which video encoders like. The title makes it higher."""


def frame(trial: Trial) -> npt.NDArray[np.uint8]:
    """The picture, shape (height, width, 3), red, green and blue.

    Raises:
        RunError: matplotlib is missing.
    """
    step = trial.last_step
    width, height = PANEL + 2 * GAP, PANEL + TITLE + 2 * GAP
    resolution = PIXELS / width
    height = round(height * resolution / 16) * 16 / resolution
    try:
        with same_pictures({"font.size": FONT_SIZE}):
            from matplotlib.backends.backend_agg import FigureCanvasAgg
            from matplotlib.figure import Figure

            canvas: Any = FigureCanvasAgg(Figure(figsize=(width, height), dpi=resolution))
            side: Any = (GAP / width, GAP / height, PANEL / width, PANEL / height)
            axes = canvas.figure.add_axes(side)
            panel.draw(axes, Scene(trial), step)
            axes.spines[:].set(linewidth=0.4, color="0.5")
            axes.set_title("\n".join(title_of(trial, step)), fontsize=FONT_SIZE, loc="left", pad=2.5, linespacing=1.15)
            canvas.draw()
            picture: npt.NDArray[np.uint8] = np.asarray(canvas.buffer_rgba())[..., :3].copy()
            return picture
    except ModuleNotFoundError as error:
        raise RunError("a picture needs matplotlib; install it with pip install matplotlib") from error
