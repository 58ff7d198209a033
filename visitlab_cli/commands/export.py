"""`visitlab export`: recorded trials in the format of another program, or a run's tables."""

from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Agent, At, Experiment, Human, Json, Out, RunOrFile, Seed
from visitlab_cli.console.unread import tell_unread

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
    minari: Annotated[
        bool, typer.Option("--minari", help="A Minari data set, for offline reinforcement learning.")
    ] = False,
    ros2bag: Annotated[bool, typer.Option("--ros2bag", help="A ROS 2 bag (MCAP) of poses, map and markers.")] = False,
    table: Annotated[
        str | None,
        typer.Option(
            metavar="CONTENT",
            help="What is in the table: trials, steps, models or results.",
            autocompletion=completion.words("trials", "steps", "models", "results"),
            show_default="trials",
        ),
    ] = None,
    experiment: Experiment = "",
    human: Human = "",
    agent: Agent = "",
    seed: Seed = None,
    at: At = None,
    trial: Annotated[
        list[str] | None,
        typer.Option(
            metavar="N|SELECTOR",
            help="As in replay; may be repeated: more trials of the same cell follow. Default: 0; of --minari all.",
            show_default=False,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="The new file or bag, by default named by what is in it; of --minari the folder of data sets.",
            show_default=False,
        ),
    ] = None,
    cell_size: Annotated[
        float | None,
        typer.Option(
            "--cell-size",
            metavar="METRES",
            min=0.001,
            max=1000,
            help="Of --ros2bag: a cell's side; 1.",
            show_default=False,
        ),
    ] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Write recorded trials as another program shows them, or tables of a run: choose one of the formats."""
    from visitlab_cli.console import exports
    from visitlab_cli.errors import UsageError
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.replay.choice import find_logs

    if foxglove + csv + parquet + minari + ros2bag != 1:
        raise UsageError("choose one format: --csv, --parquet, --foxglove, --minari or --ros2bag")
    if cell_size is not None and not ros2bag:
        raise UsageError("--cell-size: goes with --ros2bag only")
    if table is not None and not (csv or parquet):
        raise UsageError("--table: goes with --csv and --parquet only")
    selection, words = Selection(experiment, human, agent, seed, tuple(at or ())), trial or []
    if csv or parquet:
        from visitlab_cli.console.tables import tell_table

        if words:
            raise UsageError(
                "--trial: a table holds all trials; choose cells by --experiment, --human, --agent, --seed, --at"
            )
        content = "trials" if table is None else table
        tell_table(run, out, selection, content, output, "csv" if csv else "parquet", as_json)
        return
    logs = find_logs(run, out, selection)
    tell_unread(logs.run, logs.cells)
    if foxglove:
        exports.tell_foxglove(logs, words, output, as_json)
    elif minari:
        exports.tell_minari(logs, words, output, as_json)
    else:
        exports.tell_ros2bag(logs, words, output, as_json, cell_size or 1.0)
