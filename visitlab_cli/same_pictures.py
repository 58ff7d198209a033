"""matplotlib without anything of the user's: the same picture, byte for byte, wherever it is drawn."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from visitlab_cli.surroundings import within_package

FONT = "DejaVu Sans"
ALWAYS: Any = {
    "font.family": FONT,
    "pdf.fonttype": 42,
    "svg.hashsalt": "visitlab",
    "text.parse_math": False,  # a dollar in a name is a dollar
}


@contextmanager
def same_pictures(style: Any) -> Iterator[None]:
    """Draw and save in here: with matplotlib's own settings and fonts, `ALWAYS` and `style`.

    Raises:
        ModuleNotFoundError: there is no matplotlib.
    """
    matplotlib = _matplotlib()
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(ALWAYS | style)
        yield


def _matplotlib() -> Any:
    """matplotlib, imported where no settings of the user's lie, and knowing no fonts but those that it brings."""
    new = "matplotlib.font_manager" not in sys.modules
    with within_package("matplotlib", "mpl-data"):
        import matplotlib
        from matplotlib import font_manager
    if new:
        own = Path(matplotlib.get_data_path())
        font_manager.fontManager.ttflist.clear()
        for file in sorted((own / "fonts" / "ttf").glob(f"{FONT.replace(' ', '')}*.ttf")):
            font_manager.fontManager.addfont(file)
    return matplotlib
