"""What a Dask worker runs: importable functions of plain data, and what makes it refuse.

A worker is a process that somebody started anywhere. Before its first cell of a command it looks whether it has the
program's Python, packages, code and run folder, and imports the same plug-ins.
"""

import os
import pickle
import time
from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

from distributed import Worker, get_worker

from visitlab_cli.errors import Interrupted, VisitlabError
from visitlab_cli.execution.executor import NOT_BEGUN
from visitlab_cli.surroundings import shut_out_variables

TOPIC = "visitlab"
"""Under which workers tell how far their cells are: a list of the command's token, the cell's number and `Told`."""
SECONDS_BETWEEN_EVENTS = 1.0
CODE = "code of visitlab"


class Terms(NamedTuple):
    """What a worker must have in common with the program; `token` names the command, `kinds` are pickled classes.

    `probe` is a file in the run folder that holds the token.
    """

    token: str
    facts: dict[str, str]
    plugins: tuple[str, ...]
    kinds: bytes
    probe: str


class Told(NamedTuple):
    """How far a cell is, and where it runs."""

    steps: int
    process: int
    worker: str


_agreed: set[str] = set()
"""The tokens of the commands whose terms were found to hold."""
_stopped: set[str] = set()
"""Those of the commands that were asked to stop."""


def facts(kinds: Iterable[type] = ()) -> dict[str, str]:
    """What must be the same everywhere, by its name."""
    from visitlab_cli.execution.versions import versions
    from visitlab_cli.sources import sources

    kinds = list(kinds)
    return {**versions(kinds), "dask": version("distributed"), CODE: sources(kinds)}


def difference(terms: Terms, dask_worker: Worker) -> str:
    """Why this worker can't work for the program, in words; empty if it can."""
    shut_out_variables()
    os.environ["NUMBA_NUM_THREADS"] = "1"  # heeded by numba's first import
    from visitlab_cli.execution import cell_runner, warm_up  # noqa: F401  (so that what is hashed is what runs)

    if dask_worker.state.nthreads != 1:
        return f"has {dask_worker.state.nthreads} threads; start it with --nthreads 1, and more workers instead"
    if told := _other(terms, facts(), without=CODE):
        return told
    try:
        found = facts(_kinds(terms))
    except Exception as error:
        words = str(error) if isinstance(error, VisitlabError) else f"{type(error).__name__}: {error}"
        return f"can't import what the config names: {words}".splitlines()[0]
    if told := _other(terms, found):
        return told
    try:
        seen = Path(terms.probe).read_text() == terms.token
    except (OSError, ValueError):
        seen = False
    if not seen:
        folder = Path(terms.probe).parent
        return f"does not see {folder}: the folder of runs must be on a disk that all share, under the same path"
    return ""


def _other(terms: Terms, found: dict[str, str], without: str = "") -> str:
    for name, theirs in found.items():
        if name != without and terms.facts.get(name) != theirs:
            return f"has {name} {theirs}, this program {terms.facts.get(name, 'has none')}"
    return ""


def _kinds(terms: Terms) -> Any:
    from pydantic import BaseModel

    from visitlab_cli.plugins import in_files, use_files

    use_files(terms.plugins)
    list(in_files(BaseModel))
    return pickle.loads(terms.kinds)


async def stop_cells(token: str) -> None:
    """Have the cells of a command stop after their block."""
    _stopped.add(token)


def do_cell(terms: Terms, number: int, run: str, cell: bytes) -> None:
    """Run a pickled cell in the run folder `run`, unless it is done; `number` is what the program calls it.

    Raises:
        OtherCodeError: this worker, which joined late, is not as the program.
        RunError: as `run_cell`.
        Interrupted: the command was asked to stop.
    """
    worker = get_worker()
    if terms.token not in _agreed:
        if told := difference(terms, worker):
            from visitlab_cli.execution.workers import OtherCodeError

            raise OtherCodeError(f"worker {worker.address} {told}")
        _agreed.add(terms.token)
    from visitlab_cli.execution.cell_runner import run_cell
    from visitlab_cli.execution.warm_up import compile_here
    from visitlab_cli.storage.cell_folder import read_cell

    report = _Report(terms.token, number, worker)
    to_do = pickle.loads(cell)
    if read_cell(Path(run) / to_do.path) is None:  # else who did it died before anybody knew
        compile_here(to_do)
        report(0)
        run_cell(Path(run), to_do, report)


class _Report:
    """Tells the program how many steps are done, once a second at most."""

    def __init__(self, token: str, number: int, worker: Worker) -> None:
        self._token, self._number, self._worker = token, number, worker
        self._next = 0.0
        self(NOT_BEGUN)
        self._next = 0.0

    def __call__(self, steps: int) -> None:
        if self._token in _stopped:
            raise Interrupted("stopped")
        now = time.monotonic()
        if now >= self._next:
            self._next = now + SECONDS_BETWEEN_EVENTS
            told = Told(steps, os.getpid(), self._worker.address)
            self._worker.log_event(TOPIC, [self._token, self._number, *told])
