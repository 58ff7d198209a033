"""`visitlab recover`: save what is whole of a log that was cut or damaged."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import Json
from visitlab_cli.terminal import tell, tell_json

if TYPE_CHECKING:
    from visitlab_cli.log.recovery.recovery import Recovered


HELP = Help(
    "Runs",
    place=2,
    examples=(
        "visitlab recover runs/quickstart-*/visit/human_2/seed-0000/steps.mcap --output whole.mcap",
        "visitlab recover runs/quickstart-*/social/mb/human_2/seed-0000/steps.mcap --output social.mcap --json",
    ),
)


def command(
    broken: Annotated[Path, typer.Argument(metavar="FILE", help="The damaged .mcap file; it is only read.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="The new file; by default NAME.recovered.mcap beside it. Of a cell that was killed, in a run's hidden "
            "folder .tmp-CELL: CELL.recovered.mcap beside the run.",
            show_default=False,
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Save every whole chunk of a log that was cut or damaged, as a whole log."""
    from visitlab_cli.log.recovery.recovery import recover

    saved = recover(broken, output or _beside_the_run(broken))
    if as_json:
        joined = {"others": [_plain(other) for other in saved.others]} if saved.others else {}
        tell_json(_plain(saved) | {"lost_bytes": saved.lost_bytes, "was_whole": saved.was_whole} | joined)
        return
    for each in (saved, *saved.others):
        parts = f" and parts of {each.parts} more" if each.parts else ""
        tell(f"{each.path}: {each.steps:,} steps, {each.trials:,} whole trials{parts}")
    if saved.was_whole:
        tell(f"{broken} was whole: this is a copy", err=True)
        return
    left_out = f"{saved.lost_bytes:,} bytes in it are not whole and left out"
    if saved.others:
        begins = ", ".join(f"{other.first_byte:,}" for other in saved.others)
        tell(f"{broken} is several files joined, the next from byte {begins} on: each is saved alone", err=True)
    for words in saved.left_out:
        tell(f"{broken}: {words}", err=True)
    if saved.lost_bytes or not saved.others:
        what = f": {left_out}" if saved.lost_bytes else ", but every record that is in it is whole and saved"
        tell(f"{broken} was cut or damaged{what}; it was not changed", err=True)


def _beside_the_run(broken: Path) -> Path | None:
    """Where a log in a hidden folder of a run goes, which anything more in it would keep for ever; None elsewhere."""
    from visitlab_cli.log.recovery.recovery import SUFFIX
    from visitlab_cli.storage.cell_folder import TEMPORARY, hidden_folder_of
    from visitlab_cli.storage.run_folder import is_run

    hidden = hidden_folder_of(broken)
    if hidden is None:
        return None
    run = next((folder for folder in hidden.parents if is_run(folder)), hidden)
    return run.parent / (hidden.name.removeprefix(TEMPORARY) + SUFFIX)


def _plain(saved: "Recovered") -> dict[str, Any]:
    return {
        "file": str(saved.path),
        "steps": saved.steps,
        "trials": saved.trials,
        "parts_of_trials": saved.parts,
    }
