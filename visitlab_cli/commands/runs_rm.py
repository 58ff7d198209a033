"""`visitlab runs rm`: remove a whole run."""

import json
import sys
from typing import Annotated

import typer

from visitlab_cli.commands.options import RUNS, Json, Out, Run
from visitlab_cli.commands.runs_words import size_in_words


def command(
    run: Run,
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")] = False,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Remove a run and all that it holds; asks first. Refused where it holds files that are not visitlab's."""
    from visitlab_cli.errors import UsageError
    from visitlab_cli.storage.on_disk import bytes_below, cell_folders
    from visitlab_cli.storage.removal import check_removable, remove_run
    from visitlab_cli.storage.run_folder import find_run

    folder = find_run(run, out)
    check_removable(folder)
    size = bytes_below(folder)
    holds = f"{len(cell_folders(folder))} cells, {size_in_words(size)}"
    if not yes:
        typer.echo(f"Remove {folder} ({holds})? [y/N]: ", nl=False, err=True)  # typer.confirm writes to stdout, too
        answer = sys.stdin.readline()
        if not answer:
            typer.echo(err=True)
            raise UsageError(f"{folder}: not removed; --yes removes without asking")
        yes = answer.strip().lower() in ("y", "yes")
    if yes:
        remove_run(folder)
    if as_json:
        typer.echo(json.dumps({"run": str(folder), "removed": yes, "bytes": size}, indent=2))
    else:
        typer.echo(f"removed {folder} ({holds})" if yes else f"kept {folder}")
