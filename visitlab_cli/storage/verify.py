"""Is a run as it was written? Each of its cells, its config and its versions; and setting aside what is not.

A damaged cell can be set aside: its `cell.json` gets another name, so that the cell counts as missing and running
again makes it, and it alone, anew.
"""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.config.canonical import config_hash
from visitlab_cli.errors import VisitlabError
from visitlab_cli.storage.cell_folder import CELL, one_line
from visitlab_cli.storage.differences import differences, in_words
from visitlab_cli.storage.on_disk import cell_folders, set_aside, was_set_aside
from visitlab_cli.storage.reading import UnreadableError, read_json
from visitlab_cli.storage.run_folder import CONFIG, VERSIONS, edited, hash_of_name, read_config, read_versions
from visitlab_cli.storage.verify_cell import cell_faults


class Fault(NamedTuple):
    """Something wrong: `cell` is its path, empty for the run's own files."""

    cell: str
    file: str
    problem: str

    def __str__(self) -> str:
        return f"{self.cell}/{self.file}: {self.problem}" if self.cell else f"{self.file}: {self.problem}"


Unsound = Callable[[str], tuple[str, str] | None]
"""From a cell's path to what is wrong with what it holds: the file and the problem."""


class Verified(NamedTuple):
    """The paths of the cells found in a run, which of them are whole, all that is wrong, and what can't be read.

    `unread` has a line for each cell of which nobody can tell whether it is damaged or whole, by its path.
    """

    found: list[str]
    whole: list[str]
    faults: list[Fault]
    unread: dict[str, str]


def verify(
    run: Path, steps: Mapping[str, int], versions: Mapping[str, str], unsound: Unsound = lambda path: None
) -> Verified:
    """Read every byte of a run and say what is not as it was written.

    Args:
        run: the run's folder.
        steps: the steps of each planned cell, by its path; of what is not planned, they are not checked, nor where
            the config is in doubt.
        versions: those of this program, which may have made a cell.
        unsound: what the plan finds wrong with a cell whose hashes are right, which somebody may have written anew.

    Raises:
        UnreadableError: a folder, or a file of the run itself, can't be read.
    """
    folders = cell_folders(run)
    stated = [_stated(folder) for folder in folders]
    digest, faults = _run_hash(run, {each.get("config_hash") for each in stated})
    steps = {} if faults else steps
    made_with = [each.get("versions") for each in stated]
    versions_of_run, problem = _versions_of(run)
    problem = problem or _of_no_cell(versions_of_run, [each for each in made_with if isinstance(each, dict)], versions)
    faults += [Fault("", VERSIONS, problem)] if problem else []
    found, whole, unread = [], [], {}
    for folder, its_versions in zip(folders, made_with, strict=True):
        path = folder.relative_to(run).as_posix()
        found.append(path)
        try:
            problems = cell_faults(folder, path, digest, steps.get(path))
            if not problems and path in steps and (found_wrong := unsound(path)):
                problems = [found_wrong]
        except UnreadableError as error:
            unread[path] = str(error)
            continue
        if not problems and its_versions not in (versions_of_run, versions) and made_with.count(its_versions) == 1:
            problems = [(CELL, "has versions that neither the run, nor another cell, nor this program has")]
        if problems:
            faults += [Fault(path, *problem) for problem in problems]
        else:
            whole.append(path)
    return Verified(found, whole, faults, unread)


def set_faults_aside(run: Path, faults: list[Fault]) -> dict[str, str]:
    """Make what is damaged count as missing; the run's config stays, since everything depends on it.

    Returns:
        Why it was not possible, by the file; empty where it was.
    """
    failed = {}
    wanted = {run / fault.cell / CELL for fault in faults if fault.cell}
    wanted |= {run / fault.file for fault in faults if fault.file == VERSIONS and not fault.cell}
    for file in sorted(wanted):
        try:
            if file.is_file():
                set_aside(file)
        except OSError as error:
            failed[str(file)] = one_line(error)
    return failed


def _run_hash(run: Path, stated: set[Any]) -> tuple[str | None, list[Fault]]:
    """The hash that the cells must state, as far as it is beyond doubt, and what is wrong with the config."""
    of_name = hash_of_name(run)
    try:
        of_config = config_hash(read_config(run))
    except UnreadableError:
        raise
    except VisitlabError as error:
        return of_name, [Fault("", CONFIG, str(error).removeprefix(f"{run / CONFIG}: "))]
    if problem := edited(run, of_config):
        return of_name, [Fault("", CONFIG, problem.removeprefix(f"{run / CONFIG}: "))]
    if of_name is None:  # the folder was renamed
        if of_config in stated or not stated - {None}:
            return of_config, []
        return None, [Fault("", CONFIG, f"was edited: its hash is {of_config}, and no cell was made with it")]
    return of_name, []


def _stated(folder: Path) -> dict[str, Any]:
    """What a cell says of itself, right or wrong; empty where it can't be read."""
    try:
        cell = read_json(folder / CELL)
    except (OSError, ValueError, UnreadableError):
        return {}
    return cell if isinstance(cell, dict) and isinstance(cell.get("config_hash"), str) else {}


def _versions_of(run: Path) -> tuple[dict[str, str] | None, str | None]:
    """The versions that a run was begun with, or what is wrong with their file."""
    if not (run / VERSIONS).exists():
        return None, "set aside as damaged by an earlier verify" if was_set_aside(run / VERSIONS) else "missing"
    try:
        return read_versions(run), None
    except UnreadableError:
        raise
    except VisitlabError:
        return None, "damaged"


def _of_no_cell(
    versions_of_run: dict[str, str] | None, made_with: list[dict[str, str]], versions: Mapping[str, str]
) -> str | None:
    """That no cell was made with what the run says it was begun with, where the cells vouch for other versions."""
    if versions_of_run is None or versions_of_run in made_with:
        return None
    vouched = [each for each in made_with if each == versions or made_with.count(each) > 1]
    return f"fits no cell: {in_words(differences(vouched[0], versions_of_run))}" if vouched else None
