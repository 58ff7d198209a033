"""The command line: one file a command in `commands/`; nothing heavy is imported before a command runs."""

import sys
from typing import Annotated

import typer

from visitlab_cli import __version__
from visitlab_cli.commands import eval as eval_command
from visitlab_cli.commands import replay, run, train, validate
from visitlab_cli.errors import Interrupted, VisitlabError

app = typer.Typer(
    help="Run, record and replay the 'visit the lab' task: a robot wins a human's attention and leads it "
    "through goal rooms.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _version(asked: bool) -> None:
    if asked:
        typer.echo(__version__)
        raise typer.Exit


@app.callback()
def visitlab(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and exit.")
    ] = False,
) -> None:
    """See `visitlab COMMAND --help`."""


app.command("run")(run.command)
app.command("train")(train.command)
app.command("eval")(eval_command.command)
app.command("replay")(replay.command)
app.command("validate")(validate.command)


def main() -> None:
    """The program: every failure that a user can mend is a clear line and an exit code."""
    try:
        app()
    except VisitlabError as error:
        sys.stderr.write(f"{error}\n")
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        sys.exit(Interrupted.exit_code)
    except BrokenPipeError:
        sys.stderr.close()  # the reader left; nothing is wrong, and nothing more can be said
        sys.exit(0)
