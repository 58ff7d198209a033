"""`visitlab run`: train the modules, play the visit, record, tell."""

from visitlab_cli.commands.options import RUNS, Config, Json, Out, Overrides, Quiet, Workers


def command(
    config: Config,
    overrides: Overrides = None,
    out: Out = RUNS,
    workers: Workers = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run everything that a config declares: trainings, then visits. What is done already is kept."""
    from visitlab_cli.commands.running import run_and_tell
    from visitlab_cli.config.loading import load
    from visitlab_cli.execution.cells import plan
    from visitlab_cli.execution.versions import versions
    from visitlab_cli.storage.run_folder import open_run

    folder, loaded = open_run(out, load(config, overrides or []), versions())
    run_and_tell(folder, loaded, plan(loaded), workers=workers, as_json=as_json, quiet=quiet)
