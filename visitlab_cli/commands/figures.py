"""`visitlab figures`: the paper's figures from a run."""

from typing import Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out, Run
from visitlab_cli.console.unread import tell_unread
from visitlab_cli.terminal import tell, tell_json

FIGURES = ("fig6", "fig7", "fig8", "fig9", "curves", "doors", "grid", "meetings", "phases", "visits")
"""As `figures.making` draws them; which is too heavy to ask."""

HELP = Help(
    "Look",
    place=3,
    examples=(
        "visitlab figures quickstart",
        "visitlab figures quickstart --only fig9 --format png",
    ),
)


def command(
    run: Run,
    only: Annotated[
        list[str] | None,
        typer.Option(
            help=f"This figure alone: {', '.join(FIGURES[:-1])} or {FIGURES[-1]}; may be repeated.",
            autocompletion=completion.words(*FIGURES),
        ),
    ] = None,
    kind: Annotated[
        str,
        typer.Option("--format", "-f", help="svg, png or pdf.", autocompletion=completion.words("svg", "png", "pdf")),
    ] = "svg",
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Draw the figure that answers the question of a run's config; where that asks none, all that it has data for.

    Of the paper's figures a published curve is there only where all that decides it is as published. In RUN/figures/.
    """
    from visitlab_cli.figures.making import make_figures
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.replay.strip import strip
    from visitlab_cli.storage.run_folder import find_run, read_config

    folder = find_run(run, out)
    made = make_figures(folder, strip, only or (), kind)
    tell_unread(folder, plan(read_config(folder)))
    for name, notes in made.notes.items():
        for note in notes:
            tell(f"{name}: {note}", err=True)
    files = [str(file) for file in made.files]
    tell_json({"run": str(folder), "files": files, "notes": made.notes}, None) if as_json else tell(*files)
