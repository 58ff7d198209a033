"""`visitlab report`: a run as one HTML page."""

import json
from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.commands.options import RUNS, Json, Out, Run


def command(
    run: Run,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="The file; else RUN/report.html.")] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Write a run as one HTML page for anybody with a browser: results, learning curves, best trial, config."""
    from visitlab_cli.report.making import make_report
    from visitlab_cli.storage.run_folder import find_run

    folder = find_run(run, out)
    file = make_report(folder, output)
    told = {"run": str(folder), "file": str(file), "bytes": file.stat().st_size}
    typer.echo(json.dumps(told) if as_json else str(file))
