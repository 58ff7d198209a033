"""`visitlab replay`: a recorded trial in the Rerun viewer, as a file, in a browser, as a picture, as a strip."""

from pathlib import Path
from typing import Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import (
    RUNS,
    Agent,
    At,
    Experiment,
    Human,
    Json,
    Out,
    Phase,
    RunOrFile,
    Seed,
    TrialWord,
)
from visitlab_cli.console.unread import tell_unread
from visitlab_cli.terminal import tell, tell_json

HELP = Help(
    "Look",
    place=1,
    examples=(
        "visitlab replay quickstart --trial worst --save worst.rrd",
        "visitlab replay quickstart --trial 31 --strip strip.svg",
    ),
)


def command(
    run: RunOrFile,
    experiment: Experiment = "",
    human: Human = "",
    agent: Agent = "",
    seed: Seed = None,
    at: At = None,
    trial: TrialWord = "0",
    phase: Phase = None,
    save: Annotated[Path | None, typer.Option(help="Write an .rrd file instead.")] = None,
    web: Annotated[bool, typer.Option("--web", help="Serve it to a browser on this machine instead.")] = False,
    png: Annotated[Path | None, typer.Option(help="Write a picture of --step instead; needs no screen.")] = None,
    step: Annotated[int | None, typer.Option(min=0, help="The step of the picture.")] = None,
    strip: Annotated[Path | None, typer.Option(help="Write a comic strip instead: .png, .svg or .pdf.")] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Replay a recorded trial: in the viewer, or wherever an option says."""
    from visitlab_cli.errors import UsageError

    if sum((save is not None, web, png is not None, strip is not None)) > 1:
        raise UsageError("--save, --web, --png and --strip: choose one")
    if (png is None) != (step is None):
        raise UsageError("--png and --step: a picture needs both, as in --png picture.png --step 12")
    if save is not None and save.suffix.lower() != ".rrd":
        raise UsageError(f"--save {save}: must end in .rrd")
    from visitlab_cli.origin import check_ours
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.replay.choice import choose_trial, find_logs
    from visitlab_cli.scene.trial import load_trial

    if target := save or png or strip:
        check_ours(target)
    logs = find_logs(run, out, Selection(experiment, human, agent, seed, tuple(at or ())))
    tell_unread(logs.run, logs.cells)
    picked = choose_trial(logs, trial, phase)
    chosen = load_trial(picked.log.path, picked.trial)
    if save is None and not web and png is None and strip is None:
        from visitlab_cli.replay.viewer import check_display

        check_display()
    if picked.note:
        tell(picked.note, err=True)
    if strip is not None:
        from visitlab_cli.replay.strip import save_strip
        from visitlab_cli.scene.moments import left_out, strip_steps

        save_strip(chosen, strip)
        if missing := left_out(chosen.steps, strip_steps(chosen.steps, chosen.lab), chosen.lab):
            tell(f"not on the strip: {missing}", err=True)
    elif png is not None and step is not None:
        from visitlab_cli.replay.picture import save_picture

        save_picture(chosen, step, png)
    else:
        from visitlab_cli.replay.recording import record
        from visitlab_cli.replay.viewer import serve, show
        from visitlab_cli.whole_file import write_again

        content = record(chosen)
        if save is not None:
            write_again(save, content)
        elif web:
            serve(content, lambda address: tell(address, "Ctrl-C ends it."))
        else:
            show(content)
    if target:
        told = {"cell": picked.log.cell, "trial": chosen.number, "file": str(target)}
        tell_json(told, None) if as_json else tell(f"{chosen.name}: {target}")
