"""What `export --csv` and `--parquet` do: a table of a run's finished cells as a file."""

from pathlib import Path
from typing import TYPE_CHECKING

from visitlab_cli.console.unread import tell_unread
from visitlab_cli.terminal import tell, tell_json

if TYPE_CHECKING:
    from visitlab_cli.plan.selection import Selection


def tell_table(
    run: str, out: Path, selection: "Selection", content: str, output: Path | None, kind: str, as_json: bool
) -> None:
    """Write the table and say where it is.

    Raises:
        UsageError: there is no such content, `run` is a log, or the file's name does not end in the kind.
        NotFoundError: no finished cell matches.
    """
    from visitlab_cli.errors import NotFoundError, UsageError
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.results.export import CONTENTS, export_table
    from visitlab_cli.storage.cell_folder import read_cell
    from visitlab_cli.storage.run_folder import find_run, read_config
    from visitlab_cli.wording import or_else, printable

    if content not in CONTENTS:
        raise UsageError(f"--table {content}: no such table{or_else(content, CONTENTS)}")
    if Path(run).suffix == ".mcap":
        raise UsageError(f"{printable(run)}: is one log, and tables are of runs; choose another format, or a run")
    folder = find_run(run, out)
    file = output or Path(f"{folder.resolve().name}-{content}.{kind}")
    if file.suffix != f".{kind}":
        raise UsageError(f"--output {file}: must end in .{kind}")
    chosen = selection.of(folder, plan(read_config(folder)))
    cells = [cell for cell in chosen if read_cell(folder / cell.path) is not None]
    if not cells:
        raise NotFoundError(f"{folder}: no finished cell {f'with {selection}' if str(selection) else 'at all'}")
    rows = export_table(folder, cells, content, file)
    tell_unread(folder, chosen)
    told = {"run": str(folder), "table": content, "cells": len(cells), "rows": rows, "file": str(file)}
    tell_json(told, None) if as_json else tell(f"{file}: {rows:,} rows, {content} of {len(cells)} cells")
