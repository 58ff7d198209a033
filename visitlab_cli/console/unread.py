"""What the numbers of a command lack: cells that are not run yet, and cells that were damaged since, in one line."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from visitlab_cli.console.words import run_again
from visitlab_cli.terminal import tell

if TYPE_CHECKING:
    from visitlab_cli.plan.cells import Cell


def tell_unread(run: Path, cells: "Sequence[Cell]") -> None:
    """Say how many of the cells that a command reads are not done or damaged, the first of each, and what mends it."""
    from visitlab_cli.storage.cell_folder import OF_CELLS, read_cell
    from visitlab_cli.wording import few

    unread = [cell for cell in cells if read_cell(run / cell.path) is None]
    if not unread:
        return
    parts: dict[str, list[str]] = {"damaged": [], "not run yet": []}
    for cell in unread:
        is_there = any((run / cell.path / name).exists() for name in OF_CELLS)
        parts["damaged" if is_there else "not run yet"].append(cell.path)
    told = [f"{len(paths):,} {what} ({few(paths, 1)})" for what, paths in parts.items() if paths]
    declared = any(not cell.evaluation.folder for cell in unread)
    again = run_again(run) if declared else "the same visitlab eval again"
    count = f"{len(unread):,} of {len(cells):,} cell{'' if len(cells) == 1 else 's'}"
    tell(f"{run}: {count} not read: {', '.join(told)}; {again} makes what is missing", err=True)
