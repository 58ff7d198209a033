"""A run's folder: `<name>-<hash>`, its resolved config, and how a user's word for a run finds it."""

import re
from collections.abc import Mapping
from pathlib import Path

from visitlab_cli.config.canonical import canonical_json, config_hash, dump_yaml, hashed
from visitlab_cli.config.loading import load_content
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import RESERVED_RUNS
from visitlab_cli.errors import ConfigError, NotFoundError, RunError, UsageError
from visitlab_cli.storage.cell_folder import DAMAGED, one_line, read_cell, reason, sync, to_json, write_durably
from visitlab_cli.storage.differences import differences, in_words
from visitlab_cli.storage.on_disk import cell_folders, set_aside
from visitlab_cli.storage.reading import UnreadableError, check_damage, read_bytes, read_json
from visitlab_cli.whole_file import whole_file
from visitlab_cli.wording import printable
from visitlab_cli.yaml.files import MOST_BYTES

CONFIG, VERSIONS = "config.yaml", "versions.json"
(LATEST,) = RESERVED_RUNS


def run_name(config: Config) -> str:
    """The name of the folder of a config's run."""
    return f"{config.name}-{config_hash(config)}"


def run_folder(out: Path, config: Config) -> Path:
    """The folder of a config's run below `out`, made if it is not there.

    Raises:
        RunError: it can't be made, or something else is there.
    """
    run = out / run_name(config)
    try:
        run.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RunError(f"{run}: can't be written: {one_line(error)}") from error
    return run


def open_run(out: Path, config: Config, versions: Mapping[str, str]) -> tuple[Path, Config]:
    """The run folder of `config` below `out`, made if it is not there, and the config it now stands for.

    More seeds than before, other expected values and another figure are written to its `config.yaml`; fewer leave it as
    it is.

    Raises:
        RunError: the folder can't be written, or its own config was edited or is damaged.
    """
    run = out / run_name(config)
    try:
        if not (run / CONFIG).exists():
            run.mkdir(parents=True, exist_ok=True)
            _write_versions(run, versions)
            _replace(run / CONFIG, dump_yaml(config))
            return run, config
        _write_versions(run, versions)
        stored = read_config(run)
        if canonical_json(stored) != canonical_json(config):
            raise RunError(
                f"{run / CONFIG}: was edited: {in_words(differences(hashed(config), hashed(stored)))}; "
                "delete it and do the same again, which writes it as it was, or move the run away"
            )
        told = {"expected": config.expected or stored.expected, "figure": config.figure or stored.figure}
        now = config.model_copy(update={"seeds": max(config.seeds, stored.seeds), **told})
        if now != stored:
            _replace(run / CONFIG, dump_yaml(now))
    except OSError as error:
        raise RunError(f"{run}: can't be written: {one_line(error)}") from error
    return run, config


def mend_config(out: Path, config: Config) -> str | None:
    """Where the config in the run folder of `config` can't be read, set it aside for `open_run` to write it anew.

    Returns:
        What was done, in a line; None where nothing was.

    Raises:
        UnreadableError: nobody can tell whether it is damaged.
        RunError: it can't be set aside, or another lies there.
    """
    file = out / run_name(config) / CONFIG
    aside = file.with_name(CONFIG + DAMAGED)
    try:
        read_config(file.parent)
        return None
    except UnreadableError:
        raise
    except (NotFoundError, RunError):
        if not file.is_file():
            return None
    if aside.exists():
        raise RunError(f"{file}: damaged, and so was {aside}, which is kept; move that away first")
    try:
        set_aside(file)
    except OSError as error:
        raise RunError(f"{file}: damaged, and can't be set aside: {one_line(error)}") from error
    return f"{file}: was damaged; it is kept as {aside.name} and written anew"


def _write_versions(run: Path, versions: Mapping[str, str]) -> None:
    """Say what the run was begun with: `versions` while no cell is finished, else, where it is missing, what cells say.

    It is missing where `runs verify` set it aside as damaged.
    """
    finished = next((cell for folder in cell_folders(run) if (cell := read_cell(folder)) is not None), None)
    begun = to_json(dict(versions) if finished is None else finished["versions"])
    if not (run / VERSIONS).exists() or (finished is None and not _says(run / VERSIONS, begun)):
        _replace(run / VERSIONS, begun)


def _says(file: Path, text: str) -> bool:
    try:
        return read_bytes(file, len(text.encode())) == text.encode()
    except ValueError:  # it is longer
        return False


def read_config(run: Path) -> Config:
    """The config of a run folder.

    Raises:
        NotFoundError: this is no run folder.
        RunError: its config is missing, damaged or can't be read.
    """
    file = run / CONFIG
    try:
        return load_content(read_bytes(file, MOST_BYTES), file)
    except (FileNotFoundError, NotADirectoryError):
        if is_run(run):
            anew = "run the config that the run was made from, which writes it anew"
            raise RunError(f"{file}: missing; {anew}") from None
        raise NotFoundError(f"{run}: not a run (it has no {CONFIG})") from None
    except (OSError, ValueError) as error:
        raise RunError(f"{printable(str(file))}: can't be read: {reason(error)}; move it away") from error
    except ConfigError as error:
        raise RunError(f"{str(error).splitlines()[0]} (the run's own config was edited)") from error


def edited(run: Path, of_config: str) -> str | None:
    """A line that says so where the hash of a run's config is not the one that its folder is named after; else None."""
    of_name = hash_of_name(run)
    if of_name in (None, of_config):
        return None
    return f"{run / CONFIG}: was edited: its hash is {of_config}, the folder's name says {of_name}"


def hash_of_name(run: Path) -> str | None:
    """The config hash that a run folder is named after; None where the folder was renamed."""
    match = re.search(r"-([0-9a-f]{8})$", run.resolve().name)
    return match[1] if match else None


def read_versions(run: Path) -> dict[str, str]:
    """The versions that a run was begun with, by name.

    Raises:
        RunError: their file is missing or damaged.
    """
    file = run / VERSIONS
    try:
        versions = read_json(file)
    except FileNotFoundError:
        raise RunError(f"{file}: missing; running again writes it") from None
    except (OSError, ValueError):
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
        UnreadableError: `out` can't be looked into.
    """
    shown = printable(word)
    if not word:
        raise NotFoundError("no run is called ''")
    try:
        for path in (Path(word), out / word):
            if is_run(path):
                return path
    except (OSError, ValueError) as error:
        if isinstance(error, OSError):
            check_damage(Path(word), error)
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
    """The run folders below `out`, by name.

    Raises:
        UnreadableError: it can't be looked into.
    """
    try:
        return sorted(folder for folder in out.iterdir() if folder.is_dir() and is_run(folder))
    except OSError as error:
        check_damage(out, error)
        return []  # there is no such folder


def is_run(folder: Path) -> bool:
    """Whether a folder is a run's; one that lost its config is known by its name and its versions.

    One that can't be looked into is taken for what its name says.
    """
    has_name = hash_of_name(folder) is not None
    try:
        return (folder / CONFIG).is_file() or (has_name and (folder / VERSIONS).is_file())
    except PermissionError:
        return has_name
