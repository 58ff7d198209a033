"""Whom a cell's agent was trained with before the cell began."""

from visitlab_cli.plan.cells import Cell
from visitlab_cli.world.tasks import SOCIAL


def trained_with(cell: Cell) -> set[str]:
    """The humans of the trainings that its social modules come from, and of those that these went on from."""
    experiments = cell.config.experiments
    found: set[str] = set()
    left = [cell.settings]
    for settings in left:  # grows
        for role, start in settings.starts.items():
            if role.partition(" ")[0] == SOCIAL:
                found.update(experiments[start.experiment].humans_met(start.human or ""))
                left.append(experiments[start.experiment])
    return found
