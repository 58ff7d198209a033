"""`visitlab eval`: the visits of a run, or visits with options of their own on its models."""

from typing import Annotated

import typer

from visitlab_cli.commands import completion
from visitlab_cli.commands.options import RUNS, DryRun, Json, NoColor, Out, Quiet, Run, Verbose, Workers


def command(
    run: Run,
    human: Annotated[
        list[str] | None,
        typer.Option(help="Visit this human of the config instead; may be repeated.", autocompletion=completion.humans),
    ] = None,
    trials: Annotated[int | None, typer.Option(min=1, max=10**9, help="Trials of each visit instead.")] = None,
    frozen: Annotated[bool, typer.Option("--frozen", help="No learning and no exploration.")] = False,
    out: Out = RUNS,
    workers: Workers = 0,
    dry_run: DryRun = False,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    no_color: NoColor = False,
) -> None:
    """Assemble the global task from a run's trained modules and play it."""
    from visitlab_cli.commands.running import How, run_and_tell
    from visitlab_cli.config.problems import or_else, printable
    from visitlab_cli.errors import RunError, UsageError
    from visitlab_cli.execution.cells import Evaluation, plan
    from visitlab_cli.execution.runner import missing_cells
    from visitlab_cli.storage.cell_folder import read_cell
    from visitlab_cli.storage.run_folder import CONFIG, find_run, read_config
    from visitlab_cli.world.columns import VISIT

    folder = find_run(run, out)
    config = read_config(folder)
    for name in human or []:
        if name not in config.humans:
            raise UsageError(
                f"--human {printable(name)}: the run's config declares no such human{or_else(name, list(config.humans))}"
            )
    cells = plan(config, Evaluation(tuple(human or ()), trials, frozen))
    if not cells:
        raise UsageError(f"{folder}: its config declares no visit")
    needed = {path for cell in missing_cells(folder, cells) for path in cell.modules.values()}
    untrained = missing_cells(folder, [c for c in plan(config) if c.task != VISIT and c.path in needed])
    if untrained:
        command = f"visitlab train {folder}/config.yaml --out {folder.parent}"
        raise RunError(f"{folder}: not trained yet: {untrained[0].path}; train it with {command}")
    made_with = {cell["config_hash"] for path in needed if (cell := read_cell(folder / path)) is not None}
    if made_with - {cells[0].run_hash}:
        raise RunError(f"{folder / CONFIG}: was edited after the modules were trained; restore it, or train anew")
    run_and_tell(folder, config, cells, How(workers, dry_run, as_json, quiet, verbose))
