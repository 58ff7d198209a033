"""Where cells run: threads or processes behind one `concurrent.futures` interface, with shared progress.

One worker is a thread of this process (kernels release the GIL), several are processes. Progress and the wish to
stop travel in shared memory without locks, so that a killed worker can block nobody.
"""

import ctypes
import multiprocessing
import multiprocessing.connection
import multiprocessing.forkserver
import multiprocessing.resource_tracker
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path
from typing import Any

from visitlab_cli.errors import Interrupted
from visitlab_cli.execution.cells import Cell
from visitlab_cli.stopping import ending_signals

STOP = 0
"""Place of the stop flag in the shared memory; the steps done by worker slot i are at i + 1."""

_shared: Any = None


class Workers:
    """A fixed number of slots that cells run in; a slot's progress can be read at any time."""

    def __init__(self, count: int) -> None:
        """Prepare `count` workers; they start with the first cell."""
        self.count = count
        self._context = multiprocessing.get_context("forkserver")
        self._shared = self._context.RawArray(ctypes.c_int64, count + 1)
        self._executor: Executor | None = None

    def submit(self, run: Path, cell: Cell, slot: int) -> Future[None]:
        """Run a cell in a free `slot`."""
        self._shared[slot + 1] = 0
        if self._executor is None:
            self._executor = self._start()
        return self._executor.submit(_run_in_slot, run, cell, slot)

    def _start(self) -> Executor:
        if self.count == 1:
            return ThreadPoolExecutor(1, initializer=_begin_thread, initargs=(self._shared,))
        self._context.set_forkserver_preload(["visitlab_cli.execution.cell_runner"])
        _start_servers()
        return ProcessPoolExecutor(
            self.count, mp_context=self._context, initializer=_begin_process, initargs=(self._shared,)
        )

    def steps_done(self, slot: int) -> int:
        """Steps that the cell in `slot` has done so far."""
        return int(self._shared[slot + 1])

    def stop(self) -> None:
        """Ask every cell to stop after its block."""
        self._shared[STOP] = 1

    def replace(self) -> None:
        """Give up a broken pool; the next cell starts a new one."""
        if self._executor is not None:
            self._executor.shutdown(wait=False, cancel_futures=True)
        self._executor = None

    def kill(self) -> None:
        """End all worker processes at once."""
        for child in multiprocessing.active_children():
            child.kill()

    def close(self) -> None:
        """Wait for the workers to end."""
        if self._executor is not None:
            self._executor.shutdown(wait=True, cancel_futures=True)


def _start_servers() -> None:
    """Start what starts the workers, deaf to the signals that a terminal sends to all; the workers inherit that."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    try:
        for ensure_running in (
            multiprocessing.resource_tracker.ensure_running,
            multiprocessing.forkserver.ensure_running,
        ):
            signal.pthread_sigmask(signal.SIG_BLOCK, ending_signals())  # each time: the tracker's start unblocks some
            ensure_running()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin_thread(shared: Any) -> None:
    global _shared
    _shared = shared


def _begin_process(shared: Any) -> None:
    _begin_thread(shared)
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


def _run_in_slot(run: Path, cell: Cell, slot: int) -> None:
    from visitlab_cli.execution.cell_runner import run_cell

    run_cell(run, cell, _report_to(slot))


def _report_to(slot: int) -> Callable[[int], None]:
    def report(steps: int) -> None:
        _shared[slot + 1] = steps
        if _shared[STOP]:
            raise Interrupted("stopped")

    return report
