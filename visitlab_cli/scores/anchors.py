"""What counts as 1: the exact optimum of a cell's task, or the best that is known of it; and which of the two it is."""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.config.experiment import lab_of
from visitlab_cli.config.experiments import GoToHumanTraining
from visitlab_cli.errors import UsageError
from visitlab_cli.exact.go_to_human import go_to_human_optimum
from visitlab_cli.exact.navigation import navigation_optimum
from visitlab_cli.plan.cells import Cell
from visitlab_cli.scores.asking import Asked
from visitlab_cli.scores.rows import Known, Row, Rows
from visitlab_cli.world.tasks import NAVIGATION

EXACT = "exact optimum"


class Best(NamedTuple):
    """Reward or goals a trial that count as 1, and what that is."""

    value: float
    source: str


def best_of(rows: Rows, row: Row, cell: Cell) -> Best:
    """What counts as 1 in a cell of a row.

    Raises:
        UsageError: the rows ask for an optimum that nobody knows.
    """
    if isinstance(row.best, Known):
        return Best(row.best.value, row.best.source)
    return Best(_optimum(rows, cell), EXACT)


def check_best(rows: Rows, names: Sequence[str], asked: Asked) -> None:
    """Nothing where it is known what counts as 1 in each of some rows, given what is asked of an agent that plays all.

    Raises:
        UsageError: as `best_of`.
    """
    for name in names:
        if rows.rows[name].scored:
            for cells in asked.cells_of(rows, name):
                best_of(rows, rows.rows[name], cells[0])


def _optimum(rows: Rows, cell: Cell) -> float:
    settings, steps = cell.settings, cell.settings.trial_steps
    if cell.task == NAVIGATION:
        return navigation_optimum(steps, lab_of(settings))
    if isinstance(settings, GoToHumanTraining):
        return go_to_human_optimum(steps, settings.success, cell.config.interaction.distances, lab_of(settings))
    if cell.human not in rows.optima:
        raise UsageError(f"{cell.group}: no optimum of {cell.human} is known; the rows must say another `best`")
    return rows.optima[cell.human]
