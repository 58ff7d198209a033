"""`visitlab eval`: the visits of a run, or visits with options of their own on its models."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.console import completion
from visitlab_cli.console.help import Help
from visitlab_cli.console.options import (
    RUNS,
    Address,
    DryRun,
    Executor,
    Json,
    NoColor,
    Out,
    Plugins,
    Quiet,
    Run,
    SchedulerFile,
    Shard,
    Verbose,
    Workers,
)

if TYPE_CHECKING:
    from visitlab_cli.config.model import Config
    from visitlab_cli.plan.cells import Cell


HELP = Help(
    "Run",
    place=3,
    examples=(
        "visitlab eval quickstart",
        "visitlab eval quickstart --matrix --trials 20",
    ),
)


def command(
    run: Run,
    human: Annotated[
        list[str] | None,
        typer.Option(help="Visit this human of the config instead; may be repeated.", autocompletion=completion.humans),
    ] = None,
    trials: Annotated[int | None, typer.Option(min=1, max=10**9, help="Trials of each visit instead.")] = None,
    frozen: Annotated[bool, typer.Option("--frozen", help="No learning and no exploration.")] = False,
    experiment: Annotated[
        str, typer.Option("--experiment", "-e", help="This visit alone.", autocompletion=completion.experiments)
    ] = "",
    matrix: Annotated[
        bool,
        typer.Option("--matrix", help="Every trained human against every human, frozen and adapting; of one visit."),
    ] = False,
    picture: Annotated[
        Path | None,
        typer.Option(
            help="Where the matrix is drawn, .svg, .png or .pdf; else RUN/figures/matrix.svg, of another visit than "
            "the config's first matrix-VISIT.svg."
        ),
    ] = None,
    plugin: Plugins = None,
    out: Out = RUNS,
    workers: Workers = 0,
    shard: Shard = "",
    executor: Executor = "local",
    address: Address = "",
    scheduler_file: SchedulerFile = None,
    dry_run: DryRun = False,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    no_color: NoColor = False,
) -> None:
    """Assemble the global task from a run's trained modules and play it."""
    from visitlab_cli.config.building import check_plugin_files
    from visitlab_cli.console.matrix import check_options, planned_cells, play_matrix
    from visitlab_cli.console.running import How, dask_at, run_and_tell
    from visitlab_cli.errors import NotFoundError, UsageError
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.evaluation import Evaluation
    from visitlab_cli.plan.notes import notes_on
    from visitlab_cli.storage.run_folder import find_run, read_config
    from visitlab_cli.terminal import tell_all
    from visitlab_cli.wording import or_else, printable

    at = dask_at(executor, address, scheduler_file, workers)
    check_options(matrix=matrix, frozen=frozen, picture=picture)
    check_plugin_files()
    folder = find_run(run, out)
    config = read_config(folder)
    humans = list(config.humans)
    for name in human or []:
        if name not in humans:
            raise NotFoundError(
                f"--human {printable(name)}: the run's config declares no such human{or_else(name, humans)}"
            )
    visits = [name for name, each in config.experiments.items() if each.assembled]
    if not visits:
        raise NotFoundError(f"{folder}: its config declares no visit")
    if experiment and experiment not in visits:
        near = or_else(experiment, visits)
        raise NotFoundError(f"--experiment {printable(experiment)}: the run's config declares no such visit{near}")
    if trials is not None and not human and not matrix:
        for name in [experiment] if experiment else visits:
            if config.experiments[name].phases:
                raise UsageError(f"--trials: {name} has phases, which say their trials; say --human, too")
    how = How(workers, dry_run, as_json, quiet, verbose, shard, at)
    if matrix:
        planned = planned_cells(folder, config, experiment or visits[0], human or (), trials)
        _check_trained(folder, config, [cell for cells in planned.values() for cell in cells])
        play_matrix(folder, planned, picture, how)
        return
    cells = plan(config, Evaluation(tuple(human or ()), trials, frozen))
    chosen = [cell for cell in cells if experiment in ("", cell.experiment)]
    _check_trained(folder, config, chosen)
    if not quiet:
        tell_all(notes_on(chosen))
    run_and_tell(folder, config, chosen, how)


def _check_trained(folder: Path, config: "Config", cells: "Sequence[Cell]") -> None:
    """Refuse what needs a module that is not trained, or was trained with another config."""
    from visitlab_cli.errors import RunError
    from visitlab_cli.execution.runner import missing_cells
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.storage.cell_folder import read_cell
    from visitlab_cli.storage.run_folder import CONFIG

    needed = {path for cell in missing_cells(folder, cells) for path in cell.modules.values()}
    untrained = missing_cells(folder, [c for c in plan(config) if not c.settings.assembled and c.path in needed])
    if untrained:
        command = f"visitlab train {folder}/config.yaml --out {folder.parent}"
        raise RunError(f"{folder}: not trained yet: {untrained[0].path}; train it with {command}")
    made_with = {cell["config_hash"] for path in needed if (cell := read_cell(folder / path)) is not None}
    if made_with - {cells[0].run_hash}:
        raise RunError(f"{folder / CONFIG}: was edited after the modules were trained; restore it, or train anew")
