"""`visitlab run`: train the modules, play the visit, record, tell."""

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import (
    RUNS,
    Address,
    Config,
    DryRun,
    Executor,
    Json,
    NoColor,
    Out,
    Overrides,
    Plugins,
    Quiet,
    SchedulerFile,
    Shard,
    Verbose,
    Workers,
)

HELP = Help(
    "Run",
    place=1,
    examples=(
        "visitlab run quickstart",
        "visitlab run quickstart name=short experiments.social.steps=20000",
    ),
)


def command(
    config: Config,
    overrides: Overrides = None,
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
    """Run everything that a config declares: trainings, then visits. What is done already is kept."""
    from visitlab_cli.config.loading import load
    from visitlab_cli.console.running import How, dask_at, run_config
    from visitlab_cli.plan.cells import plan

    at = dask_at(executor, address, scheduler_file, workers)
    loaded = load(config, overrides or [])
    run_config(out, loaded, plan, How(workers, dry_run, as_json, quiet, verbose, shard, at))
