"""A run's folder: `<name>-<hash>`, its resolved config, and how a user's word for a run finds it."""

import json
import re
from collections.abc import Mapping
from pathlib import Path

from visitlab_cli.config.canonical import canonical_json, config_hash, dump_yaml, hashed
from visitlab_cli.config.loading import load
from visitlab_cli.config.model import Config
from visitlab_cli.config.problems import printable
from visitlab_cli.errors import ConfigError, NotFoundError, RunError, UsageError
from visitlab_cli.storage.cell_folder import one_line, reason, sync, to_json, write_durably
from visitlab_cli.storage.differences import differences, in_words
from visitlab_cli.whole_file import whole_file

CONFIG, VERSIONS = "config.yaml", "versions.json"
LATEST = "latest"


def run_name(config: Config) -> str:
    """The name of the folder of a config's run."""
    return f"{config.name}-{config_hash(config)}"


def open_run(out: Path, config: Config, versions: Mapping[str, str]) -> tuple[Path, Config]:
    """The run folder of `config` below `out`, made if it is not there, and the config it now stands for.

    More seeds than before, and other expected values, are written to its `config.yaml`; fewer leave it as it is.

    Raises:
        RunError: the folder can't be written, or its own config was edited.
    """
    run = out / run_name(config)
    try:
        if not (run / CONFIG).exists():
            run.mkdir(parents=True, exist_ok=True)
            _replace(run / VERSIONS, to_json(dict(versions)))
            _replace(run / CONFIG, dump_yaml(config))
            return run, config
        if not (run / VERSIONS).exists():
            _replace(run / VERSIONS, to_json(dict(versions)))  # `runs verify` set a damaged one aside
        stored = read_config(run)
        if canonical_json(stored) != canonical_json(config):
            raise RunError(
                f"{run / CONFIG}: was edited: {in_words(differences(hashed(config), hashed(stored)))}; "
                "restore it, or move the run away"
            )
        now = config.model_copy(
            update={"seeds": max(config.seeds, stored.seeds), "expected": config.expected or stored.expected}
        )
        if now != stored:
            _replace(run / CONFIG, dump_yaml(now))
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


def read_versions(run: Path) -> dict[str, str]:
    """The versions that a run was begun with, by name.

    Raises:
        RunError: their file is missing or damaged.
    """
    file = run / VERSIONS
    try:
        versions = json.loads(file.read_bytes())
    except FileNotFoundError:
        raise RunError(f"{file}: missing; running again writes it") from None
    except (OSError, ValueError, RecursionError):
        versions = None
    if not isinstance(versions, dict) or not all(isinstance(value, str) for value in versions.values()):
        raise RunError(f"{file}: damaged; delete it, and running again writes it")
    return versions


def _replace(file: Path, text: str) -> None:
    with whole_file(file) as beside:
        write_durably(beside, text)
    sync(file.parent)


def find_run(word: str, out: Path) -> Path:
    """The run folder that `word` names: a path, a name below `out`, a unique beginning of one, or `latest`.

    Raises:
        NotFoundError: there is none.
        UsageError: several begin so.
    """
    shown = printable(word)
    if not word:
        raise NotFoundError("no run is called ''")
    try:
        for path in (Path(word), out / word):
            if (path / CONFIG).is_file():
                return path
    except (OSError, ValueError) as error:
        raise NotFoundError(f"{shown}: {reason(error)}") from None
    runs = all_runs(out)
    if word == LATEST and runs:
        return max(runs, key=lambda run: run.stat().st_mtime)
    near = [run for run in runs if run.name.startswith(word)]
    same_name = [run for run in near if re.fullmatch(r"-[0-9a-f]{8}", run.name.removeprefix(word))]
    near = same_name or near
    if len(near) == 1:
        return near[0]
    if near:
        raise UsageError(f"{shown}: several runs begin so: {', '.join(run.name for run in near)}")
    known = f"; there are {', '.join(run.name for run in runs)}" if runs else ""
    raise NotFoundError(f"{shown}: no such run in {out}{known}")


def all_runs(out: Path) -> list[Path]:
    """The run folders below `out`, by name."""
    return sorted(file.parent for file in out.glob(f"*/{CONFIG}"))
