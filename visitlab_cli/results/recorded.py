"""The metrics of what a run has recorded, for pages that show them where there are any."""

import contextlib
from collections.abc import Sequence
from pathlib import Path

from visitlab_cli.errors import NotFoundError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.metrics import GroupMetrics, group_metrics
from visitlab_cli.results.phases import FIRST
from visitlab_cli.storage.cell_folder import STEPS


def recorded_metrics(run: Path, cells: Sequence[Cell], first: int = FIRST) -> list[GroupMetrics]:
    """As `group_metrics`, of the cells that have a log; none where there is no such cell.

    Raises:
        RunError: a log is damaged.
    """
    recorded = [cell for cell in cells if (run / cell.path / STEPS).is_file()]
    with contextlib.suppress(NotFoundError):
        return group_metrics(run, recorded, first)
    return []
