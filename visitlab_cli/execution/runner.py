"""Running what is missing of a plan: order, retries, interruption. The run folder alone is the truth."""

import signal
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from visitlab_cli.errors import Interrupted, VisitlabError
from visitlab_cli.execution.progress import Progress
from visitlab_cli.execution.silence import Silence
from visitlab_cli.execution.workers import OtherCodeError, Workers
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.evaluation import record_evaluation
from visitlab_cli.stopping import check_asked, ending_signals
from visitlab_cli.storage.cell_folder import read_cell, remove_leftovers
from visitlab_cli.storage.inside import check_all_inside

POLL_SECONDS = 0.1
DEATHS_GIVEN_UP = 3

Failures = dict[str, str]
"""What went wrong, one line each, by the cell's path."""


def missing_cells(run: Path, cells: Sequence[Cell]) -> list[Cell]:
    """The cells that are not done."""
    return [cell for cell in cells if read_cell(run / cell.path) is None]


def run_cells(run: Path, cells: Sequence[Cell], workers: int, progress: Progress) -> Failures:
    """Run the missing ones of `cells` in the run folder `run`; a cell that fails fails alone.

    Raises:
        RunError: a worker has imported other code than this process.
        Interrupted: by Ctrl-C, SIGTERM or SIGHUP; what was finished is kept.
    """
    check_all_inside(run, [cell.path for cell in cells])
    for evaluation in {cell.evaluation for cell in cells}:
        record_evaluation(run, evaluation)
    remove_leftovers(run)
    missing = missing_cells(run, cells)
    if not missing:
        return {}
    check_asked()
    pool = Workers(min(workers, len(missing)))
    with _signals(pool) as stopped, progress.over(missing):
        try:
            return _Running(run, missing, pool, progress, stopped).finish()
        finally:
            pool.close()
            remove_leftovers(run)  # of workers that were killed


class _Running:
    def __init__(
        self, run: Path, cells: Sequence[Cell], pool: Workers, progress: Progress, stopped: Callable[[], bool]
    ) -> None:
        self.run, self.pool, self.progress, self.stopped = run, pool, progress, stopped
        self.waiting = list(cells)
        self.suspects: list[Cell] = []  # were running when a worker died: one of them may have killed it
        self.running: dict[Future[None], tuple[Cell, int]] = {}
        self.free_slots = list(range(pool.count))
        self.deaths: Counter[str] = Counter()
        self.failures: Failures = {}
        self.silence = Silence()
        self.other_code: OtherCodeError | None = None

    def finish(self) -> Failures:
        while self.waiting or self.suspects or self.running:
            if self.stopped() or self.other_code is not None:
                self.pool.stop()
                self.waiting, self.suspects = [], []
            for cell in self._startable():
                if not self._start(cell):
                    break
            done, _ = wait(self.running, timeout=POLL_SECONDS, return_when=FIRST_COMPLETED)
            self.silence.looks(time.monotonic())
            for cell, slot in self.running.values():
                steps = self.pool.steps_done(slot)
                self.progress.update(cell, max(steps, 0))
                if told := self.silence.heard(cell, steps):
                    self.progress.warn(f"{cell.path}: {told} (worker {slot + 1}, process {self.pool.process(slot)})")
            self._collect(done)
        if self.other_code is not None:
            raise self.other_code
        if self.stopped():
            raise Interrupted("interrupted; what was finished is kept, and the same command goes on from there")
        return self.failures

    def _start(self, cell: Cell) -> bool:
        """Start a cell in a free slot; False where the pool is found broken, of which the running ones will tell."""
        slot = self.free_slots.pop()
        try:
            self.running[self.pool.submit(self.run, cell, slot)] = cell, slot
            self.silence.begins(cell)
        except BrokenExecutor:
            self.free_slots.append(slot)
            self.suspects.insert(0, cell)
            if not self.running:
                self.pool.replace()
            return False
        except (EOFError, ConnectionError):  # what starts the workers was killed
            self.free_slots.append(slot)
            self.pool.replace()  # which forgets the cell
            self._died([cell])
            time.sleep(POLL_SECONDS)  # it still answers while it ends
            return False
        return True

    def _startable(self) -> Iterator[Cell]:
        if self.suspects:
            if not self.running:
                yield self.suspects.pop(0)
            return
        ahead = {cell.path for cell in self.waiting} | {cell.path for cell, _ in self.running.values()}
        for cell in list(self.waiting):
            if not self.free_slots:
                return
            needed = cell.modules.values()
            failed = [path for path in needed if path in self.failures]
            if cell.absent:
                path, why = next(iter(cell.absent.items()))
                self._fail(cell, f"{path}: {why}")
                self.waiting.remove(cell)
            elif failed:
                self._fail(cell, f"needs {failed[0]}, which failed")
                self.waiting.remove(cell)
            elif not any(path in ahead for path in needed):
                self.waiting.remove(cell)
                yield cell

    def _collect(self, done: set[Future[None]]) -> None:
        broken = []
        for future in done:
            cell, slot = self.running.pop(future)
            self.free_slots.append(slot)
            error = future.exception()
            if error is None:
                self.progress.finished(cell, read_cell(self.run / cell.path))
            elif isinstance(error, OtherCodeError):
                self.other_code = error
            elif isinstance(error, BrokenExecutor):
                broken.append(cell)
            elif not isinstance(error, Interrupted):
                self._fail(cell, _in_one_line(error))
        if broken:
            broken += [cell for cell, _ in self.running.values()]
            self.free_slots += [slot for _, slot in self.running.values()]
            self.running.clear()
            self.pool.replace()
            self._died(broken)

    def _died(self, cells: Sequence[Cell]) -> None:
        for cell in cells:
            self.deaths[cell.path] += 1
            if self.deaths[cell.path] >= DEATHS_GIVEN_UP:
                self._fail(cell, f"its worker process died {DEATHS_GIVEN_UP} times (out of memory?)")
            else:
                self.suspects.append(cell)

    def _fail(self, cell: Cell, line: str) -> None:
        self.failures[cell.path] = line
        self.progress.failed(cell, line)


def _in_one_line(error: BaseException) -> str:
    if isinstance(error, VisitlabError):
        return str(error)
    return f"{type(error).__name__}: {error}".splitlines()[0]


@contextmanager
def _signals(pool: Workers) -> Iterator[Callable[[], bool]]:
    """Asked to end once: stop after the block; twice: at once."""
    count = 0

    def on_signal(number: int, frame: Any) -> None:
        nonlocal count
        count += 1
        if count > 1:
            pool.kill()
            raise Interrupted("interrupted; what was finished is kept")

    if threading.current_thread() is not threading.main_thread():
        yield lambda: False
        return
    before = {number: signal.signal(number, on_signal) for number in ending_signals()}
    try:
        yield lambda: count > 0
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
