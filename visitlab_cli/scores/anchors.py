"""What counts as 1: the exact optimum of a cell's task, or the best that is known of it; and which of the two it is."""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.errors import UsageError
from visitlab_cli.exact.values import possible
from visitlab_cli.plan.cells import Cell
from visitlab_cli.scores.asking import Asked
from visitlab_cli.scores.rows import Known, Row, Rows
from visitlab_cli.world.tasks import SOCIAL

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
    """As the rows have it, for of a human it takes ten seconds to compute; else computed, and kept by `exact/`."""
    if cell.task == SOCIAL and cell.human in rows.optima:
        return rows.optima[cell.human]
    config = cell.config
    found = possible(cell.settings, config.interaction.distances, config.humans.get(cell.human))
    if found is None:
        raise UsageError(f"{cell.group}: no optimum of {cell.human or cell.task} is known; the rows must say `best`")
    return found.optimum
