"""What a page tells in words and tables: the run's config, its cells and what they reached."""

from typing import NamedTuple

from visitlab_cli.colours import looks_of
from visitlab_cli.config.model import Config
from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.against_script import AgainstScript
from visitlab_cli.results.expected import Result
from visitlab_cli.results.marginal import Marginal
from visitlab_cli.results.metrics import GroupMetrics
from visitlab_cli.results.pairs import Pair
from visitlab_cli.results.summary import Summary


class Facts(NamedTuple):
    """A run: `expected` by the path of a group, `versions` by name all that its cells were made with.

    `evaluated` is what visits with options of their own reached, `pairs` how agents differ, `against_script` how they
    differ from the script, `metrics` what the interactions were like that were recorded.
    """

    name: str
    config: Config
    cells: list[Cell]
    summaries: list[Summary]
    evaluated: list[Summary]
    pairs: list[Pair]
    against_script: list[AgainstScript]
    marginals: list[Marginal]
    metrics: list[GroupMetrics]
    expected: dict[str, Result]
    versions: dict[str, list[str]]

    @property
    def lines(self) -> list[Summary]:
        """The lines of the table of results: those of the run, then those with options of their own."""
        return [*self.summaries, *self.evaluated]

    @property
    def hues(self) -> dict[str, int]:
        """The place of each agent's colour in the palette."""
        return {name: look.hue for name, look in looks_of(self.config.agents).items()}

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
