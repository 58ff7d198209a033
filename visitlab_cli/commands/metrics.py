"""`visitlab metrics`: what the interactions of a run were like."""

from typing import Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.metrics import metrics_table
from visitlab_cli.console.options import FIRST_TRIALS, RUNS, Agent, At, First, Json, Out, Run, Seed
from visitlab_cli.console.unread import tell_unread
from visitlab_cli.terminal import tell_json, tell_text

HELP = Help(
    "Look",
    place=6,
    examples=(
        "visitlab metrics quickstart --experiment visit",
        "visitlab metrics latest --json",
    ),
)


def command(
    run: Run,
    experiment: Annotated[
        str,
        typer.Option(
            "--experiment",
            "-e",
            help="Of this experiment; else of all social trainings and visits.",
            autocompletion=completion.experiments,
        ),
    ] = "",
    human: Annotated[
        str, typer.Option(help="With this human, of phases those with it.", autocompletion=completion.humans)
    ] = "",
    agent: Agent = "",
    seed: Seed = None,
    at: At = None,
    first: First = FIRST_TRIALS,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Measure gaze, time to engagement, distance, attention lost and the way walked, from the logs."""
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.results.metrics import group_metrics
    from visitlab_cli.storage.run_folder import find_run, read_config
    from visitlab_cli.world.columns import ENGAGEMENT

    folder = find_run(run, out)
    selection = Selection(experiment, human, agent, seed, tuple(at or ()), in_phases=True)
    cells = selection.of(folder, plan(read_config(folder)))
    found = group_metrics(folder, cells, first, human)
    tell_unread(folder, [cell for cell in cells if cell.settings.plays.has(ENGAGEMENT)])
    if as_json:
        rows = [row for each in found for row in each.as_rows()]
        tell_json({"run": str(folder), "confidence": 0.95, "metrics": rows})
        return
    tell_text(metrics_table(found))
