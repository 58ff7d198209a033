"""`visitlab train`: the trainings of a config, without its visits."""

from visitlab_cli.commands.options import RUNS, Config, Json, Out, Overrides, Quiet, Workers


def command(
    config: Config,
    overrides: Overrides = None,
    out: Out = RUNS,
    workers: Workers = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Train the modules that a config declares. `visitlab eval RUN` then plays the visits."""
    from visitlab_cli.commands.running import run_and_tell
    from visitlab_cli.config.loading import load
    from visitlab_cli.execution.cells import plan
    from visitlab_cli.execution.versions import versions
    from visitlab_cli.storage.run_folder import open_run
    from visitlab_cli.world.columns import VISIT

    folder, loaded = open_run(out, load(config, overrides or []), versions())
    trainings = [cell for cell in plan(loaded) if cell.task != VISIT]
    run_and_tell(folder, loaded, trainings, workers=workers, as_json=as_json, quiet=quiet)
