"""How figures look: colours that colour-blind people tell apart and a printer keeps apart, sizes, files."""

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from visitlab_cli.errors import RunError, reason
from visitlab_cli.origin import METADATA
from visitlab_cli.same_pictures import same_pictures
from visitlab_cli.whole_file import write_again

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Okabe and Ito's colours, and Tol's purple.
VERMILION, BLUE, GREEN, ORANGE, PURPLE = "#D55E00", "#0072B2", "#009E73", "#E69F00", "#CC79A7"
SKY, PLUM = "#56B4E9", "#AA4499"
INK, GREY = "#222222", "#666666"

PAGE = 7.2  # inches: both columns of a paper
FONT_SIZE, SMALL = 7.0, 5.8
PIXELS_PER_INCH = 300
FORMATS = tuple(METADATA)
"""The endings of pictures."""

STRIP_STYLE: Any = {"font.size": 6.5}
STYLE: Any = {
    "font.size": FONT_SIZE,
    "axes.titlesize": 8,
    "axes.titleweight": "bold",
    "axes.labelsize": FONT_SIZE,
    "axes.edgecolor": GREY,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "legend.fontsize": 6.5,
    "legend.frameon": False,
    "lines.linewidth": 1.3,
}


styled = same_pictures
"""Draw and save in here: with a style and nothing of the user's own matplotlib settings."""


def save(figure: "Figure", target: Path) -> None:
    """Write a figure in the format of its ending; the file appears whole or not at all.

    Raises:
        UsageError: `target` is there and not visitlab's.
        RunError: it cannot be written.
    """
    kind = target.suffix[1:]
    content = BytesIO()
    figure.savefig(content, format=kind, dpi=PIXELS_PER_INCH, metadata=METADATA[kind])
    write(target, content.getvalue())


def write(target: Path, content: bytes) -> None:
    """Write a picture or page, and the folder that it lies in; it appears whole or not at all.

    Raises:
        UsageError: `target` is there and not visitlab's.
        RunError: it cannot be written.
    """
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RunError(f"{target}: can't be written: {reason(error)}") from error
    write_again(target, content)
