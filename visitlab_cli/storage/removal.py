"""Taking things away: what is no use in a run, and a whole run. Never a file of the user's, never through a link."""

import contextlib
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.config.names import RESERVED_EXPERIMENTS
from visitlab_cli.errors import NotFoundError, RunError, UsageError, VisitlabError
from visitlab_cli.origin import is_ours
from visitlab_cli.storage.cell_folder import (
    DAMAGED,
    OF_CELLS,
    TEMPORARY,
    is_temporary,
    one_line,
    read_cell,
)
from visitlab_cli.storage.inside import is_real
from visitlab_cli.storage.leftovers import is_left_over, is_locked
from visitlab_cli.storage.locks import RUN_LOCK, to_remove
from visitlab_cli.storage.on_disk import (
    EVALUATIONS,
    FAILURES,
    FIGURES,
    JOBS,
    OPTIONS,
    REPORT,
    cell_folders,
    is_seed_folder,
    leftovers,
    walk,
)
from visitlab_cli.storage.reading import check_damage
from visitlab_cli.storage.run_folder import CONFIG, VERSIONS, hash_of_name, is_run, read_config, read_versions, run_name

_FIGURE = re.compile(
    r"(fig[6-9]|curves|doors|grid|meetings|phases|visits|matrix(-[\w.-]+)?|affordances[\w.-]*)\.(svg|png|pdf)"
)
"""The pictures that visitlab draws into a run."""


class Pruned(NamedTuple):
    """What was removed of a run, and what was kept with the reason; paths below the run."""

    removed: list[str]
    kept: dict[str, str]


def prune(run: Path, dry_run: bool = False) -> Pruned:
    """Remove what killed processes left and the cells that are not whole; nothing that is whole.

    Raises:
        RunError: something can't be looked into, or not be removed.
    """
    if dry_run:
        return _prune(run, dry_run)
    with to_remove(run):
        return _prune(run, dry_run)


def _prune(run: Path, dry_run: bool) -> Pruned:
    damaged = [folder for folder in cell_folders(run) if read_cell(folder) is None]
    pruned = Pruned([], {})
    aside = [run / f"{name}{DAMAGED}" for name in (CONFIG, VERSIONS)]  # what else ends so is the user's
    for path in [*leftovers(run), *filter(_is_file, aside), *damaged]:
        name = path.relative_to(run).as_posix()
        reason = _in_use(path) or _holds_foreign(path)
        if reason:
            pruned.kept[name] = reason
            continue
        if not dry_run:
            _remove(path)
        pruned.removed.append(name)
    return pruned


def _in_use(path: Path) -> str | None:
    busy = path.name.startswith(TEMPORARY) and not is_left_over(path)
    return "is being written" if busy else None


def _holds_foreign(path: Path) -> str | None:
    if path.name.startswith(TEMPORARY) or not is_real(path):
        return None
    foreign = sorted({entry.name for entry in path.iterdir()} - OF_CELLS)
    return f"holds {foreign[0]}, which is not visitlab's" if foreign else None


def check_removable(run: Path) -> None:
    """Refuse to remove what is not a run, was renamed, is being written, or holds files that are not the run's.

    Raises:
        NotFoundError: it is no run folder.
        UsageError: it is a link.
        RunError: it was renamed, is in use, or not only a run; or some of it could not be removed.
    """
    if run.is_symlink():
        raise UsageError(f"{run}: a link to {os.readlink(run)}; remove that")
    if not (is_run(run) and (run / VERSIONS).is_file()):
        raise NotFoundError(f"{run}: not a run (a run's folder is called name-hash and has {CONFIG} and {VERSIONS})")
    if hash_of_name(run) is None:
        raise RunError(f"{run}: was renamed, so that it may be kept; to remove it, rename it to {_name_made_with(run)}")
    busy = [path.name for path in leftovers(run) if is_locked(path) and not is_left_over(path)]
    if busy:
        raise RunError(f"{run}: is being written ({busy[0]}); stop that first")
    foreign = next(foreign_files(run), None)
    if foreign:
        raise RunError(f"{run}: holds {foreign}, which is not visitlab's; move it away first")
    for folder in (run.resolve().parent, *(folder for folder, _, _ in walk(run))):
        if not os.access(folder, os.W_OK | os.X_OK):
            raise RunError(f"{run}: can't be removed: {folder} may not be written in")


def _name_made_with(run: Path) -> str:
    try:
        read_versions(run)
        return run_name(read_config(run))
    except VisitlabError as error:
        raise NotFoundError(f"{run}: not a run: {error}") from None


def foreign_files(run: Path) -> Iterator[str]:
    """The files that visitlab did not write, as paths below the run; a link is none, for nothing is lost with it.

    Raises:
        UnreadableError: a folder, or a page or picture, can't be looked into.
    """
    top = {RUN_LOCK, *RESERVED_EXPERIMENTS, *(name + DAMAGED for name in RESERVED_EXPERIMENTS)} - {REPORT}
    for folder, folders, files in walk(run):
        known, drawn = set(OF_CELLS if is_seed_folder(folder.name) else ()), set[str]()
        if folder == run:
            folders[:] = [name for name in folders if not is_temporary(folder / name)]
            known, drawn = top, {REPORT}
        elif folder == run / FIGURES:
            known, drawn = set(), {name for name in files if _FIGURE.fullmatch(name)}
        elif folder in (run / FAILURES, run / JOBS):
            known, drawn = set(), set(files)
        elif folder.parent == run / EVALUATIONS:
            known, drawn = {OPTIONS}, {"matrix.svg"}  # the picture is of an earlier version
        for name in sorted(set(files) - known):
            file = folder / name
            if not (file.is_symlink() or (name in drawn and _is_ours(file)) or _is_temporary(file, run)):
                yield file.relative_to(run).as_posix()


def _is_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()


def remove_run(run: Path) -> None:
    """Remove a run's folder; its config goes last, so that what an interruption leaves is still a run.

    Raises:
        as `check_removable`; RunError: something can't be removed.
    """
    check_removable(run)
    with to_remove(run):
        check_removable(run)
        for path in sorted(run.iterdir(), key=lambda path: (path.name == RUN_LOCK, path.name in (CONFIG, VERSIONS))):
            _remove(path)
        try:
            run.rmdir()
        except OSError as error:
            raise RunError(f"{run}: can't be removed: {one_line(error)}") from error


def remove_unbegun(run: Path) -> None:
    """Remove a run's folder that has only what it was made with; not while somebody writes in it."""
    made_with = {RUN_LOCK, CONFIG, VERSIONS}
    with contextlib.suppress(OSError, RunError), to_remove(run):
        if {path.name for path in run.iterdir()} <= made_with:
            for name in made_with:
                (run / name).unlink(missing_ok=True)
            run.rmdir()


def _remove(path: Path) -> None:
    try:
        if is_real(path):
            shutil.rmtree(path)
        else:
            path.unlink()
    except OSError as error:
        raise RunError(f"{path}: can't be removed: {one_line(error)}") from error


def _is_temporary(file: Path, run: Path) -> bool:
    return (file.parent in (run, run / FIGURES) or file.parent.parent == run / EVALUATIONS) and is_temporary(file)


def _is_ours(file: Path) -> bool:
    try:
        return is_ours(file)
    except OSError as error:
        check_damage(file, error)
        return False
