"""Which cells are independent of each other: what `n` counts, in every table, figure, judgement and page.

Independent is a training; in a visit the trained modules that play. Visits of the same modules share the luck of one
training: they are averaged and count once, so that neither crossed models nor visits which all play with the first
one pretend to be more robots than were trained. An interval of the mean is over units and nothing else.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

from visitlab_cli.plan.cells import Cell

SHARED = "Visits of the same trained modules count as one: n models were trained, and the interval is over them."
"""To be said wherever visits share their models."""


class Units(NamedTuple):
    """How many independent units (`n`) stand behind a mean, and how many cells they are."""

    n: int
    cells: int

    @property
    def shared(self) -> bool:
        """Whether some cells share their modules with others."""
        return self.cells > self.n

    @property
    def of(self) -> str:
        """What they are: 'seeds', or 'models' where visits share theirs."""
        return "models" if self.shared else "seeds"

    @property
    def words(self) -> str:
        """'10 seeds'; '6 models, 36 visits' where visits share their models."""
        counted = _counted(self.n, self.of)
        return f"{counted}, {_counted(self.cells, 'visits')}" if self.shared else counted


def unit_of(cell: Cell) -> str:
    """What names the independent unit that a cell belongs to: its own path, or those of its modules."""
    return " ".join(cell.modules.values()) or cell.path


def by_unit(cells: Iterable[Cell]) -> dict[str, list[Cell]]:
    """The cells of each unit, in the order of their first ones."""
    found: dict[str, list[Cell]] = {}
    for cell in cells:
        found.setdefault(unit_of(cell), []).append(cell)
    return found


def in_words(several: Sequence[Units]) -> str:
    """What the means of several conditions are taken over: 'n = 10 seeds', 'n = 1 to 2 models'."""
    fewest, most = min(several), max(several)
    if fewest == most:
        return f"n = {most.words}"
    counted = _counted(most.n, "models" if any(each.shared for each in several) else "seeds")
    return f"n = {counted}" if fewest.n == most.n else f"n = {fewest.n} to {counted}"


def mean_over(several: Sequence[Units]) -> str:
    """As `in_words`, and that it is a mean: 'mean, n = 10 seeds'; 'one seed' of a single cell is none."""
    return "one seed" if max(several) == Units(1, 1) else f"mean, {in_words(several)}"


def _counted(number: int, several: str) -> str:
    return f"{number} {several.removesuffix('s') if number == 1 else several}"
