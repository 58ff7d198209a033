"""`visitlab train`: the trainings of a config, without its visits."""

from typing import TYPE_CHECKING

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

if TYPE_CHECKING:
    from visitlab_cli.config.model import Config as AnyConfig
    from visitlab_cli.plan.cells import Cell


HELP = Help(
    "Run",
    place=2,
    examples=(
        "visitlab train quickstart",
        "visitlab train my-human seeds=30 --workers 2 --dry-run",
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
    """Train the modules that a config declares. `visitlab eval RUN` then plays the visits."""
    from visitlab_cli.config.loading import load
    from visitlab_cli.console.running import How, dask_at, run_config

    at = dask_at(executor, address, scheduler_file, workers)
    loaded = load(config, overrides or [])
    run_config(out, loaded, _trainings, How(workers, dry_run, as_json, quiet, verbose, shard, at))


def _trainings(config: "AnyConfig") -> "list[Cell]":
    from visitlab_cli.plan.cells import plan

    return [cell for cell in plan(config) if not cell.settings.assembled]
