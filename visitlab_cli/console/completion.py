"""What the shell completes: configs, runs, humans, agents. Only names of files are read, and a run's own config.

A run's config.yaml is as `dump_yaml` writes it: its sections' names stand at the margin, their entries two spaces in.
"""

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import typer

from visitlab_cli.terminal import plain

PACKAGE = Path(__file__).parent.parent
LATEST, CONFIG = "latest", "config.yaml"
MOST_LETTERS = 1 << 20  # of a config that is looked through
NAMED = re.compile(r"^name:", re.MULTILINE)
ENTRY = re.compile(r"  ([A-Za-z0-9][A-Za-z0-9._-]*):")


def _beginning(names: list[str], incomplete: str) -> list[str]:
    """Those that may be what the user types; a name that a terminal would obey is not offered."""
    return [name for name in names if name.startswith(incomplete) and name == plain(name)]


def shipped(incomplete: str) -> list[str]:
    """The shipped configs; those in a folder once the word has come that far."""
    in_wheel = PACKAGE / "shipped_configs"
    folder = in_wheel if in_wheel.is_dir() else PACKAGE.parent / "configs"
    files = sorted(folder.glob("*/" * incomplete.count("/") + "*.yaml"))
    whole = [file for file in files if NAMED.search(file.read_text(encoding="utf-8"))]
    return _beginning([file.relative_to(folder).with_suffix("").as_posix() for file in whole], incomplete)


def configs(incomplete: str) -> list[str]:
    """The shipped configs, then files and folders that the word may become."""
    folder = incomplete.rpartition("/")[0]
    found = sorted(Path(folder or ("/" if incomplete.startswith("/") else ".")).glob("*"))
    paths = [f"{path}/" if path.is_dir() else str(path) for path in found if _may_hold_config(path)]
    return shipped(incomplete) + _beginning(paths, incomplete)


def _may_hold_config(path: Path) -> bool:
    return not path.name.startswith(".") and (path.is_dir() or path.suffix in (".yaml", ".yml"))


def runs(ctx: typer.Context, incomplete: str) -> list[str]:
    """The runs in the folder of all runs, `latest`, and folders once the word is a path."""
    folder, slash, begun = incomplete.rpartition("/")
    if slash:
        found = [path for path in sorted(Path(f"{folder}/").glob(f"{begun}*")) if path.is_dir()]
        names = [f"{folder}/{path.name}{'' if (path / CONFIG).is_file() else '/'}" for path in found]
        return _beginning(names, incomplete)
    return _beginning([run.name for run in _all_runs(ctx)] + [LATEST], incomplete)


def humans(ctx: typer.Context, incomplete: str) -> list[str]:
    """The humans of the run that the command names."""
    return _beginning(_declared(ctx, "humans"), incomplete)


def agents(ctx: typer.Context, incomplete: str) -> list[str]:
    """The agents of the run that the command names."""
    return _beginning(_declared(ctx, "agents"), incomplete)


def experiments(ctx: typer.Context, incomplete: str) -> list[str]:
    """The experiments of the run that the command names."""
    return _beginning(_declared(ctx, "experiments"), incomplete)


def words(*known: str) -> Callable[[str], list[str]]:
    """A completion that knows all words."""
    return lambda incomplete: _beginning(list(known), incomplete)


def varied(ctx: typer.Context, incomplete: str) -> list[str]:
    """What a run's conditions are compared by: agent, human, experiment, phase, the settings that vary."""
    return _beginning(["agent", "human", "experiment", "phase", *_declared(ctx, "vary")], incomplete)


def _all_runs(ctx: typer.Context) -> list[Path]:
    return [folder for folder in sorted(Path(ctx.params.get("out") or "runs").glob("*")) if _has_config(folder)]


def _has_config(folder: Path) -> bool:
    try:
        return (folder / CONFIG).is_file()
    except PermissionError:
        return False


def _declared(ctx: typer.Context, section: str) -> list[str]:
    word = str(ctx.params.get("run") or next(iter(ctx.args), ""))  # what an unfinished line leaves unparsed
    known = _all_runs(ctx)
    if word == LATEST:
        known.sort(key=lambda run: run.stat().st_mtime, reverse=True)
    fitting = [Path(word), *(run for run in known if word == LATEST or run.name.startswith(word))]
    for run in fitting:
        if word and _has_config(run):
            return list(_entries(run / CONFIG, section))
    return []


def _entries(config: Path, section: str) -> Iterator[str]:
    inside = False
    with config.open(encoding="utf-8", errors="replace") as file:
        lines = file.read(MOST_LETTERS).splitlines()
    for line in lines:
        if not line.startswith(" "):
            inside = line.startswith(f"{section}:")
        elif inside and (entry := ENTRY.match(line)):
            yield entry[1]
