"""`visitlab validate`: check a config and say what it would do."""

import json

import typer

from visitlab_cli.commands.options import Config, Json, Overrides


def command(config: Config, overrides: Overrides = None, as_json: Json = False) -> None:
    """Check a config: every error at once, each with its place; else what it would run."""
    from visitlab_cli.config.canonical import config_hash
    from visitlab_cli.config.loading import load
    from visitlab_cli.execution.cells import plan

    loaded = load(config, overrides or [])
    cells = plan(loaded)
    steps = sum(cell.steps for cell in cells)
    run = f"{loaded.name}-{config_hash(loaded)}"
    if as_json:
        typer.echo(json.dumps({"valid": True, "run": run, "cells": len(cells), "steps": steps}, indent=2))
    else:
        typer.echo(f"valid: {len(cells)} cells, {steps:,} steps; the run would be {run}")
