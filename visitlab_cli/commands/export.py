"""`visitlab export`: recorded trials in the format of another program, or a run's tables."""

from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Agent, At, Experiment, Human, Json, Out, RunOrFile, Seed
from visitlab_cli.terminal import tell, tell_json

HELP = Help(
    "Look",
    place=8,
    examples=(
        "visitlab export quickstart --csv --table results",
        "visitlab export quickstart --foxglove --trial worst",
    ),
)


def command(
    run: RunOrFile,
    foxglove: Annotated[
        bool, typer.Option("--foxglove", help="An .mcap file whose topics Foxglove shows without a plug-in.")
    ] = False,
    csv: Annotated[bool, typer.Option("--csv", help="A table of all finished cells that are chosen.")] = False,
    parquet: Annotated[bool, typer.Option("--parquet", help="The same as Parquet, which is small and fast.")] = False,
    table: Annotated[
        str,
        typer.Option(
            metavar="CONTENT",
            help="What is in the table: trials, steps, models or results.",
            autocompletion=completion.words("trials", "steps", "models", "results"),
        ),
    ] = "trials",
    experiment: Experiment = "",
    human: Human = "",
    agent: Agent = "",
    seed: Seed = None,
    at: At = None,
    trial: Annotated[
        list[str] | None,
        typer.Option(
            metavar="N|SELECTOR",
            help="As in replay; may be repeated: more trials of the same cell follow. Default: 0.",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The new file; by default named by what is in it.", show_default=False),
    ] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Write recorded trials as another program shows them, or tables of a run: choose one of the formats."""
    from visitlab_cli.errors import UsageError
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.replay.choice import Logs, choose_trial, find_logs

    if foxglove + csv + parquet != 1:
        raise UsageError("choose one format: --csv, --parquet or --foxglove")
    selection = Selection(experiment, human, agent, seed, tuple(at or ()))
    if not foxglove:
        from visitlab_cli.console.tables import tell_table

        if trial:
            raise UsageError(
                "--trial: a table holds all trials; choose cells by --experiment, --human, --agent, --seed, --at"
            )
        tell_table(run, out, selection, table, output, "csv" if csv else "parquet", as_json)
        return

    from visitlab_cli.replay.foxglove import write_foxglove
    from visitlab_cli.scene.trial import load_trial

    first, *more = trial or ["0"]
    chosen = choose_trial(find_logs(run, out, selection), first)
    if chosen.note:
        tell(chosen.note, err=True)
    log = chosen.log
    numbers = list(dict.fromkeys([chosen.trial, *(choose_trial(Logs((log,)), word).trial for word in more)]))
    target = output or Path(_name(log.cell, numbers))
    rows = write_foxglove(target, (load_trial(log.path, number) for number in numbers))
    told = {"cell": log.cell, "trials": numbers, "rows": rows, "file": str(target)}
    tell_json(told, None) if as_json else tell(f"{log.cell}, trial {', '.join(map(str, numbers))}: {target}")


def _name(cell: str, numbers: list[int]) -> str:
    """A file's name that says what is in it; `cell` is one of a run, or a file's path."""
    where = Path(cell).stem if cell.endswith(".mcap") else cell.replace("/", "-")
    return f"{where}-trial-{'-'.join(map(str, numbers))}.foxglove.mcap"
