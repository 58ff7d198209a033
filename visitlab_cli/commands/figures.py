"""`visitlab figures`: the paper's figures from a run."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.commands import completion
from visitlab_cli.commands.options import RUNS, Json, Out, Run
from visitlab_cli.terminal import tell, tell_json

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def command(
    run: Run,
    only: Annotated[
        list[str] | None,
        typer.Option(
            help="This figure alone: fig6, fig7, fig8, fig9 or grid; may be repeated.",
            autocompletion=completion.words("fig6", "fig7", "fig8", "fig9", "grid"),
        ),
    ] = None,
    kind: Annotated[
        str,
        typer.Option("--format", "-f", help="svg, png or pdf.", autocompletion=completion.words("svg", "png", "pdf")),
    ] = "svg",
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Draw the paper's figures that a run has the data for, the published curves behind ours, and what a grid varies.

    A published curve is there only where all that decides it is as published. In RUN/figures/.
    """
    from visitlab_cli.figures.making import make_figures
    from visitlab_cli.storage.run_folder import find_run

    folder = find_run(run, out)
    made = make_figures(folder, strip, only or (), kind)
    for name, notes in made.notes.items():
        for note in notes:
            tell(f"{name}: {note}", err=True)
    files = [str(file) for file in made.files]
    tell_json({"run": str(folder), "files": files, "notes": made.notes}, None) if as_json else tell(*files)


def strip(log: Path, number: int) -> "Figure":
    """Draw a trial of a log as a strip."""
    from visitlab_cli.replay.strip import draw_strip
    from visitlab_cli.scene.moments import strip_steps
    from visitlab_cli.scene.trial import load_trial

    trial = load_trial(log, number)
    return draw_strip(trial, strip_steps(trial.steps))
