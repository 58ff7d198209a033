"""`visitlab runs diff`: what two runs have otherwise."""

from typing import Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out, Run
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import tell, tell_json, tell_text

HELP = Help(
    "Runs",
    place=3,
    examples=(
        "visitlab runs diff quickstart short",
        "visitlab runs diff quickstart short --json",
    ),
)


def command(
    run: Run,
    other: Annotated[
        str, typer.Argument(metavar="OTHER", help="The run to compare with.", autocompletion=completion.runs)
    ],
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Print every setting that two runs' configs have otherwise, every version, and the code that made their cells."""
    from visitlab_cli.config.canonical import canonical
    from visitlab_cli.storage.cell_folder import SOURCES
    from visitlab_cli.storage.differences import differences, shown
    from visitlab_cli.storage.made_by import made_by
    from visitlab_cli.storage.on_disk import cell_folders
    from visitlab_cli.storage.run_folder import find_run, read_config, read_versions

    runs = first, second = find_run(run, out), find_run(other, out)
    found = {
        "config": differences(canonical(read_config(first)), canonical(read_config(second))),
        "versions": differences(read_versions(first), read_versions(second)),
    }
    made = [list(made_by(each, (cell.relative_to(each).as_posix() for cell in cell_folders(each)))) for each in runs]
    if all(made):  # else one of them has no cell yet
        found["cells"] = differences({SOURCES: made[0]}, {SOURCES: made[1]})
    if as_json:
        told = {name: [each.as_json("first", "second") for each in part] for name, part in found.items()}
        tell_json({"first": str(first), "second": str(second), **told})
        return
    rows = [[name, each.path, shown(each.first), shown(each.second)] for name, part in found.items() for each in part]
    if rows:
        tell_text(aligned([["", "what differs", first.name, second.name], *rows], words=4))
    else:
        tell(f"{first} and {second}: the same config, versions and sources")
