"""`visitlab submit`: a run as jobs of SLURM, of PBS, or of a shell script."""

from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Config, Json, NoColor, Out, Overrides, Plugins

HELP = Help(
    "Run",
    place=4,
    examples=(
        "visitlab submit paper seeds=100 --slurm --account lab --dry-run",
        "visitlab submit quickstart seeds=40 --shell --cells-per-job 20 --dry-run",
    ),
)

MOST_CELLS = 10**6
HOUR = "1:00:00"


def command(
    config: Config,
    overrides: Overrides = None,
    slurm: Annotated[bool, typer.Option("--slurm", help="Jobs for SLURM (sbatch).")] = False,
    pbs: Annotated[bool, typer.Option("--pbs", help="Jobs for PBS (qsub).")] = False,
    shell: Annotated[bool, typer.Option("--shell", help="A bash script that runs them here, some at once.")] = False,
    jobs: Annotated[int, typer.Option(min=1, max=100_000, help="At most so many.")] = 50,
    time: Annotated[
        str, typer.Option(metavar="H:MM:SS", help="What a job may take; --shell knows no limit.", show_default=HOUR)
    ] = "",
    cells_per_job: Annotated[str, typer.Option(metavar="auto|N", help="How many cells a job does, about.")] = "auto",
    workers: Annotated[int, typer.Option("--workers", "-w", min=1, max=1024, help="Cores of a job.")] = 1,
    margin: Annotated[
        float, typer.Option(min=0.1, max=100, help="What estimated times are multiplied by before they must fit.")
    ] = 2.0,
    partition: Annotated[str, typer.Option("--partition", "--queue", help="Of the cluster.")] = "",
    account: Annotated[str, typer.Option(help="Who pays.")] = "",
    memory: Annotated[str, typer.Option(help="Of a job, as the queue writes it: 4G (SLURM), 4gb (PBS).")] = "",
    directive: Annotated[
        list[str] | None, typer.Option(metavar="TEXT", help="A further #SBATCH or #PBS option; may be repeated.")
    ] = None,
    prologue: Annotated[
        list[str] | None,
        typer.Option(metavar="LINE", help="A shell line before visitlab starts (module load ...); may be repeated."),
    ] = None,
    program: Annotated[
        str,
        typer.Option(
            "--command",
            metavar="TEXT",
            help="visitlab as a job's shell calls it.",
            show_default="this one, by its path",
        ),
    ] = "",
    array_limit: Annotated[
        int | None,
        typer.Option(
            min=1,
            max=10**6,
            help="Jobs of an array; more make several.",
            show_default="the site's MaxArraySize, or 1000",
        ),
    ] = None,
    script: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Where the script is written; else into the run's folder.")
    ] = None,
    plugin: Plugins = None,
    out: Out = RUNS,
    go: Annotated[bool, typer.Option("--go", help="Hand the jobs in, too, and print their numbers.")] = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only tell the jobs; write and hand in nothing.")] = False,
    as_json: Json = False,
    no_color: NoColor = False,
) -> None:
    """Write the script of jobs that do what a run lacks, many cells each. The same again does what is missing then."""
    from visitlab_cli.config.loading import load
    from visitlab_cli.console.submitting import Asked, submit
    from visitlab_cli.errors import UsageError

    systems = [name for name, asked in (("slurm", slurm), ("pbs", pbs), ("shell", shell)) if asked]
    if len(systems) != 1:
        raise UsageError("--slurm, --pbs, --shell: choose one")
    if go and dry_run:
        raise UsageError("--go and --dry-run: choose one")
    if cells_per_job != "auto" and not (cells_per_job.isdecimal() and 0 < int(cells_per_job) <= MOST_CELLS):
        raise UsageError(f"--cells-per-job {cells_per_job}: must be auto or a number from 1")
    queue = {"time": time, "partition": partition, "account": account, "memory": memory, "directive": directive}
    if shell and (needless := [name for name, value in queue.items() if value]):
        raise UsageError(f"--{needless[0]}: is for a queue, and --shell has none")
    asked = Asked(
        system=systems[0],
        jobs=jobs,
        time=time or HOUR,
        cells_per_job=0 if cells_per_job == "auto" else int(cells_per_job),
        workers=workers,
        margin=margin,
        array_limit=array_limit,
        script=script,
        go=go,
        dry_run=dry_run,
        as_json=as_json,
        in_script={
            "partition": partition,
            "account": account,
            "memory": memory,
            "directives": tuple(directive or ()),
            "prologue": tuple(prologue or ()),
            **({"command": program} if program else {}),
        },
    )
    submit(out, load(config, overrides or []), asked)
