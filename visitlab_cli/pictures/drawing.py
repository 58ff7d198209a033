"""What drawing a figure gives."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Drawing(NamedTuple):
    """The figure, None where the run holds nothing for it, and what the reader should know of it."""

    figure: "Figure | None"
    notes: Sequence[str] = ()
