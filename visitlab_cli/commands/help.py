"""The help pages' panels, and two examples for each command, which the tests run as they stand."""

import typer

PANELS = {
    "Run": ("run", "train", "eval"),
    "Look": (
        "replay",
        "steps",
        "figures",
        "compare",
        "affordances",
        "optimum",
        "report",
        "export",
    ),
    "Configure": ("init", "validate", "schema", "doctor"),
    "Runs": ("runs", "recover"),
}

EXAMPLES = {
    "run": ("visitlab run quickstart", "visitlab run quickstart name=short experiments.social.steps=20000"),
    "train": ("visitlab train quickstart", "visitlab train my-human seeds=30 --workers 2 --dry-run"),
    "eval": ("visitlab eval quickstart", "visitlab eval quickstart --matrix --trials 20"),
    "replay": (
        "visitlab replay quickstart --trial worst --save worst.rrd",
        "visitlab replay quickstart --trial 31 --strip strip.svg",
    ),
    "steps": (
        "visitlab steps quickstart --trial worst",
        "visitlab steps quickstart --experiment social --trial 9000 --json",
    ),
    "figures": ("visitlab figures quickstart", "visitlab figures quickstart --only fig9 --format png"),
    "compare": ("visitlab compare quickstart", "visitlab compare quickstart short"),
    "affordances": ("visitlab affordances quickstart", "visitlab affordances quickstart --experiment social --json"),
    "optimum": ("visitlab optimum", "visitlab optimum --gamma 0.95 --json"),
    "report": ("visitlab report quickstart", "visitlab report latest --output report.html"),
    "export": (
        "visitlab export quickstart --csv --table results",
        "visitlab export quickstart --foxglove --trial worst",
    ),
    "init": ("visitlab init", "visitlab init my-human --folder experiments"),
    "validate": ("visitlab validate my-human", "visitlab validate quickstart seeds=10 --show"),
    "schema": ("visitlab schema | head", "visitlab schema > schema.json"),
    "doctor": ("visitlab doctor", "visitlab doctor --json"),
    "recover": (
        "visitlab recover runs/quickstart-*/visit/human_2/seed-0000/steps.mcap --output whole.mcap",
        "visitlab recover runs/quickstart-*/social/mb/human_2/seed-0000/steps.mcap --output social.mcap --json",
    ),
    "runs list": ("visitlab runs list", "visitlab runs list --json"),
    "runs show": ("visitlab runs show quickstart", "visitlab runs show latest --level 0.5"),
    "runs diff": ("visitlab runs diff quickstart short", "visitlab runs diff quickstart short --json"),
    "runs verify": ("visitlab runs verify quickstart", "visitlab runs verify latest --dry-run"),
    "runs prune": ("visitlab runs prune quickstart --dry-run", "visitlab runs prune latest"),
    "runs rm": ("visitlab runs rm short --yes", "visitlab runs rm quickstart --yes --json"),
}
"""By the command's words; the tests run them in this order."""

_PANEL_OF = {name: panel for panel, names in PANELS.items() for name in names}
_ORDER = list(_PANEL_OF)


def arrange(app: typer.Typer) -> None:
    """Give each command of `app` its panel and its examples, and the panels their order."""
    for command in app.registered_commands:
        command.rich_help_panel = _PANEL_OF.get(command.name or "")
        command.epilog = examples_of(command.name or "")
    for group in app.registered_groups:
        group.rich_help_panel = _PANEL_OF.get(group.name or "")
        for command in group.typer_instance.registered_commands if group.typer_instance else ():
            command.epilog = examples_of(f"{group.name} {command.name}")
    app.registered_commands.sort(key=lambda command: _place(command.name))


def _place(name: str | None) -> int:
    return _ORDER.index(name) if name in _ORDER else len(_ORDER)


def examples_of(words: str) -> str | None:
    """The end of a command's help page."""
    return "\n\n".join(["Examples:", *EXAMPLES[words]]) if words in EXAMPLES else None
