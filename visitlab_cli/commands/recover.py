"""`visitlab recover`: save what is whole of a log that was cut or damaged."""

from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.commands.options import Json
from visitlab_cli.terminal import tell, tell_json


def command(
    broken: Annotated[Path, typer.Argument(metavar="FILE", help="The damaged .mcap file; it is only read.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output", "-o", help="The new file; by default NAME.recovered.mcap beside it.", show_default=False
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Save every whole chunk of a log that was cut or damaged, as a whole log."""
    from visitlab_cli.recording.recovery import recover

    saved = recover(broken, output)
    if as_json:
        told = {
            "file": str(saved.path),
            "steps": saved.steps,
            "trials": saved.trials,
            "parts_of_trials": saved.parts,
            "lost_bytes": saved.lost_bytes,
            "was_whole": saved.was_whole,
        }
        tell_json(told)
        return
    parts = f" and parts of {saved.parts} more" if saved.parts else ""
    tell(f"{saved.path}: {saved.steps:,} steps, {saved.trials:,} whole trials{parts}")
    if saved.was_whole:
        tell(f"{broken} was whole: this is a copy", err=True)
    else:
        left_out = f"{saved.lost_bytes:,} bytes in it are not whole and left out"
        tell(f"{broken} was cut or damaged: {left_out}; it was not changed", err=True)
