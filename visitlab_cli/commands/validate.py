"""`visitlab validate`: check a config and say what it would do."""

from typing import Annotated, Any

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import Config, Json, Overrides, Plugins
from visitlab_cli.terminal import tell, tell_all, tell_json, tell_text

HELP = Help(
    "Configure",
    place=2,
    examples=(
        "visitlab validate my-human",
        "visitlab validate quickstart seeds=10 --show",
    ),
)


def command(
    config: Config,
    overrides: Overrides = None,
    plugin: Plugins = None,
    show: Annotated[
        bool, typer.Option("--show", help="Print the whole config: included, overridden, defaults filled in.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Check a config: its errors together, each with its place; else what it would run.

    What an entry refers to, and how its settings go together, is looked at once its own values are right.
    """
    from visitlab_cli.config.canonical import canonical, config_hash, dump_yaml
    from visitlab_cli.config.labs import lab_called
    from visitlab_cli.config.loading import load
    from visitlab_cli.errors import ConfigError
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.notes import notes_on
    from visitlab_cli.scene.lab_in_text import lab_in_text

    try:
        loaded = load(config, overrides or [])
        cells = plan(loaded)
    except ConfigError as error:
        if as_json:
            tell_json({"valid": False, "errors": error.problems})
        raise
    steps = sum(cell.steps for cell in cells)
    run, notes = f"{loaded.name}-{config_hash(loaded)}", notes_on(cells)
    if not as_json:
        tell_all(notes)
    if as_json:
        told: dict[str, Any] = {"valid": True, "run": run, "cells": len(cells), "steps": steps, "notes": notes}
        tell_json({**told, "config": canonical(loaded)} if show else told)
    elif show:
        tell_text(dump_yaml(loaded).rstrip("\n"))
        for name in loaded.labs:
            drawn = lab_in_text(lab_called(name, loaded.labs)).splitlines()
            tell_text("\n".join(["#", f"# lab {name}:", *(f"# {line}" for line in drawn)]))
    else:
        tell(f"valid: {len(cells)} cell{'s' if len(cells) != 1 else ''}, {steps:,} steps; the run would be {run}")
