"""`visitlab doctor`: what this installation and machine can do, and what to do about what they can't."""

import os
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Literal, NamedTuple

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out
from visitlab_cli.terminal import tell, tell_json

HELP = Help(
    "Configure",
    place=4,
    examples=(
        "visitlab doctor",
        "visitlab doctor --runs runs --json",
    ),
)


PACKAGES = ("numpy", "numba", "pydantic", "pyarrow", "mcap", "protobuf", "matplotlib", "rerun-sdk")
MODULE_OF = {"rerun-sdk": "rerun", "protobuf": "google.protobuf"}
LITTLE_SPACE = 2e9  # bytes; quickstart takes 50 MB, the paper's runs with every step 5 GB
LITTLE_FILES, FILES_A_CELL = 100_000, 6  # five files and their folder
SLOW_SYNC, SYNCS_A_CELL = 0.05, 8  # seconds


class Finding(NamedTuple):
    """One line: what was looked at, what was found, whether it is `ok`, only worth a `note`, or a `problem`."""

    name: str
    value: str
    state: Literal["ok", "note", "problem"] = "ok"


def command(
    out: Out = RUNS,
    runs: Annotated[
        Path | None,
        typer.Option(
            "--runs",
            metavar="FOLDER",
            help="Only what this folder, or the one in which it would be made, can do of that which a cluster needs.",
        ),
    ] = None,
    as_json: Json = False,
) -> None:
    """Look at versions, cores, the cache, the disk, and whether Rerun can open a window here.

    Exits with 4 if something is in the way of a run; a note is about what works otherwise only.
    """
    from visitlab_cli.errors import RunError

    looks, folder = (LOOKS, out) if runs is None else (LOOKS_AT_RUNS, runs)
    findings = [finding for look in looks for finding in look(folder)]
    if as_json:
        tell_json([finding._asdict() for finding in findings])
    else:
        width = max(len(finding.name) for finding in findings)
        for finding in findings:
            mark = "" if finding.state == "ok" else f"{finding.state}: "
            tell(f"{finding.name:{width}}  {mark}{finding.value}")
    if problems := [finding.name for finding in findings if finding.state == "problem"]:
        raise RunError(f"in the way of a run: {', '.join(problems)}")


def _versions(out: Path) -> Iterator[Finding]:
    import platform
    from importlib import import_module
    from importlib.metadata import PackageNotFoundError, version

    from visitlab_cli import __version__

    yield Finding("visitlab", __version__)
    yield Finding("python", f"{platform.python_version()} on {platform.system()} {platform.machine()}")
    for package in PACKAGES:
        try:
            import_module(MODULE_OF.get(package, package))
            yield Finding(package, version(package))
        except (ImportError, OSError, PackageNotFoundError) as error:
            yield Finding(package, f"can't be imported: {str(error).splitlines()[0]}; install it anew", "problem")


def _cores(out: Path) -> Iterator[Finding]:
    from visitlab_cli.console.running import cores

    here, there = cores(), os.cpu_count() or 1
    yield Finding("cores", f"{here}" if here == there else f"{here} of the machine's {there}")


def _cache(out: Path) -> Iterator[Finding]:
    try:
        from visitlab_cli.compiled import JIT_DISABLED, cache_folder, cache_place
    except Exception:
        return  # numba's own line says it
    folder = cache_folder()
    if JIT_DISABLED:
        yield Finding("compiler", "switched off by NUMBA_DISABLE_JIT: a hundred times slower", "note")
    elif folder is None:
        advice = "every command compiles anew, ten seconds; set VISITLAB_CACHE to a folder of your own"
        yield Finding("cache", f"none: {cache_place().why}: {advice}", "note")
    else:
        size = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
        state = f"{size / 1e6:.0f} MB of compiled code" if size else "empty: the first run compiles for ten seconds"
        yield Finding("cache", f"{folder} ({state})")


def _disk(out: Path) -> Iterator[Finding]:
    from visitlab_cli.storage.file_system import existing, hindrance

    if why := hindrance(out):
        yield Finding("runs", f"{out}: can't be written: {why}; choose another folder with --out", "problem")
        return
    place = existing(out)
    free = shutil.disk_usage(place).free
    space = f"only {free / 1e9:.1f} GB free" if free < LITTLE_SPACE else f"{free / 1e9:.0f} GB free"
    made = "" if place == out.absolute() else f"; it is not there yet, and a run makes it: this is of {place}"
    yield Finding("runs", f"{out}: {space}{made}", "note" if free < LITTLE_SPACE else "ok")


WITHOUT = {
    "creates": "two runners may take the same cell, and each does all",
    "locks": "what killed runs left is known by their processes, and of other machines by an hour of silence",
    "renames": "no cell can be finished there; choose another folder with --out",
    "times": "a runner on another machine seems dead while it works, and its cells are done twice",
    "syncs": "what is finished may be lost when the machine loses power",
}
"""What follows where a file system can't do something."""


def _abilities(out: Path) -> Iterator[Finding]:
    from visitlab_cli.storage.file_system import existing, hindrance, what_works

    if hindrance(out):
        return  # told already
    place = existing(out)
    for what, problem in what_works(place).items():
        if problem:
            state: Literal["note", "problem"] = "problem" if what == "renames" else "note"
            yield Finding(what, f"{place}: {problem}: {WITHOUT[what]}", state)
        else:
            yield Finding(what, f"{place}: works")


def _shared(out: Path) -> Iterator[Finding]:
    from visitlab_cli.storage.file_system import existing, mount_of

    if (mount := mount_of(existing(out))) is None:
        return
    if mount.is_local:
        yield Finding(
            "shared", f"{mount.type}: this machine alone sees it; the nodes of a cluster need another", "note"
        )
    elif why := mount.locks_here_alone:
        heard = "runners on different nodes know each other by signs of life alone"
        yield Finding("shared", f"{mount.type}: locks hold within a node ({why}): {heard}", "note")
    else:
        yield Finding("shared", f"{mount.type}{': other machines may see it' if mount.is_shared else ''}")


def _fast(out: Path) -> Iterator[Finding]:
    from visitlab_cli.storage.file_system import existing, hindrance, seconds_of_a_sync

    if hindrance(out):
        return
    try:
        seconds = seconds_of_a_sync(existing(out))
    except OSError:
        return  # told as what can't be synced
    told = f"{seconds * 1e3:.1f} ms until a small file is on the disk, {SYNCS_A_CELL} times a cell"
    if seconds > SLOW_SYNC:
        yield Finding(
            "speed", f"{told}: cells of less than {10 * SYNCS_A_CELL * seconds:.0f} s wait rather than play", "note"
        )
    else:
        yield Finding("speed", told)


def _files(out: Path) -> Iterator[Finding]:
    from visitlab_cli.storage.file_system import existing, hindrance

    if hindrance(out):
        return
    place = existing(out)
    told = os.statvfs(place)
    if told.f_files == 0:
        yield Finding("files", f"{place}: as many as there is room for")
        return
    cells = f"{told.f_favail:,} more may be made, {told.f_favail // FILES_A_CELL:,} cells"
    state: Literal["ok", "note"] = "note" if told.f_favail < LITTLE_FILES else "ok"
    yield Finding("files", f"{place}: {'only ' if state == 'note' else ''}{cells}", state)


def _viewer(out: Path) -> Iterator[Finding]:
    from visitlab_cli.errors import UsageError
    from visitlab_cli.replay.viewer import check_display

    try:
        check_display()
        yield Finding("viewer", "there is a display for Rerun's window")
    except UsageError as error:
        yield Finding("viewer", str(error), "note")


LOOKS: tuple[Callable[[Path], Iterator[Finding]], ...] = (_versions, _cores, _cache, _disk, _abilities, _viewer)
LOOKS_AT_RUNS: tuple[Callable[[Path], Iterator[Finding]], ...] = (_disk, _shared, _abilities, _fast, _files)
