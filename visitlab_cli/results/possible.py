"""What the trials of a cell can bring at all."""

from visitlab_cli.exact.values import Possible, possible
from visitlab_cli.plan.cells import Cell


def possible_in(cell: Cell) -> Possible | None:
    """The exact values of a cell's task, with its human; None where they are not known, or several are met in turn."""
    humans = [cell.config.humans[name] for name in cell.humans]
    if len(humans) > 1:
        return None
    return possible(cell.settings, cell.config.interaction.distances, *humans)
