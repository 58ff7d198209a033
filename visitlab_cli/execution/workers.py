"""Where cells run: threads or processes behind one `concurrent.futures` interface, with shared progress.

One worker is a thread of this process (kernels release the GIL), several are processes, and so is one that plays what
others have written, which may end the process that it is in. Progress and the wish to stop travel in shared memory
without locks, so that a killed worker can block nobody.

A worker imports what the program imports, wherever it is started: what starts it does not look for modules in the
current folder, imports nothing beforehand, not the user's script either, and gives it the program's own search path.
"""

import ctypes
import multiprocessing
import multiprocessing.connection
import multiprocessing.forkserver
import multiprocessing.resource_tracker
import os
import pickle
import signal
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

from visitlab_cli.errors import Interrupted, UsageError, VisitlabError
from visitlab_cli.execution.executor import NOT_BEGUN, EndOfRunError
from visitlab_cli.execution.tracker import survive
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plugins import files, use_only
from visitlab_cli.sources import PACKAGE, sources
from visitlab_cli.stopping import ending_signals, nothing_to_lose

if TYPE_CHECKING:
    from multiprocessing.connection import Connection

STOP = 0
"""Place of the stop flag in the shared memory; worker slot i has three places from 1 + 3 i on, as `OF_SLOT` says."""
OF_SLOT = _STEPS, _PROCESS, _FROM = range(3)
"""What is told of a slot: steps done, the process, the step from which its cell was gone on with."""
TO_BEGIN, TO_START = 16, 8
"""How many files are open at once while the first worker starts, with what starts it, and while another one does."""
GIVEN_UP_SECONDS = 5.0
"""How long `close` waits for a pool that was given up: its manager ends when its last worker does."""
SAFE_PATH, MAIN = "PYTHONSAFEPATH", "__main__"

_shared: Any = None


class Code(NamedTuple):
    """Which code a process runs."""

    package: str
    sources: str


def code(kinds: Iterable[type] = ()) -> Code:
    """The code of this process, with that of the `kinds` that take part."""
    return Code(str(PACKAGE), sources(kinds))


class OtherCodeError(EndOfRunError):
    """A worker has imported another package than the program: nothing that it made would be the program's."""


class Workers:
    """A fixed number of slots that cells run in; a slot's progress can be read at any time."""

    def __init__(self, count: int, apart: bool = False) -> None:
        """Prepare `count` workers; they start with the first cell. `apart`: a single one is a process, too."""
        self.count, self._in_thread = count, count == 1 and not apart
        self._context = multiprocessing.get_context("forkserver")
        self._shared = self._context.RawArray(ctypes.c_int64, 1 + len(OF_SLOT) * count)
        self._executor: Executor | None = None
        self._given_up: list[dict[str, Any]] = []  # kept, for a process that just starts looks for what they share

    def submit(self, run: Path, cell: Cell, slot: int) -> Future[None]:
        """Run a cell in a free `slot`."""
        for what, at_first in zip(OF_SLOT, (NOT_BEGUN, 0, 0), strict=True):
            self._shared[_place(slot, what)] = at_first
        if not self._in_thread:
            _check_room(TO_BEGIN if self._executor is None else TO_START)
        if self._executor is None:
            self._executor = self._start()
        with nullcontext() if self._in_thread else as_the_program():  # the pool starts its processes as work comes
            return self._executor.submit(_checked, code(cell.config.kinds), _run_in_slot, run, cell, slot)

    def _start(self) -> Executor:
        if self._in_thread:
            return ThreadPoolExecutor(1, initializer=_begin_thread, initargs=(self._shared,))
        _prepare(self._context)
        return ProcessPoolExecutor(
            self.count, mp_context=self._context, initializer=_begin_process, initargs=(self._shared, files())
        )

    def steps_done(self, slot: int) -> int:
        """Steps that the cell in `slot` has done so far; `NOT_BEGUN` while its worker is not ready."""
        return int(self._shared[_place(slot, _STEPS)])

    def went_on_from(self, slot: int) -> int:
        """The step from which the cell in `slot` was gone on with; 0 where it was begun."""
        return int(self._shared[_place(slot, _FROM)])

    def place(self, slot: int) -> str:
        """Which worker and process runs the cell in `slot`, in words; process 0 while there is none."""
        return f"worker {slot + 1}, process {self._shared[_place(slot, _PROCESS)]}"

    def stop(self) -> None:
        """Ask every cell to stop after its block."""
        self._shared[STOP] = 1

    def replace(self) -> int:
        """Give up a broken pool; the next cell starts a new one. The signal that a worker died of, 0 where unknown."""
        if self._executor is None:
            return 0
        pool = dict(vars(self._executor))
        self._given_up.append(pool)
        self._executor.shutdown(wait=False, cancel_futures=True)
        self._executor = None
        manager = pool.get("_executor_manager_thread")
        if not pool.get("_broken") or manager is None:
            return 0
        manager.join(GIVEN_UP_SECONDS)  # it ends the other workers, and alone may ask how each has ended
        ends = [] if manager.is_alive() else [worker.exitcode for worker in pool["_processes"].values()]
        return max((-end for end in ends if end is not None and end < 0 and end != -signal.SIGTERM), default=0)

    def kill(self) -> None:
        """End all worker processes at once."""
        for child in multiprocessing.active_children():
            child.kill()

    def close(self) -> None:
        """Wait for the workers to end."""
        if self._executor is not None:
            self._executor.shutdown(wait=True, cancel_futures=True)
        for pool in self._given_up:  # Python's own end stumbles over a manager that is just closing
            if (manager := pool.get("_executor_manager_thread")) is not None:
                manager.join(GIVEN_UP_SECONDS)


def _place(slot: int, what: int) -> int:
    return 1 + len(OF_SLOT) * slot + what


def _check_room(files: int) -> None:
    """Check that so many more files may be open: what starts the workers would end with its own words where not.

    Raises:
        OSError: they may not.
    """
    opened: list[int] = []
    try:
        while len(opened) < files:
            opened += os.pipe()
    finally:
        for each in opened:
            os.close(each)


def _prepare(context: Any) -> None:
    context.set_forkserver_preload([])
    survive()
    _start_servers()


def warm_up_apart(cells: Sequence[Cell], say: Callable[[str], None]) -> None:
    """As `warm_up.warm_up`, in a process that others' code may end: then each cell tells it."""
    context = multiprocessing.get_context("forkserver")
    _check_room(TO_BEGIN)
    _prepare(context)
    said, saying = context.Pipe(duplex=False)
    child = context.Process(target=_warm_up, args=(pickle.dumps(cells), files(), saying), daemon=True)
    with nothing_to_lose(), suppress(EOFError, ConnectionError):
        with as_the_program():
            child.start()
        saying.close()
        while True:
            say(said.recv())
    child.join()


def _warm_up(cells: bytes, plugins: Sequence[Path], saying: "Connection[str, str]") -> None:
    from visitlab_cli.execution.warm_up import warm_up

    _begin_process(None, plugins)
    with suppress(VisitlabError):
        warm_up(pickle.loads(cells), saying.send)


def _start_servers() -> None:
    """Start what starts the workers, deaf to the signals that a terminal sends to all; the workers inherit that."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    try:
        for ensure_running in (
            multiprocessing.resource_tracker.ensure_running,
            multiprocessing.forkserver.ensure_running,
        ):
            signal.pthread_sigmask(signal.SIG_BLOCK, ending_signals())  # each time: the tracker's start unblocks some
            with as_the_program():
                ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def as_the_program() -> Iterator[None]:
    """A Python that is started within imports neither from the current folder nor, once more, the script that runs.

    Raises:
        UsageError: it would not heed that.
    """
    if sys.flags.ignore_environment and not sys.flags.safe_path:
        raise UsageError("python -E: workers would import from the current folder; add -P, or use --workers 1")
    before, script = os.environ.get(SAFE_PATH), sys.modules[MAIN]
    os.environ[SAFE_PATH] = "1"
    sys.modules[MAIN] = ModuleType(MAIN)  # of no file, so that there is nothing to import
    try:
        yield
    finally:
        sys.modules[MAIN] = script
        if before is None:
            del os.environ[SAFE_PATH]
        else:
            os.environ[SAFE_PATH] = before


def _begin_thread(shared: Any) -> None:
    global _shared
    _shared = shared


def _begin_process(shared: Any, plugins: Sequence[Path]) -> None:
    _begin_thread(shared)
    os.dup2(2, 1)  # what others' code prints is no result
    sys.stdout = sys.stderr
    use_only(plugins)  # the variables are those of when the first worker of this program was started
    for number in ending_signals():
        ours = number == signal.SIGTERM  # of what a terminal sends to all the parent decides, in shared memory
        signal.signal(number, signal.SIG_DFL if ours else signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ending_signals())
    parent = multiprocessing.parent_process()
    assert parent is not None
    threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    multiprocessing.connection.wait([sentinel])
    os._exit(1)


def _checked(expected: Code, work: Callable[[Path, Cell, int], None], run: Path, cell: Cell, slot: int) -> None:
    """Do `work` if this process runs the code that the program runs.

    Raises:
        OtherCodeError: it does not.
    """
    ours = code(cell.config.kinds)
    if ours.package != expected.package:
        raise OtherCodeError(f"a worker imports visitlab from {ours.package}, the program from {expected.package}")
    if ours.sources != expected.sources:
        raise OtherCodeError(f"{ours.package} was edited while the program runs: a worker has other code; run again")
    work(run, cell, slot)


def _run_in_slot(run: Path, cell: Cell, slot: int) -> None:
    from visitlab_cli.execution.cell_runner import run_cell
    from visitlab_cli.execution.warm_up import compile_here

    def goes_on(steps: int) -> None:
        _shared[_place(slot, _FROM)] = _shared[_place(slot, _STEPS)] = steps

    _shared[_place(slot, _PROCESS)] = os.getpid()
    compile_here(cell)
    _shared[_place(slot, _STEPS)] = 0
    run_cell(run, cell, _report_to(slot), goes_on)


def _report_to(slot: int) -> Callable[[int], None]:
    def report(steps: int) -> None:
        _shared[_place(slot, _STEPS)] = steps
        if _shared[STOP]:
            raise Interrupted("stopped")

    return report
