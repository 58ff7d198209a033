"""Python's way to make a run: `visitlab_cli.run(config)`, as `visitlab run` makes it."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from visitlab_cli.config.loading import load, load_text
from visitlab_cli.config.model import Config
from visitlab_cli.console.running import held_run, run_cells_of
from visitlab_cli.door import LoadedRun
from visitlab_cli.door import load as opened
from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.execution.progress import Progress
from visitlab_cli.plan.cells import plan

SOURCE = "the config"
"""What messages call a config that is in no file."""


def run(
    config: Mapping[str, Any] | str | Path, out: str | Path = "runs", *, workers: int = 1, quiet: bool = True
) -> LoadedRun:
    """Train and play all that a config asks for and that is missing, and open the run.

    The same config and seed give the same bytes as `visitlab run`, and go on where it stopped.

    Args:
        config: the settings as plain values, as the YAML has them; or a YAML file, or the name of a shipped config.
        out: the folder of all runs.
        workers: processes. One is a thread of this process, unless kinds of others take part; with more, a script needs
            `if __name__ == "__main__":`.
        quiet: whether only failures are told on standard error.

    Returns:
        The run, as `visitlab_cli.load` opens it.

    Raises:
        ConfigError: the config is invalid; a line for each problem.
        NotFoundError: there is no such file.
        UsageError: fewer workers than one.
        RunError: a cell failed, or nothing can be written; what was finished is kept.
    """
    if workers < 1:
        raise UsageError(f"workers={workers}: must be at least 1")
    settings = _settings(config)
    progress, folder = Progress(quiet=quiet), Path(out)
    with held_run(folder, settings, progress.warn) as (place, settings):
        failures = run_cells_of(place, plan(settings), workers, progress)
    if failures:
        raise RunError(*(f"{path}: {line}" for path, line in failures.items()))
    return opened(place)


def _settings(config: Mapping[str, Any] | str | Path) -> Config:
    if isinstance(config, Mapping):
        try:
            return load_text(json.dumps(dict(config)), SOURCE)
        except (TypeError, ValueError) as error:
            raise UsageError(f"{SOURCE}: must be plain values, as YAML has them: {error}") from error
    return load(config)
