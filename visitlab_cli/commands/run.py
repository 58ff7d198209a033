"""`visitlab run`: train the modules, play the visit, record, tell."""

from visitlab_cli.commands.options import (
    RUNS,
    Config,
    DryRun,
    Json,
    NoColor,
    Out,
    Overrides,
    Quiet,
    Verbose,
    Workers,
)


def command(
    config: Config,
    overrides: Overrides = None,
    out: Out = RUNS,
    workers: Workers = 0,
    dry_run: DryRun = False,
    as_json: Json = False,
    quiet: Quiet = False,
    verbose: Verbose = False,
    no_color: NoColor = False,
) -> None:
    """Run everything that a config declares: trainings, then visits. What is done already is kept."""
    from visitlab_cli.commands.running import How, run_config
    from visitlab_cli.config.loading import load
    from visitlab_cli.execution.cells import plan

    loaded = load(config, overrides or [])
    run_config(out, loaded, plan, How(workers, dry_run, as_json, quiet, verbose))
