"""`visitlab runs verify`: is every file of a run as it was written?"""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from visitlab_cli.console.help import Help
from visitlab_cli.console.options import RUNS, Json, Out, Run
from visitlab_cli.console.words import run_again
from visitlab_cli.terminal import tell, tell_json

if TYPE_CHECKING:
    from visitlab_cli.config.model import Config
    from visitlab_cli.storage.verify import Fault


HELP = Help(
    "Runs",
    place=4,
    examples=(
        "visitlab runs verify quickstart",
        "visitlab runs verify latest --dry-run",
    ),
)


def command(
    run: Run,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Tell, and change nothing.")] = False,
    out: Out = RUNS,
    as_json: Json = False,
) -> None:
    """Compute every hash anew and name what is wrong; running again then mends that, and that alone.

    Logs, trials and models have hashes, in cell.json; the config's is in the folder's name. timing.json, figures
    and report.html have none. The cell.json of a damaged cell is renamed to cell.json.damaged, so that the cell
    counts as missing. What can't be read counts as neither whole nor damaged, and is left as it is.
    """
    from visitlab_cli.errors import RunError, VisitlabError
    from visitlab_cli.execution.versions import versions
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.plan.evaluation import unknown_evaluations
    from visitlab_cli.plan.saved import unsound
    from visitlab_cli.results.evaluated import evaluated
    from visitlab_cli.storage.inside import check_all_inside
    from visitlab_cli.storage.on_disk import EVALUATIONS, OPTIONS
    from visitlab_cli.storage.reading import UnreadableError
    from visitlab_cli.storage.run_folder import CONFIG, VERSIONS, find_run, read_config
    from visitlab_cli.storage.verify import Fault, set_faults_aside, verify
    from visitlab_cli.storage.verify_notes import notes

    folder = find_run(run, out)
    check_all_inside(folder, (CONFIG, VERSIONS, EVALUATIONS))
    config: Config | None
    try:
        config = read_config(folder)
        planned = plan(config)
        played = [cell for cells in evaluated(folder, config).values() for cell in cells]
    except UnreadableError:
        raise
    except VisitlabError:  # `verify` says what is wrong with the config
        config, planned, played = None, [], []
    check_all_inside(folder, [cell.path for cell in [*planned, *played]])
    cells = {cell.path: cell for cell in [*planned, *played]}
    steps = {path: cell.steps for path, cell in cells.items()}
    checked = verify(folder, steps, versions(), lambda path: unsound(folder, cells[path]))
    options = [Fault(path, OPTIONS, "missing or damaged") for path in unknown_evaluations(folder)]
    checked = checked._replace(faults=[*checked.faults, *options])
    failed = {} if dry_run else set_faults_aside(folder, checked.faults)
    doubtful = any(fault.file == CONFIG and not fault.cell for fault in checked.faults)
    absent = [] if doubtful else sorted({cell.path for cell in planned} - set(checked.found))
    known = {cell.path for cell in [*planned, *played]}
    known |= {path for path in checked.found if any(path.startswith(f"{fault.cell}/") for fault in options)}
    readable = [path for path in checked.found if path not in checked.unread]
    noted = list(notes(folder, readable, None if doubtful else known))
    if as_json:
        told = {
            "run": str(folder),
            "cells": len(checked.found),
            "whole": len(checked.whole),
            "not_run": absent,
            "faults": [fault._asdict() for fault in checked.faults],
            "not_set_aside": failed,
            "unread": checked.unread,
            "notes": noted,
        }
        tell_json(told)
    else:
        for fault in checked.faults:
            tell(str(fault))
        for note in noted:
            tell(f"note: {note}")
        missing = f"; {len(absent)} more are not run yet" if absent else ""
        tell(f"{folder}: {len(checked.whole)} of {len(checked.found)} cells are as they were written{missing}")
    to_do = [*checked.unread.values()]
    if checked.faults:
        to_do += _what_to_do(folder, config, checked.faults, failed, dry_run)
    if to_do:
        raise RunError(*to_do)


def _what_to_do(
    run: Path, config: "Config | None", faults: "list[Fault]", failed: dict[str, str], dry_run: bool
) -> Iterator[str]:
    """How the damage is mended, a line for each kind of it."""
    from visitlab_cli.storage.on_disk import EVALUATIONS
    from visitlab_cli.storage.run_folder import CONFIG, VERSIONS, run_name

    own = {fault.file for fault in faults if not fault.cell}
    evaluated = {fault.cell for fault in faults if fault.cell.startswith(f"{EVALUATIONS}/")}
    planned = {fault.cell for fault in faults if fault.cell} - evaluated
    if CONFIG in own:
        edited = "delete it and " if config is not None else ""
        yield f"{run / CONFIG}: restore it, or {edited}run the config that it was made from"
    if dry_run:
        yield f"{run}: is damaged; nothing was changed"
        return
    yield from (f"{file}: can't be set aside: {reason}" for file, reason in failed.items())
    if planned or VERSIONS in own:
        if CONFIG in own:
            mend = "once its config is mended, the same command mends it"
        elif config is not None and run.resolve().name != run_name(config):
            mend = (
                f"rename the folder to {run_name(config)} and mend it with {run_again(run.with_name(run_name(config)))}"
            )
        else:
            mend = f"mend it with {run_again(run)}"
        yield f"{run}: what is damaged counts as missing now; {mend}"
    if evaluated:
        yield f"{run}: what is damaged of {EVALUATIONS}/ counts as missing now; mend it with the same visitlab eval"
