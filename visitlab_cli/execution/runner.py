"""Running what is missing of a plan: order, retries, interruption, what other runners of the run do meanwhile.

The run folder alone is the truth.
"""

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
from visitlab_cli.execution.executor import DEATHS_GIVEN_UP, WAITING, EndOfRunError, Executor, OpenPool, died_of
from visitlab_cli.execution.order import Order
from visitlab_cli.execution.progress import Progress
from visitlab_cli.execution.silence import Silence
from visitlab_cli.execution.workers import Workers
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.evaluation import record_evaluation
from visitlab_cli.stopping import check_asked, ending_signals
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.claims import Claims, Owner
from visitlab_cli.storage.inside import check_all_inside, look_anew
from visitlab_cli.storage.leftovers import remove_leftovers
from visitlab_cli.storage.reading import UnreadableError

POLL_SECONDS = 0.1
LOOK_SECONDS, LOOK_SHARE = 1.0, 0.1
"""How often the cells of other runners are looked at, and which part of the time that takes at most."""

Failures = dict[str, str]
"""What went wrong, one line each, by the cell's path."""


def missing_cells(run: Path, cells: Sequence[Cell]) -> list[Cell]:
    """The cells that are not done."""
    return [cell for cell in cells if read_cell(run / cell.path) is None]


def run_cells(
    run: Path, cells: Sequence[Cell], workers: int, progress: Progress, open_pool: OpenPool = Workers
) -> Failures:
    """Run the missing ones of `cells` in the run folder `run`; a cell that fails fails alone.

    Raises:
        RunError: a worker has imported other code than this process, or the cluster is gone.
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
    pool = open_pool(min(workers, len(missing)))
    claims = Claims(run)
    with _signals(pool) as stopped, progress.over(missing):
        try:
            return _Running(run, missing, pool, progress, claims, stopped).finish()
        finally:
            pool.close()
            claims.close()
            remove_leftovers(run)  # of workers that were killed


class _Running:
    def __init__(
        self,
        run: Path,
        cells: Sequence[Cell],
        pool: Executor,
        progress: Progress,
        claims: Claims,
        stopped: Callable[[], bool],
    ) -> None:
        self.here = run.absolute()  # wherever others' code goes that a worker plays
        self.run, self.pool, self.progress, self.claims, self.stopped = run, pool, progress, claims, stopped
        self.order = Order(cells)
        self.elsewhere: dict[str, Cell] = {}  # other runners do them
        self.others: set[Owner | None] = set()
        self.next_look = 0.0
        self.suspects: list[Cell] = []  # were running when a worker died: one of them may have killed it
        self.running: dict[Future[None], tuple[Cell, int]] = {}
        self.slots = pool.count
        self.free_slots = list(range(self.slots))
        self.deaths: Counter[str] = Counter()
        self.failures: Failures = {}
        self.silence = Silence()
        self.ended: EndOfRunError | None = None

    def finish(self) -> Failures:
        while self.order or self.suspects or self.running or self.elsewhere:
            if self.stopped() or self.ended is not None:
                self.pool.stop()
                self.order.clear()
                self.suspects, self.elsewhere = [], {}
            self._take_new_slots()
            for cell in self._startable():
                if not self._start(cell):
                    break
            done, _ = wait(self.running, timeout=POLL_SECONDS, return_when=FIRST_COMPLETED)
            if self.elsewhere and not self.running:
                time.sleep(POLL_SECONDS)
            self.claims.beat()
            self.silence.looks(time.monotonic())
            for cell, slot in self.running.values():
                steps = self.pool.steps_done(slot)
                if begun_at := self.pool.went_on_from(slot):
                    self.progress.goes_on(cell, begun_at)
                if steps != WAITING:
                    self.progress.update(cell, max(steps, 0))
                if told := self.silence.heard(cell, steps):
                    self.progress.warn(f"{cell.path}: {told} ({self.pool.place(slot)})")
            self._collect(done)
        if self.ended is not None:
            raise self.ended
        if self.stopped():
            raise Interrupted("interrupted; what was finished is kept, and the same command goes on from there")
        return self.failures

    def _take_new_slots(self) -> None:
        """Those of workers that joined."""
        new = range(self.slots, self.pool.count)
        self.free_slots += new
        self.slots += len(new)

    def _start(self, cell: Cell) -> bool:
        """Start a cell in a free slot; False where the pool is found broken, of which the running ones will tell."""
        slot = self.free_slots.pop()
        try:
            self.running[self.pool.submit(self.here, cell, slot)] = cell, slot
            self.silence.begins(cell)
        except BrokenExecutor:
            self.free_slots.append(slot)
            self.claims.release(cell.path)
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
            if not self.running and self._is_ours(cell := self.suspects.pop(0)):
                yield cell
            return
        while self.free_slots and not self.stopped() and (next_one := self.order.next()) is not None:
            if next_one.absent:
                self._fail(next_one, _absent(next_one))
            elif self._is_ours(next_one):
                yield next_one
        if self.free_slots and self.elsewhere and time.monotonic() >= self.next_look:
            begun = time.monotonic()
            for cell in list(self.elsewhere.values()):
                if self.free_slots and self._is_ours(self.elsewhere.pop(cell.path)):
                    yield cell
            self.next_look = time.monotonic() + max(LOOK_SECONDS, (time.monotonic() - begun) / LOOK_SHARE)

    def _is_ours(self, cell: Cell) -> bool:
        """Claim a cell: not where it is done by now, nor where another runner does it."""
        if self._is_done(cell):
            return False
        if (other := self.claims.take(cell.path)) is not None:
            self.elsewhere[cell.path] = cell
            self._meet(other)
            return False
        if self._is_done(cell):  # between the two looks
            self.claims.release(cell.path)
            return False
        return True

    def _is_done(self, cell: Cell) -> bool:
        try:
            look_anew(self.run, cell.path)
            done = read_cell(self.run / cell.path) is not None
        except UnreadableError:
            return False  # doing it will tell
        if done:
            self.order.done(cell.path)
            self.progress.done_elsewhere(cell)
            if not self.others and cell.path not in self.deaths:
                self._meet(None)
        return done

    def _meet(self, other: Owner | None) -> None:
        """Say, once, that somebody else runs it, too; of None only cells were met that are done."""
        if other not in self.others:
            self.others.add(other)
            who = f"process {other.process} on {other.host}" if other else "another process"
            self.progress.say(f"{self.run}: {who} runs it, too: each does the cells that the other does not")

    def _collect(self, done: set[Future[None]]) -> None:
        broken = []
        for future in done:
            cell, slot = self.running.pop(future)
            self.free_slots.append(slot)
            self.claims.release(cell.path)
            error = future.exception()
            if error is None:
                self.order.done(cell.path)
                self.progress.finished(cell, read_cell(self.run / cell.path))
            elif isinstance(error, EndOfRunError):
                self.ended = error
            elif isinstance(error, BrokenExecutor):
                broken.append(cell)
            elif not isinstance(error, Interrupted):
                self._fail(cell, _in_one_line(error))
        if broken:
            broken += [cell for cell, _ in self.running.values()]
            self.free_slots += [slot for _, slot in self.running.values()]
            self.running.clear()
            self._died(broken, self.pool.replace())

    def _died(self, cells: Sequence[Cell], number: int = 0) -> None:
        for cell in cells:
            self.claims.release(cell.path)
            self.deaths[cell.path] += 1
            if self.deaths[cell.path] >= DEATHS_GIVEN_UP:
                self._fail(cell, died_of(number))
            else:
                self.suspects.append(cell)

    def _fail(self, cell: Cell, line: str) -> None:
        self.failures[cell.path] = line
        self.progress.failed(cell, line)
        for needing in self.order.failed(cell.path):
            self._fail(needing, _absent(needing) or f"needs {cell.path}, which failed")


def _absent(cell: Cell) -> str:
    """What a cell needs that can't be had here; empty where there is nothing."""
    return next((f"{path}: {why}" for path, why in cell.absent.items()), "")


def _in_one_line(error: BaseException) -> str:
    if isinstance(error, VisitlabError):
        return str(error)
    return f"{type(error).__name__}: {error}".splitlines()[0]


@contextmanager
def _signals(pool: Executor) -> Iterator[Callable[[], bool]]:
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
