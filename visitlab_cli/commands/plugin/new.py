"""`visitlab plugin new`: a small package with an agent of one's own."""

from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import Json
from visitlab_cli.terminal import tell, tell_json

HELP = Help(
    "Configure",
    place=1,
    examples=("visitlab plugin new my_agent", "visitlab plugin new my_agent --folder agents"),
)


def command(
    name: Annotated[str, typer.Argument(metavar="NAME", help="What configs will call it, and the module's name.")],
    folder: Annotated[Path, typer.Option("--folder", "-f", help="Where to write it.", show_default="here")] = Path(),
    as_json: Json = False,
) -> None:
    """Write a package with an agent in plain Python, its test and a config; it works when installed."""
    from visitlab_cli.authoring.new import new_package

    written = new_package(name, folder)
    if as_json:
        tell_json({"kind": name, "files": [str(file) for file in written]})
        return
    tell(*map(str, written))
    tell(f"next: pip install -e {folder / name}; visitlab plugin check {name}", err=True)
