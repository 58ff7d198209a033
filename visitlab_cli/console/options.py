"""Options and arguments that several commands share."""

import os
import re
from pathlib import Path
from typing import Annotated, Literal

import typer

from visitlab_cli.console import completion


def _no_color(asked: bool) -> None:
    if asked:
        os.environ["NO_COLOR"] = "1"  # which rich and typer heed


def _use_plugins(named: list[Path] | None) -> list[Path] | None:
    before = os.environ.get("VISITLAB_PLUGINS")
    if named or before:
        from visitlab_cli.plugins import VARIABLE, use_files
        from visitlab_cli.terminal import tell

        use_files(named or ())
        if before:
            tell(f"plug-ins of {VARIABLE}: {before}", err=True)
    return named


def _check_shard(context: typer.Context, word: str) -> str:
    source = context.get_parameter_source("shard")
    given = source is None or source.name != "DEFAULT"  # an empty one is a variable that was not set
    found = re.fullmatch(r"([1-9]\d{0,5})/([1-9]\d{0,5})", word, re.ASCII)
    if given and (found is None or int(found[1]) > int(found[2])):
        from visitlab_cli.errors import UsageError
        from visitlab_cli.wording import printable

        raise UsageError(f"--shard {printable(word) or 'without a word'}: must be I/N, such as 2/8, with I from 1 to N")
    return word


Config = Annotated[
    str,
    typer.Argument(
        metavar="CONFIG",
        help="A YAML file, or the name of a shipped config (quickstart, my-human, paper).",
        autocompletion=completion.configs,
    ),
]
Overrides = Annotated[
    list[str] | None,
    typer.Argument(metavar="KEY=VALUE", help="Overrides, such as seeds=10.", show_default=False),
]
Run = Annotated[
    str,
    typer.Argument(
        metavar="RUN",
        help="A run's folder, its name, a unique beginning of it, or 'latest'.",
        autocompletion=completion.runs,
    ),
]
RunOrFile = Annotated[
    str,
    typer.Argument(
        metavar="RUN|FILE",
        help="A run (its folder, name, 'latest') or an .mcap file.",
        autocompletion=completion.runs,
    ),
]
Experiment = Annotated[
    str,
    typer.Option("--experiment", "-e", help="Of this experiment; else a visit.", autocompletion=completion.experiments),
]
Human = Annotated[str, typer.Option(help="With this human.", autocompletion=completion.humans)]
Agent = Annotated[
    str,
    typer.Option(help="Of this agent; in a visit the social module's.", autocompletion=completion.agents),
]
Seed = Annotated[int | None, typer.Option(min=0, help="Of this repetition, from 0.")]
At = Annotated[
    list[str] | None,
    typer.Option("--at", metavar="PATH=VALUE", help="Where this varies, at this value; may be repeated."),
]
TrialWord = Annotated[
    str,
    typer.Option(
        metavar="N|SELECTOR",
        help="Its number; best, worst, median or longest-engagement of all that fit.",
        autocompletion=completion.words("best", "worst", "median", "longest-engagement"),
    ),
]
FIRST_TRIALS = 20
"""As `results.phases.FIRST`, which would take long to import."""
First = Annotated[
    int, typer.Option("--first", min=1, max=10**9, help="With phases: how many trials are the first ones of each.")
]
Phase = Annotated[
    int | None, typer.Option(min=0, help="With phases: best, worst and so on of this phase alone, from 0.")
]
Plugins = Annotated[
    list[Path] | None,
    typer.Option(
        "--plugin",
        metavar="FILE",
        help="A Python file with kinds of agents or humans; may be repeated.",
        callback=_use_plugins,
        show_default=False,
    ),
]
Out = Annotated[Path, typer.Option("--out", help="The folder of all runs.")]
Workers = Annotated[
    int, typer.Option("--workers", "-w", min=0, max=1024, help="Processes; 0: as many as there are cores.")
]
Shard = Annotated[
    str,
    typer.Option(
        metavar="I/N",
        help="The I-th of N parts alone, for N runners, such as jobs of a cluster.",
        callback=_check_shard,
    ),
]
Executor = Annotated[
    Literal["local", "dask"],
    typer.Option(help="Where cells run: in processes of this machine, or in the workers of a Dask cluster."),
]
Address = Annotated[
    str,
    typer.Option(
        metavar="tcp://HOST:PORT",
        help="With --executor dask: its scheduler; with none a cluster of --workers on this machine, ended at the end.",
        show_default=False,
    ),
]
SchedulerFile = Annotated[
    Path | None, typer.Option(metavar="FILE", help="With --executor dask: the file in which its scheduler says that.")
]
Json = Annotated[bool, typer.Option("--json", help="Print the result as JSON.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Tell nothing but failures and the result.")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Tell when each cell begins, too, and its speed.")]
DryRun = Annotated[bool, typer.Option("--dry-run", help="Only tell the cells to do, their steps, time and disk.")]
NoColor = Annotated[
    bool, typer.Option("--no-color", callback=_no_color, is_eager=True, help="No colours; NO_COLOR=1 does the same.")
]

RUNS = Path("runs")
