"""`visitlab runs prune`: remove of a run what is of no use."""

from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out, Run
from visitlab_cli.terminal import tell, tell_json

HELP = Help(
    "Runs",
    place=5,
    examples=(
        "visitlab runs prune quickstart --dry-run",
        "visitlab runs prune latest",
    ),
)


def command(
    run: Run,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Tell, and remove nothing.")] = False,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Remove what killed processes left in a run, checkpoints of long cells included, and damaged cells.

    What is whole or being written stays.
    """
    from visitlab_cli.storage.removal import prune
    from visitlab_cli.storage.run_folder import find_run

    folder = find_run(run, out)
    pruned = prune(folder, dry_run)
    if as_json:
        tell_json({"run": str(folder), "dry_run": dry_run, **pruned._asdict()})
        return
    for name in pruned.removed:
        tell(f"{'would remove' if dry_run else 'removed'} {name}")
    for name, reason in pruned.kept.items():
        tell(f"kept {name}: {reason}")
    if not pruned.removed and not pruned.kept:
        tell(f"{folder}: nothing to remove")
