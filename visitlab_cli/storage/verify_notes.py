"""What `verify` tells beside faults: files that are not visitlab's, cells of no plan, timings that can't be read."""

from collections.abc import Collection, Iterator
from pathlib import Path

from visitlab_cli.storage.facts import TIMING, seconds_of
from visitlab_cli.storage.made_by import made_by, mixed
from visitlab_cli.storage.removal import foreign_files
from visitlab_cli.wording import few

MOST_NAMED = 3


def notes(run: Path, found: Collection[str], planned: Collection[str] | None) -> Iterator[str]:
    """A line for each kind of thing that is worth knowing and no fault.

    Args:
        run: the run's folder.
        found: the paths of the cells in it.
        planned: the paths of the cells that its config has, or an evaluation; None where the config is in doubt.
    """
    if told := mixed(made_by(run, found)):
        yield told
    if unplanned := sorted(set(found) - set(found if planned is None else planned)):
        yield f"not in the plan of the run's config (has it less seeds than before?): {few(unplanned, MOST_NAMED)}"
    if untimed := [f"{path}/{TIMING}" for path in found if seconds_of(run / path) is None]:
        yield f"missing or damaged, which changes no result: {few(untimed, MOST_NAMED)}"
    if foreign := list(foreign_files(run)):
        yield f"not visitlab's: {few(foreign, MOST_NAMED)}"
