"""`visitlab runs watch`: how far a run is, from any machine that sees its folder."""

import sys
from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out, Run
from visitlab_cli.terminal import tell_json, tell_text

HELP = Help(
    "Runs",
    place=3,
    examples=(
        "visitlab runs watch latest",
        "visitlab runs watch quickstart --once",
    ),
)


def command(
    run: Run,
    once: Annotated[bool, typer.Option("--once", help="Tell how far it is now, and end.")] = False,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Show how far a run is, whoever does it and wherever, until it is done. Ends with Ctrl-C, and changes nothing.

    A bar for each module and visit; below, each cell under way: on which machine, by which process, how many steps;
    and those that nobody does now, with the steps from which they would be gone on with here. Where the output is no
    terminal, and with --json, it tells that once.
    """
    from visitlab_cli.console.watching import follow, text
    from visitlab_cli.results.watching import Watch
    from visitlab_cli.storage.run_folder import find_run, read_config

    folder = find_run(run, out)
    watch = Watch(folder, read_config(folder))
    if as_json:
        tell_json(watch.look().as_json())
    elif once or not sys.stdout.isatty():
        tell_text(text(watch.look()))
    else:
        follow(watch)
