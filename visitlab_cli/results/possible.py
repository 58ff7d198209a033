"""What the trials of a cell can bring at all."""

from visitlab_cli.exact.values import Possible, possible
from visitlab_cli.plan.cells import Cell


def possible_in(cell: Cell) -> Possible | None:
    """The exact values of a cell's task, with its human; None where they are not known."""
    human = cell.config.humans[cell.human] if cell.human else None
    return possible(cell.settings, cell.config.interaction.distances, human)
