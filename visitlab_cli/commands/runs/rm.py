"""`visitlab runs rm`: remove a whole run."""

import sys
from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out, Run
from visitlab_cli.console.words import size_in_words
from visitlab_cli.terminal import tell, tell_json

HELP = Help(
    "Runs",
    place=6,
    examples=(
        "visitlab runs rm short --yes",
        "visitlab runs rm quickstart --yes --json",
    ),
)


def command(
    run: Run,
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Do not ask.")] = False,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Remove a run and all that it holds; asks first. Refused where it holds files that are not visitlab's."""
    from visitlab_cli.errors import UsageError
    from visitlab_cli.storage.on_disk import EVALUATIONS, bytes_below, cell_folders
    from visitlab_cli.storage.removal import check_removable, remove_run
    from visitlab_cli.storage.run_folder import find_run

    folder = find_run(run, out)
    check_removable(folder)
    size = bytes_below(folder)
    cells = cell_folders(folder)
    played = sum(cell.is_relative_to(folder / EVALUATIONS) for cell in cells)
    own = len(cells) - played
    evaluated = f" and {played:,} of evaluations" if played else ""
    holds = f"{own:,} cell{'' if own == 1 else 's'}{evaluated}, {size_in_words(size)}"
    if not yes:
        tell(f"Remove {folder} ({holds})? [y/N]: ", end="", err=True)  # typer.confirm writes to stdout, too
        answer = sys.stdin.readline()
        if not answer:
            tell("", err=True)
            raise UsageError(f"{folder}: not removed; --yes removes without asking")
        yes = answer.strip().lower() in ("y", "yes")
    if yes:
        remove_run(folder)
    if as_json:
        tell_json({"run": str(folder), "removed": yes, "bytes": size})
    else:
        tell(f"removed {folder} ({holds})" if yes else f"kept {folder}")
