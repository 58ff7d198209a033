"""`visitlab score`: how good is an agent? Questions, each with a score from 0 (random) to 1 (the best known)."""

from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, NoColor, Out, Overrides, Plugins, Quiet, Verbose, Workers

HELP = Help(
    "Run",
    place=4,
    examples=(
        "visitlab score",
        "visitlab score q_learning alpha=0.1 --only navigation --seeds 2",
    ),
)
SEEDS, QUICK_SEEDS = 10, 3


def command(
    agent: Annotated[
        str,
        typer.Argument(
            metavar="KIND|CONFIG",
            help="A kind of agent, as it is by default; or a YAML file, each of whose agents is scored. Left out: the "
            "questions are listed.",
            show_default=False,
            autocompletion=completion.configs,
        ),
    ] = "",
    overrides: Overrides = None,
    only: Annotated[list[str] | None, typer.Option(metavar="ROW", help="This row alone; may be repeated.")] = None,
    named: Annotated[
        list[str] | None,
        typer.Option("--agent", metavar="NAME", help="This agent of the config alone; may be repeated."),
    ] = None,
    seeds: Annotated[
        int | None, typer.Option(min=1, max=100_000, help=f"Repetitions of everything; {SEEDS} unless given.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help=f"{QUICK_SEEDS} seeds: wider intervals.")] = False,
    picture: Annotated[
        Path | None, typer.Option(help="Draw the scores as bars, .svg, .png or .pdf.", show_default=False)
    ] = None,
    report: Annotated[
        Path | None, typer.Option(help="Write them as one HTML page for any browser.", show_default=False)
    ] = None,
    page: Annotated[
        Path | None, typer.Option(help="Write them as a Markdown page, such as docs/scores.md.", show_default=False)
    ] = None,
    rows: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="Rows of your own instead of visitlab's.", show_default=False)
    ] = None,
    plugin: Plugins = None,
    out: Out = RUNS,
    workers: Workers = 0,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    no_color: NoColor = False,
) -> None:
    """Ask an agent the questions of the scorecard: it is trained, meets humans, leads a visit; random actions, too.

    All of it is in ordinary runs, score-AGENT-..., to look at and to replay. What is done already is kept.
    """
    from visitlab_cli.console.running import cores, raise_first
    from visitlab_cli.console.scoring import Files, score, tell_rows, tell_scores
    from visitlab_cli.errors import NotFoundError, UsageError
    from visitlab_cli.execution.progress import Progress
    from visitlab_cli.scores.contenders import check_names, contenders
    from visitlab_cli.scores.rows import read_rows
    from visitlab_cli.wording import or_else, printable

    found_rows = read_rows(rows)
    names = only or list(found_rows.rows)
    for name in names:
        if name not in found_rows.rows:
            raise NotFoundError(f"--only {printable(name)}: no such row{or_else(name, list(found_rows.rows))}")
    if not agent:
        tell_rows(found_rows, as_json=as_json)
        return
    if quick and seeds is not None:
        raise UsageError("--quick and --seeds: choose one")
    if quiet and verbose:
        raise UsageError("--quiet and --verbose: choose one")
    files = Files(picture, report, page)
    files.check()
    found = contenders(agent, overrides or (), named or ())
    check_names(found, found_rows)
    repeated = QUICK_SEEDS if quick else seeds or SEEDS
    progress = Progress(quiet, verbose)
    card, failures = score(found_rows, names, found, repeated, out, workers or cores(), progress)
    files.write(card, found_rows)
    tell_scores(card, files, as_json=as_json)
    raise_first(failures)
