"""The program as a group of commands: wrong usage is one line, and a reader that leaves early is no failure."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import typer
import typer.core

from visitlab_cli.errors import UsageError
from visitlab_cli.terminal import lead_nowhere

WRONG_USAGE = cast(type[Exception], typer.BadParameter.__base__)
ASKS_FOR_HELP = "NoArgsIsHelpError"
"""The name of the one that is no error: a group without a command shows its help."""
NO_COLOR = "--no-color"
PLAINER = {
    "Input should be a valid integer, unable to parse string as an integer": "must be a whole number",
    "Input should be a valid number, unable to parse string as a number": "must be a number",
}


class Program(typer.core.TyperGroup):
    """The commands; `--no-color` may stand before or after any of them."""

    def make_context(self, info_name: str | None, args: list[str], parent: Any = None, **extra: Any) -> Any:
        """Parse what stands before the command."""
        own = args[: args.index("--")] if "--" in args else args
        if NO_COLOR in own:
            args = [NO_COLOR, *(arg for arg in own if arg != NO_COLOR), *args[len(own) :]]
        try:
            return super().make_context(info_name, args, parent, **extra)
        except WRONG_USAGE as error:
            raise _as_line(self, error) from None

    def invoke(self, ctx: Any) -> Any:
        """Run a command."""
        try:
            return super().invoke(ctx)
        except WRONG_USAGE as error:
            raise _as_line(self, error) from None
        except BrokenPipeError:
            lead_nowhere()
            raise typer.Exit from None


class Command(typer.core.TyperCommand):
    """A command: no argument of it and no path may be empty, as of a variable that was not set."""

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Parse the words."""
        raw = list(args)
        left = super().parse_args(ctx, args)
        if ctx.resilient_parsing:
            return left
        words = self.make_parser(ctx).parse_args(raw)[0]
        for param in self.params:
            if "" not in _each(words.get(param.name)):
                continue
            if param.param_type_name == "argument":
                raise UsageError(f"{param.metavar or param.name.upper()}: must not be empty")
            if any(isinstance(value, Path) for value in _each(ctx.params[param.name])):
                raise UsageError(f"{max(param.opts, key=len)}: must not be empty")
        return left


def _each(value: Any) -> Iterator[Any]:
    """The values of an option that may be repeated, or the one."""
    yield from value if isinstance(value, list | tuple) else [value]


def _as_line(program: Program, error: Any) -> Exception:
    """What was wrong, with the command that it was and where its help is."""
    if type(error).__name__ == ASKS_FOR_HELP:
        return cast(Exception, error)
    command = error.ctx.command_path if error.ctx is not None else "visitlab"
    message = str(error.format_message()).rstrip(".")
    for words, plainer in PLAINER.items():
        message = message.replace(words, plainer)
    for group, commands in program.commands.items():
        for name in getattr(commands, "commands", ()):
            if message == f"No such command '{name}'":
                message += f"; did you mean '{group} {name}'?"
    return UsageError(f"{command}: {message[0].lower()}{message[1:]}; see {command} --help")
