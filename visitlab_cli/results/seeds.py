"""What each seed reached, so that settings can be averaged and compared seed by seed."""

from collections.abc import Sequence
from pathlib import Path

from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.groups import unit_values


def seed_values(run: Path, cells: Sequence[Cell]) -> dict[str, float]:
    """What each independent unit of a group's finished cells reached, by the seed it was trained with.

    Units of one group have different seeds. Two seeds share no luck in any setting, whereas the same seed may (visits
    of the same modules), so that means and differences over settings are independent between seeds.
    """
    return {unit.rsplit("/", 1)[-1]: value for unit, value in unit_values(run, cells).items()}
