"""docs/commands.md: what `--help` says of each command, in plain text."""

import os
import subprocess
import sys

from visitlab_cli import commands
from visitlab_cli.console.help import PANELS, commands_in, examples_in

EXAMPLES = dict(examples_in(commands))

HEAD = """# Commands

Made from `visitlab COMMAND --help` by `python -m tests.docs.make`. Every example is run by the tests.

Every command that prints a result has `--json`. The result goes to stdout, everything else to stderr.
`visitlab --install-completion` teaches the shell the commands, configs, runs and names.

| exit code | means |
|---|---|
| 0 | done |
| 1 | a bug of ours |
| 2 | wrong usage |
| 3 | the config is invalid |
| 4 | a run failed, is incomplete, can't be written, or misses a value that its config expects |
| 5 | not found: file, run, trial, or what an option names of a run or config, such as an experiment or a human |
| 130 | interrupted; the same command goes on from there |
"""
WIDTH = 100


def commands_page() -> str:
    """The page, made in a process of its own, since typer decides on its layout when it is imported."""
    environment = os.environ | {"TYPER_USE_RICH": "0", "PYTHONPATH": os.pathsep.join(sys.path)}
    command = [sys.executable, "-m", "tests.docs.commands_page"]
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout


def page() -> str:
    import typer

    from visitlab_cli.cli import app

    program = typer.main.get_command(app)
    parts = [HEAD]
    for panel in PANELS:
        parts.append(f"## {panel}\n")
        for name, module in commands_in(commands):
            if module.HELP.panel == panel:
                parts += sections(program.commands[name], f"visitlab {name}")
    return "\n".join(parts)


def sections(command, words):
    """A command's help, or that of each command within it."""
    if hasattr(command, "commands"):
        for name, each in command.commands.items():
            yield from sections(each, f"{words} {name}")
        return
    context = command.context_class(
        command,
        info_name=words,
        terminal_width=WIDTH,
        max_content_width=WIDTH,
        help_option_names=["-h", "--help"],
    )
    command.epilog = None
    yield f"### {words}\n"
    yield block("\n".join(EXAMPLES[words.removeprefix("visitlab ")]))
    yield block(command.get_help(context).strip())


def block(text):
    return f"```\n{text}\n```\n"


if __name__ == "__main__":
    sys.stdout.write(page())
