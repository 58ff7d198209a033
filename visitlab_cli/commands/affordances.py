"""`visitlab affordances`: what the social module believes, beside what is true."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, At, Json, Out, Run
from visitlab_cli.console.unread import tell_unread
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.plan.cells import Cell
    from visitlab_cli.plan.selection import Selection


HELP = Help(
    "Look",
    place=5,
    examples=(
        "visitlab affordances quickstart --human human_2 --json",
        "visitlab affordances quickstart --intents --threshold 0.5 --trials 200",
    ),
)


def command(
    run: Run,
    experiment: Annotated[
        str,
        typer.Option(
            "--experiment",
            "-e",
            help="Of this training, or that this visit begins with; else the visits'.",
            autocompletion=completion.experiments,
        ),
    ] = "",
    agent: Annotated[str, typer.Option(help="Of this agent.", autocompletion=completion.agents)] = "",
    human: Annotated[
        str,
        typer.Option(
            help="Trained with this human; with --experiment of a visit, visited.", autocompletion=completion.humans
        ),
    ] = "",
    seed: Annotated[
        int | None, typer.Option(min=0, help="Of this repetition, from 0; else the first, with --intents all.")
    ] = None,
    at: At = None,
    intents: Annotated[
        bool,
        typer.Option(
            "--intents",
            help="What is left of the reward with each human if it plans only with pairs of state and action that "
            "afford an intent: the human faces the robot, the distance becomes appropriate, the interaction advances, "
            "the human is led, keeps following.",
        ),
    ] = False,
    models: Annotated[
        bool,
        typer.Option(
            "--models",
            help="Of a visit whose agent has several models (multi_model): what each believes, what is general, what "
            "is specific, and whose each model is. --experiment is then the visit.",
        ),
    ] = False,
    threshold: Annotated[
        list[float] | None,
        typer.Option(
            "--threshold",
            metavar="K",
            help="With --intents: as likely an intent must be; may be repeated. Else 0.05 to 0.9.",
        ),
    ] = None,
    trials: Annotated[
        int | None,
        typer.Option(min=1, max=10**6, help="With --intents: trials that each plan is played; else 2000."),
    ] = None,
    picture: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Draw it, with how it adapts: a .svg, .png or .pdf."),
    ] = None,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """The learned Fig. 4: what the social module thinks that its actions do, beside what they do.

    --json has every action and level, and where it would go around the human.
    """
    from dataclasses import replace

    from visitlab_cli.affordances.learned import affordances
    from visitlab_cli.affordances.plain import as_json as to_json
    from visitlab_cli.console.affordances import text
    from visitlab_cli.origin import check_ours
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.selection import Selection
    from visitlab_cli.storage.run_folder import find_run, read_config
    from visitlab_cli.world.columns import ENGAGEMENT

    if picture is not None:
        check_ours(picture)
    _check_options(threshold or [], trials, intents=intents, models=models)
    folder = find_run(run, out)
    cells = plan(read_config(folder))
    selection = Selection(experiment, human, agent, seed, tuple(at or ()))
    selection.of(folder, cells)  # else what it names is not there
    if intents:
        _tell_intents(folder, cells, selection, threshold, trials, picture, as_json=as_json)
        return
    if models:
        _tell_models(folder, cells, replace(selection, seed=seed or 0), picture, as_json=as_json)
        return
    of_seed = replace(selection, seed=seed or 0)
    found = affordances(folder, cells, of_seed)
    tell_unread(folder, [cell for cell in cells if of_seed.matches(cell) and cell.settings.plays.has(ENGAGEMENT)])
    if picture is not None:
        from visitlab_cli.affordances.picture import save_affordances

        save_affordances(found, picture)
        tell_json({"run": str(folder), "file": str(picture)}, None) if as_json else tell(str(picture))
    elif as_json:
        tell_json({"run": str(folder), **to_json(found)})
    else:
        tell_text(text(found, cells))


def _check_options(thresholds: Sequence[float], trials: int | None, *, intents: bool, models: bool) -> None:
    from visitlab_cli.errors import UsageError

    if intents and models:
        raise UsageError("--models: not together with --intents")
    for name, given in (("--threshold", bool(thresholds)), ("--trials", trials is not None)):
        if given and not intents:
            raise UsageError(f"{name}: goes with --intents only")
    for each in thresholds:
        if not 0 < each <= 1:
            raise UsageError(f"--threshold {each:g}: must be a probability above 0")


def _tell_models(
    folder: Path, cells: "Sequence[Cell]", selection: "Selection", picture: Path | None, *, as_json: bool
) -> None:
    from visitlab_cli.affordances.several import as_json as to_json
    from visitlab_cli.affordances.several import several_models
    from visitlab_cli.console.affordances import models_text

    found = several_models(folder, cells, selection)
    of_it = [cell for cell in cells if cell.experiment == found.cell.experiment]
    tell_unread(folder, [cell for cell in of_it if selection.matches(cell)])
    if picture is not None:
        from visitlab_cli.affordances.several_picture import save_several

        save_several(found, picture)
        tell_json({"run": str(folder), "file": str(picture)}, None) if as_json else tell(str(picture))
    elif as_json:
        tell_json({"run": str(folder), **to_json(found)})
    else:
        tell_text(models_text(found))


def _tell_intents(
    folder: Path,
    cells: "Sequence[Cell]",
    selection: "Selection",
    thresholds: Sequence[float] | None,
    trials: int | None,
    picture: Path | None,
    *,
    as_json: bool,
) -> None:
    from visitlab_cli.affordances.restricted import THRESHOLDS, TRIALS, restricted
    from visitlab_cli.affordances.restricted import as_json as to_json
    from visitlab_cli.console.affordances import intents_text

    if picture is not None:
        from visitlab_cli.affordances.intents_picture import save_intents
        from visitlab_cli.affordances.picture import check_ending

        check_ending(picture)
    trials = trials or TRIALS
    found = restricted(folder, cells, selection, sorted(set(thresholds or THRESHOLDS)), trials)
    groups = {each.group for each in found}
    tell_unread(folder, [cell for cell in cells if cell.group in groups and selection.matches(cell)])
    if picture is not None:
        save_intents(found, picture, figure.names if (figure := cells[0].config.figure) else {})
        tell_json({"run": str(folder), "file": str(picture)}, None) if as_json else tell(str(picture))
    elif as_json:
        tell_json({"run": str(folder), **to_json(found, trials)})
    else:
        tell_text(intents_text(found, trials))
