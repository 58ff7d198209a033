"""`visitlab runs list`: the runs in a folder."""

import time
from typing import TYPE_CHECKING

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out
from visitlab_cli.console.words import age_in_words, aligned, number, size_in_words
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.results.runs import RunLine


HELP = Help(
    "Runs",
    place=1,
    examples=(
        "visitlab runs list",
        "visitlab runs list --json",
    ),
)


def command(out: Out = RUNS, as_json: Json = False) -> None:
    """List the runs, the latest first: how far, how many seeds, how large, changed how long ago."""
    from visitlab_cli.results.runs import run_lines

    lines = run_lines(out)
    if as_json:
        tell_json({"folder": str(out), "runs": [line.as_json() for line in lines]})
    elif lines:
        rows = [["name", "state", "cells", "seeds", "size", "age"], *map(_row, lines)]
        tell_text(aligned(rows, words=2))
    else:
        tell(f"no runs in {out}", err=True)
    for line in lines:
        if line.problem is not None:
            tell(line.problem, err=True)


def _row(line: "RunLine") -> list[str]:
    cells = "-" if line.cells is None else f"{line.done}/{line.cells}"
    age = age_in_words(time.time() - line.changed)
    return [line.run.name, line.state, cells, number(line.seeds, "d"), size_in_words(line.size), age]
