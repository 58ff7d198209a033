"""The command line: every file in `commands/` is a command; nothing heavy is imported before a command runs."""

import errno
import os
import sys
from types import ModuleType
from typing import Annotated

import typer

from visitlab_cli import __version__, commands
from visitlab_cli.console.help import commands_in
from visitlab_cli.console.options import NoColor
from visitlab_cli.console.program import Command, Program
from visitlab_cli.errors import Interrupted, NotFoundError, RunError, VisitlabError, reason
from visitlab_cli.stopping import interruptible, was_asked
from visitlab_cli.terminal import end, lead_nowhere, tell

app = typer.Typer(
    cls=Program,
    help="Run, record and replay the 'visit the lab' task: a robot wins a human's attention and leads it "
    "through goal rooms.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        tell(__version__)
        raise typer.Exit


@app.callback()
def visitlab(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
    no_color: NoColor = False,
) -> None:
    """See `visitlab COMMAND --help`."""


def _add(group: typer.Typer, folder: ModuleType) -> None:
    """Add what lies in a folder of commands: a module is a command, a folder a group of them."""
    for name, module in commands_in(folder):
        panel, epilog = module.HELP.panel, module.HELP.epilog
        if hasattr(module, "__path__"):
            within = typer.Typer(help=module.HELP.summary, no_args_is_help=True)
            _add(within, module)
            group.add_typer(within, name=name, rich_help_panel=panel)
        else:
            within_panel = panel if group is app else None
            group.command(name, cls=Command, rich_help_panel=within_panel, epilog=epilog)(module.command)


_add(app, commands)


def main() -> None:
    """The program: every failure that a user can mend is a clear line and an exit code."""
    try:
        with interruptible():
            try:
                _run()
            except BaseException as error:
                failed = isinstance(error, SystemExit) and error.code  # and has said so
                if failed or not (was_asked() or isinstance(error, KeyboardInterrupt)):
                    raise
                raise KeyboardInterrupt from None
    except KeyboardInterrupt:  # told out here, where an interruption does not come again
        end(Interrupted.exit_code, "interrupted")


def _run() -> None:
    try:
        app(prog_name="visitlab")
    except VisitlabError as error:
        end(error.exit_code, *map(str, error.args))
    except SystemExit as error:
        if isinstance(error.__context__, BrokenPipeError):  # rich: the reader of what it printed left
            lead_nowhere()
            sys.exit(0)
        if error.code == Interrupted.exit_code:  # typer: it has caught Ctrl-C, and said nothing
            raise KeyboardInterrupt from None
        raise
    except MemoryError as error:
        end(RunError.exit_code, ": ".join(filter(None, ["not enough memory", str(error)])))
    except OSError as error:
        missing = error.filename is not None and isinstance(error, FileNotFoundError | NotADirectoryError)
        end(NotFoundError.exit_code if missing else RunError.exit_code, f"{_what(error)}: {reason(error)}")


def _what(error: OSError) -> str:
    """What the system refused; help, which is not ours to print, is written without a name."""
    if isinstance(error.filename, str | bytes | os.PathLike):
        return os.fsdecode(error.filename)
    if error.errno in (errno.EBADF, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.ENOSPC):
        lead_nowhere()
        return "the output can't be written"
    return "the system does not let us go on"
