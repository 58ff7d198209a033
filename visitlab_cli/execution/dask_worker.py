"""What a Dask worker runs: importable functions of plain data, and what makes it refuse.

A worker is a process that somebody started anywhere, and does one cell at a time, maybe of several programs in turn.
Before a program's first cell it looks whether it has that one's Python, packages, code, run folder and plug-ins.
"""

import json
import os
import pickle
import time
from collections.abc import Iterable
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from distributed import Worker, get_worker

from visitlab_cli.errors import Interrupted, VisitlabError
from visitlab_cli.execution.executor import NOT_BEGUN
from visitlab_cli.surroundings import shut_out_variables

TOPIC = "visitlab"
"""Under which workers tell how far their cells are: a list of the command's token, the cell's number and `Told`."""
SECONDS_BETWEEN_EVENTS = 1.0
CODE = "code of visitlab"


class Terms(NamedTuple):
    """What a worker must have in common with the program; `token` names the command.

    `probe` is a lock file in the run folder that says the token. `kinds` are pickled classes that may come from the
    files `plugins`, or from packages, and `with_kinds` are the facts with these.
    """

    token: str
    facts: dict[str, str]
    probe: str
    plugins: tuple[str, ...]
    kinds: bytes
    with_kinds: dict[str, str]


class Told(NamedTuple):
    """How far a cell is, where it runs, and from which step it was gone on with."""

    steps: int
    process: int
    worker: str
    begun_at: int = 0


_serves = ""
"""The token of the command whose cell came last; a worker may serve several in turn."""
_stopped: set[str] = set()
"""The tokens of the commands that were asked to stop."""


def facts(kinds: Iterable[type] = ()) -> dict[str, str]:
    """What must be the same everywhere, by its name."""
    from visitlab_cli.execution.versions import versions
    from visitlab_cli.sources import sources

    kinds = list(kinds)
    return {**versions(kinds), "dask": version("distributed"), CODE: sources(kinds)}


def difference(terms: Terms, dask_worker: Worker) -> str:
    """Why this worker can't work for the program, in words; empty if it can."""
    shut_out_variables()
    os.environ["NUMBA_NUM_THREADS"] = "1"  # heeded where the compiler is imported first
    from visitlab_cli.execution import cell_runner, warm_up  # noqa: F401  (so that what is hashed is what runs)

    if dask_worker.state.nthreads != 1:
        return f"has {dask_worker.state.nthreads} threads; start it with --nthreads 1, and more workers instead"
    if told := _other(terms.facts, facts()):
        return told
    try:
        seen = json.loads(Path(terms.probe).read_bytes())["token"] == terms.token
    except (OSError, ValueError, KeyError, TypeError):
        seen = False
    if not seen:
        folder = Path(terms.probe).parent
        return f"does not see {folder}: the folder of runs must be on a disk that all share, under the same path"
    return ""


def _difference_of_kinds(terms: Terms) -> str:
    """As `difference`, of what the config names; from here on the plug-ins are the program's, as in one that starts."""
    from visitlab_cli.plugins import use_only

    try:
        use_only(terms.plugins)
        found = facts(pickle.loads(terms.kinds))
    except Exception as error:
        words = str(error) if isinstance(error, VisitlabError) else f"{type(error).__name__}: {error}"
        return f"can't import what the config names: {words}".splitlines()[0]
    return _other(terms.with_kinds, found)


def _other(ours: dict[str, str], found: dict[str, str]) -> str:
    for name, theirs in found.items():
        if ours.get(name) != theirs:
            anew = "; start it anew" if name == CODE else ""
            return f"has {name} {theirs}, this program {ours.get(name, 'none')}{anew}"
    return ""


async def stop_cells(token: str) -> None:
    """Have the cells of a command stop after their block."""
    _stopped.add(token)


def do_cell(terms: Terms, number: int, run: str, cell: bytes) -> None:
    """Run a pickled cell in the run folder `run`, unless it is done; `number` is what the program calls it.

    Raises:
        OtherCodeError: this worker is not as the program.
        RunError: as `run_cell`.
        Interrupted: the command was asked to stop.
    """
    global _serves
    worker = get_worker()
    if terms.token != _serves:
        _serves = ""
        if told := difference(terms, worker) or _difference_of_kinds(terms):
            from visitlab_cli.execution.workers import OtherCodeError

            raise OtherCodeError(f"worker {worker.address} {told}")
        _serves = terms.token
    from visitlab_cli.execution.cell_runner import run_cell
    from visitlab_cli.execution.warm_up import compile_here
    from visitlab_cli.storage.cell_folder import read_cell

    report = _Report(terms.token, number, worker)
    to_do = pickle.loads(cell)
    if read_cell(Path(run) / to_do.path) is None:  # else who did it died before anybody knew
        compile_here(to_do)
        report(0)
        run_cell(Path(run), to_do, report, report.goes_on)


class _Report:
    """Tells the program how many steps are done, once a second at most."""

    def __init__(self, token: str, number: int, worker: Worker) -> None:
        self._token, self._number, self._worker = token, number, worker
        self._next, self._begun_at = 0.0, 0
        self(NOT_BEGUN)
        self._next = 0.0

    def __call__(self, steps: int) -> None:
        if self._token in _stopped:
            raise Interrupted("stopped")
        now = time.monotonic()
        if now >= self._next:
            self._next = now + SECONDS_BETWEEN_EVENTS
            told = Told(steps, os.getpid(), self._worker.address, self._begun_at)
            self._worker.log_event(TOPIC, [self._token, self._number, *told])

    def goes_on(self, steps: int) -> None:
        """Tell that the cell is gone on with from a step."""
        self._begun_at, self._next = steps, 0.0
        self(steps)
