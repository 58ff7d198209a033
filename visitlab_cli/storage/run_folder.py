"""A run's folder: `<name>-<hash>`, its resolved config, and how a user's word for a run finds it."""

import json
import os
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from visitlab_cli.config.canonical import canonical, canonical_json, config_hash, dump_yaml
from visitlab_cli.config.loading import load
from visitlab_cli.config.model import Config
from visitlab_cli.errors import ConfigError, NotFoundError, RunError, UsageError
from visitlab_cli.storage.cell_folder import one_line, sync, to_json, write_durably

CONFIG, VERSIONS = "config.yaml", "versions.json"
LATEST = "latest"
MOST_DIFFERENCES = 5


def open_run(out: Path, config: Config, versions: Mapping[str, str]) -> tuple[Path, Config]:
    """The run folder of `config` below `out`, made if it is not there, and the config it now stands for.

    More seeds than before are written to its `config.yaml`; fewer leave it as it is.

    Raises:
        RunError: the folder can't be written, or its own config was edited.
    """
    run = out / f"{config.name}-{config_hash(config)}"
    try:
        if not (run / CONFIG).exists():
            run.mkdir(parents=True, exist_ok=True)
            _replace(run / VERSIONS, to_json(dict(versions)))
            _replace(run / CONFIG, dump_yaml(config))
            return run, config
        stored = read_config(run)
        if canonical_json(stored) != canonical_json(config):
            raise RunError(
                f"{run / CONFIG}: was edited: {_differences(config, stored)}; restore it, or move the run away"
            )
        if config.seeds > stored.seeds:
            _replace(run / CONFIG, dump_yaml(config))
    except OSError as error:
        raise RunError(f"{run}: can't be written: {one_line(error)}") from error
    return run, config


def read_config(run: Path) -> Config:
    """The config of a run folder.

    Raises:
        NotFoundError: this is no run folder.
        RunError: its config is damaged.
    """
    if not (run / CONFIG).is_file():
        raise NotFoundError(f"{run}: not a run (it has no {CONFIG})")
    try:
        return load(run / CONFIG)
    except ConfigError as error:
        raise RunError(f"{str(error).splitlines()[0]} (the run's own config was edited)") from error


def _replace(file: Path, text: str) -> None:
    beside = file.with_name(f".tmp-{file.name}-{uuid.uuid4().hex[:8]}")
    write_durably(beside, text)
    os.replace(beside, file)
    sync(file.parent)


def _differences(config: Config, other: Config) -> str:
    ours, theirs = _flat(canonical(config)), _flat(canonical(other))
    paths = [path for path in sorted(ours | theirs) if ours.get(path) != theirs.get(path)]
    told = [f"{path} is {_shown(theirs, path)}, not {_shown(ours, path)}" for path in paths[:MOST_DIFFERENCES]]
    return ", ".join(told) + (f" and {len(paths) - len(told)} more" if len(paths) > len(told) else "")


def _shown(flat: dict[str, Any], path: str) -> str:
    return json.dumps(flat[path]) if path in flat else "missing"


def _flat(plain: Any, path: str = "") -> dict[str, Any]:
    if not isinstance(plain, dict):
        return {path: plain}
    return {
        where: value
        for key, inner in plain.items()
        for where, value in _flat(inner, f"{path}.{key}" if path else key).items()
    }


def find_run(word: str, out: Path) -> Path:
    """The run folder that `word` names: a path, a name below `out`, a unique beginning of one, or `latest`.

    Raises:
        NotFoundError: there is none.
        UsageError: several begin so.
    """
    for path in (Path(word), out / word):
        if (path / CONFIG).is_file():
            return path
    runs = all_runs(out)
    if word == LATEST and runs:
        return max(runs, key=lambda run: run.stat().st_mtime)
    near = [run for run in runs if run.name.startswith(word)]
    if len(near) == 1:
        return near[0]
    if near:
        raise UsageError(f"{word}: several runs begin so: {', '.join(run.name for run in near)}")
    known = f"; there are {', '.join(run.name for run in runs)}" if runs else ""
    raise NotFoundError(f"{word}: no such run in {out}{known}")


def all_runs(out: Path) -> list[Path]:
    """The run folders below `out`, by name."""
    return sorted(file.parent for file in out.glob(f"*/{CONFIG}"))
