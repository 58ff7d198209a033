"""What is kept of a cell that failed: the traceback, for whoever wrote its agent or human."""

import contextlib
import traceback
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from visitlab_cli.agents.plain import AgentFailedError, in_a_line
from visitlab_cli.errors import AnswerError, RunError, VisitlabError
from visitlab_cli.origin import FAILURE, is_ours
from visitlab_cli.plan.cells import Cell
from visitlab_cli.sources import is_kind_of_others
from visitlab_cli.storage.inside import check_inside
from visitlab_cli.storage.on_disk import FAILURES
from visitlab_cli.whole_file import write_again
from visitlab_cli.world.human import NoReactionError

LONGEST_NAME = 200


def failure_file(run: Path, cell: Cell) -> Path:
    """Where the traceback of a cell is."""
    return run / FAILURES / f"{cell.path.replace('/', '--')[-LONGEST_NAME:]}.txt"


@contextlib.contextmanager
def kept_if_it_fails(run: Path, cell: Cell) -> Iterator[None]:
    """Keep the traceback of what the block raises, but for what has its line anyway; forget that of an earlier time.

    Raises:
        RunError: the block raised; with where its traceback is.
    """
    try:
        yield
    except AgentFailedError as error:
        if not error.report:
            raise
        raise RunError(f"{error}{_kept(run, cell, error.report)}") from error
    except AnswerError as error:
        raise RunError(f"{whose(error, cell)} failed{error.where and f' in {error.where}'}: {error}") from error
    except VisitlabError:
        raise
    except Exception as error:
        raise RunError(f"{in_a_line(error)}{_kept(run, cell, traceback.format_exc())}") from error
    with contextlib.suppress(OSError, RunError):
        check_inside(run, failure_file(run, cell))
        if is_ours(failure_file(run, cell)):
            failure_file(run, cell).unlink()


def whose(error: AnswerError, cell: Cell) -> str:
    """Whose answer it was, with the kinds that it can have been: ours answer only what there is."""
    if isinstance(error, NoReactionError):
        return f"its human (kind {_kinds(cell.config.humans[human] for human in cell.humans)})"
    watched = (cell.config.agents[getattr(cell.learner, other)] for other in cell.learner.references)
    return f"its agent (kind {_kinds([cell.learner, *watched])})"


def _kinds(entries: Iterable[Any]) -> str:
    several = list(entries)
    theirs = [each for each in several if is_kind_of_others(type(each))]
    return " or ".join(dict.fromkeys(each.kind for each in theirs or several))


def _kept(run: Path, cell: Cell, report: str) -> str:
    file = failure_file(run, cell)
    try:
        check_inside(run, file)
        file.parent.mkdir(exist_ok=True)
        write_again(file, f"{FAILURE}{cell.path}\n\n{report}".encode())
    except (OSError, VisitlabError):
        return ""
    return f"; traceback in {file}"
