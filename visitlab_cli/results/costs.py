"""What a step of a finished cell cost: values that were updated, and the time of a core."""

from pathlib import Path

from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import model_of, setting_of
from visitlab_cli.storage.facts import cpu_seconds_of

MICRO = 1e6


def updates(run: Path, cell: Cell) -> float | None:
    """Values updated a step, in the end; None where the kind of agent does not say.

    Raises:
        NotFoundError, RunError: as `model_of`.
    """
    return cell.config.agents[cell.agent].updates_a_step(setting_of(cell), model_of(run, cell))


def microseconds(run: Path, cell: Cell) -> float | None:
    """Microseconds of a core a step; None where nobody measured it."""
    seconds = cpu_seconds_of(run / cell.path)
    return None if seconds is None else seconds / cell.steps * MICRO
