"""What a page tells in words and tables: the run's config, its cells and what they reached."""

from typing import NamedTuple

from visitlab_cli.config.model import Config
from visitlab_cli.execution.cells import Cell
from visitlab_cli.results.expected import Result
from visitlab_cli.results.pairs import Pair
from visitlab_cli.results.summary import Summary


class Facts(NamedTuple):
    """A run: `expected` by the path of a group, `versions` by name all that its cells were made with.

    `evaluated` is what visits with options of their own reached, `pairs` how agents differ.
    """

    name: str
    config: Config
    cells: list[Cell]
    summaries: list[Summary]
    evaluated: list[Summary]
    pairs: list[Pair]
    expected: dict[str, Result]
    versions: dict[str, list[str]]

    @property
    def done(self) -> int:
        """How many cells are finished."""
        return sum(line.done for line in self.summaries)

    @property
    def complete(self) -> bool:
        """Whether nothing is missing."""
        return self.done == len(self.cells)


def counted(number: int, what: str) -> str:
    """A number of things in words: '1 seed', '10 seeds', '1,200 trials'."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"
