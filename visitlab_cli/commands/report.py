"""`visitlab report`: a run as one HTML page."""

from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out, Run
from visitlab_cli.console.unread import tell_unread
from visitlab_cli.terminal import tell, tell_json

HELP = Help(
    "Look",
    place=7,
    examples=(
        "visitlab report quickstart",
        "visitlab report latest --output report.html",
    ),
)


def command(
    run: Run,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="The file; else RUN/report.html.")] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Write a run as one HTML page for anybody with a browser: results, learning curves, best trial, config."""
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.report.making import make_report
    from visitlab_cli.results.evaluated import evaluated
    from visitlab_cli.storage.run_folder import find_run, read_config

    folder = find_run(run, out)
    file = make_report(folder, output)
    config = read_config(folder)
    played = [cell for those in evaluated(folder, config).values() for cell in those]
    tell_unread(folder, [*plan(config), *played])
    told = {"run": str(folder), "file": str(file), "bytes": file.stat().st_size}
    tell_json(told, None) if as_json else tell(str(file))
