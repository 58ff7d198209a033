"""Options and arguments that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

Config = Annotated[str, typer.Argument(help="A YAML file, or the name of a shipped config (quickstart, paper).")]
Overrides = Annotated[
    list[str] | None,
    typer.Argument(metavar="[KEY=VALUE]...", help="Overrides, such as seeds=10.", show_default=False),
]
Run = Annotated[str, typer.Argument(help="A run's folder, its name, a unique beginning of it, or 'latest'.")]
Out = Annotated[Path, typer.Option("--out", help="The folder of all runs.")]
Workers = Annotated[
    int, typer.Option("--workers", "-w", min=0, max=1024, help="Processes; 0: as many as there are cores.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Tell nothing but failures and the result.")]

RUNS = Path("runs")
