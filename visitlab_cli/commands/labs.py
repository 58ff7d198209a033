"""`visitlab labs`: the labs of a config, with their rooms and doors, drawn."""

from pathlib import Path
from typing import Annotated, Any

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import Config, Json, Overrides, Plugins
from visitlab_cli.terminal import tell, tell_json, tell_text

HELP = Help(
    "Configure",
    place=3,
    examples=(
        "visitlab labs beyond/labs",
        "visitlab labs beyond/labs --lab corridor --picture corridor.png",
    ),
)


def command(
    config: Config,
    overrides: Overrides = None,
    named: Annotated[
        list[str] | None, typer.Option("--lab", metavar="NAME", help="This lab alone; may be repeated.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(help="Draw them, too, as .svg, .png or .pdf.", show_default=False)
    ] = None,
    plugin: Plugins = None,
    as_json: Json = False,
) -> None:
    """Draw the labs that a config declares, and the paper's, and tell their rooms and doors."""
    from visitlab_cli.config.labs import about_lab, lab_called, labs_of
    from visitlab_cli.config.loading import load
    from visitlab_cli.errors import NotFoundError, UsageError
    from visitlab_cli.origin import check_ours
    from visitlab_cli.pictures.style import FORMATS
    from visitlab_cli.scene.lab_in_text import LEGEND, lab_in_text
    from visitlab_cli.wording import or_else, printable

    if picture is not None:
        if picture.suffix[1:] not in FORMATS:
            raise UsageError(f"--picture {picture}: must end in {', '.join(f'.{kind}' for kind in FORMATS)}")
        check_ours(picture)
    labs = load(config, overrides or []).labs
    known = labs_of(labs)
    for name in named or ():
        if name not in known:
            raise NotFoundError(f"--lab {printable(name)}: no lab is called so{or_else(name, known)}")
    chosen = {name: lab_called(name, labs) for name in named or known}
    if picture is not None:
        from visitlab_cli.replay.labs import save_labs

        save_labs(chosen, picture)
    about = {name: about_lab(name, labs) for name in chosen}
    if as_json:
        told: dict[str, Any] = {"labs": [{"name": name, **each} for name, each in about.items()]}
        tell_json({**told, "picture": str(picture)} if picture else told)
        return
    for name, lab in chosen.items():
        tell_text(f"{name}: {in_words(about[name])}\n\n{lab_in_text(lab)}\n")
    tell_text(LEGEND)
    if picture is not None:
        tell(str(picture))


def in_words(about: dict[str, Any]) -> str:
    """The size, rooms and doors of a lab."""
    rooms = f"{len(about['rooms'])} rooms ({', '.join(about['rooms'])})"
    no_goals = [room for room in about["rooms"] if room not in about["goals"]]
    never = f", never goals: {', '.join(no_goals)}" if no_goals else ""
    doors = [f"{door}{' (shut)' if each['shut'] else ''}" for door, each in about["doors"].items()]
    return f"{about['rows']} x {about['cols']} cells, {rooms}{never}; doors: {', '.join(doors) or 'none, nor walls'}"
