"""What `submit` does: packs what a run lacks into jobs, writes their script, hands them in, and tells."""

import os
import shlex
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from visitlab_cli.errors import RunError, reason
from visitlab_cli.terminal import tell, tell_all, tell_json

if TYPE_CHECKING:
    from visitlab_cli.config.model import Config
    from visitlab_cli.jobs.script import Request

ARRAY_LIMIT = 1000
"""Jobs of an array where the site does not say."""
ONLY_TELLING = {"--dry-run", "--json"}
"""Flags that the command that goes on is without."""


class Asked(NamedTuple):
    """The options of `submit`; `cells_per_job` 0: by what they cost. `in_script` are further parts of a `Request`."""

    system: str
    jobs: int
    time: str
    cells_per_job: int
    workers: int
    margin: float
    array_limit: int | None
    script: Path | None
    go: bool
    dry_run: bool
    as_json: bool
    in_script: dict[str, Any]


def submit(out: Path, config: "Config", asked: Asked) -> None:
    """Write, and maybe hand in, the jobs that do what the run of `config` below `out` lacks.

    Raises:
        UsageError: they don't fit, or something can't stand in a script.
        RunError: the folder can't be written, or the queue refuses.
    """
    from visitlab_cli.console.dry_run import warn_of_hindrance
    from visitlab_cli.console.running import cores, held_run
    from visitlab_cli.execution.runner import missing_cells
    from visitlab_cli.jobs.packing import Limits, pack, seconds_in
    from visitlab_cli.jobs.queue import hand_in, site_limit
    from visitlab_cli.jobs.script import SHELL, SLURM, Request, check, script_text, submissions
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.notes import notes_on
    from visitlab_cli.plugins import files
    from visitlab_cli.storage.inside import check_inside
    from visitlab_cli.storage.nearest import news_of
    from visitlab_cli.storage.on_disk import JOBS
    from visitlab_cli.storage.run_folder import run_name
    from visitlab_cli.whole_file import write_again

    cells = plan(config)
    run = out.absolute() / run_name(config)
    missing = missing_cells(run, cells)
    seconds = seconds_in(asked.time)
    time = None if asked.system == SHELL else seconds
    packing = pack(cells, missing, Limits(asked.jobs, time, asked.cells_per_job, asked.workers, asked.margin))
    parts: dict[str, Any] = {
        "system": asked.system,
        "run": run,
        "seeds": config.seeds,
        "packing": packing,
        "workers": asked.workers,
        "time": seconds,
        "command": shlex.join([sys.executable, "-P", "-m", "visitlab_cli"]),
        "at_once": max(1, cores() // asked.workers),
        "most_in_array": asked.array_limit or (site_limit() if asked.system == SLURM else None) or ARRAY_LIMIT,
        "again": this_command(),
        "plugins": tuple(file.absolute() for file in files()),
    }
    request = Request(**(parts | asked.in_script))
    check(request)
    script = (asked.script or run / JOBS / f"{asked.system}.sh").absolute()
    commands = submissions(request, script) if missing else []
    numbers: list[str] = []
    tell_all(notes_on(missing))
    if missing and asked.dry_run:
        warn_of_hindrance(run)
    elif missing:
        tell_all([news_of(out, config)])
        with held_run(out, config, lambda line: tell(line, err=True)):
            if asked.script is None:
                check_inside(run, script)
            for folder in (run / JOBS, script.parent):
                _make(folder)
            write_again(script, script_text(request, script).encode())
        if asked.go and asked.system != SHELL:
            numbers = hand_in(commands)
    if asked.as_json:
        tell_json(
            {
                "run": str(run),
                "script": str(script),
                "cells": len(cells),
                "missing": len(missing),
                "shards": packing.total,
                "jobs": [job._asdict() for job in packing.jobs],
                "submit": commands,
                "submitted": numbers,
                "watch": watch(run),
                "again": this_command(),
            }
        )
    else:
        tell(*_lines(request, len(cells), len(missing)))
        if missing and not asked.dry_run:
            tell(*_what_next(run, script, commands, numbers, asked))
    if missing and asked.go and asked.system == SHELL:
        sys.stdout.flush()
        os.execvp(commands[0][0], commands[0])


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RunError(f"{folder}: can't be written: {reason(error)}") from error


def watch(run: Path) -> str:
    """The command that shows how far a run is."""
    return shlex.join(["visitlab", "runs", "watch", str(run)])


def this_command() -> str:
    """The command that this program was started with, from any folder; without what only tells of it."""
    try:
        here = f"cd {shlex.quote(os.getcwd())} && "
    except OSError:  # it is gone
        here = ""
    return here + shlex.join(["visitlab", *(word for word in sys.argv[1:] if word not in ONLY_TELLING)])


def _lines(request: "Request", cells: int, missing: int) -> list[str]:
    from visitlab_cli.console.dry_run import duration

    if not missing:
        return [f"{request.run}: all {cells} cells are done"]
    done = f", {cells - missing} done already" if missing < cells else ""
    jobs = request.packing.jobs
    fewest, most = min(job.cells for job in jobs), max(job.cells for job in jobs)
    many = f"{fewest} to {most}" if fewest < most else str(most)
    one = f"{len(jobs)} job{'s' if len(jobs) > 1 else ''} of {many} cell{'s' if most > 1 else ''}"
    longest = f"the longest about {duration(request.packing.longest)} with all margin"
    return [f"{request.run}: {missing} cells to do{done}: {one}, {longest}"]


def _what_next(run: Path, script: Path, commands: list[list[str]], numbers: list[str], asked: Asked) -> list[str]:
    lines = [f"script:    {script}"]
    if numbers:
        lines.append(f"submitted: {' '.join(numbers)}")
    elif not asked.go:
        lines += [f"submit:    {shlex.join(command)}" for command in commands]
    return [*lines, f"watch:     {watch(run)}", f"continue:  {this_command()}"]
