"""Cells in the workers of a Dask cluster: one that is there, or one of our own on this machine that ends with us.

Dask knows which worker is free, and does a cell again whose worker died. The run folder, which all share, is the
truth: no result travels. To a worker goes a function's name with plain data (`dask_worker.py`), back come how many
steps are done, and that a cell ended, or why not.
"""

import asyncio
import contextlib
import itertools
import os
import pickle
import signal
import time
import uuid
from collections.abc import Callable, Iterable
from concurrent.futures import Future
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import distributed
from distributed import KilledWorker

from visitlab_cli.errors import Interrupted, RunError, reason
from visitlab_cli.execution.dask_address import At, is_exposed
from visitlab_cli.execution.dask_here import ANSWER_SECONDS, CLOSE_SECONDS, own_cluster, quietly
from visitlab_cli.execution.dask_worker import TOPIC, Terms, Told, difference, do_cell, facts, stop_cells
from visitlab_cli.execution.executor import DEATHS_GIVEN_UP, NOT_BEGUN, OUT_OF_MEMORY, WAITING, EndOfRunError
from visitlab_cli.execution.workers import OtherCodeError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plugins import files
from visitlab_cli.storage.cell_folder import TEMPORARY, lock_of
from visitlab_cli.storage.locks import Heart, lock

CONNECT_SECONDS = 30.0
ASK_SECONDS = 5.0
"""How long the scheduler may take to answer while cells run."""
LOOK_SECONDS = 2.0
"""How often is asked which workers there are."""
GONE_SECONDS = 60.0
"""After how long a scheduler that does not answer is gone."""
ALONE_SECONDS = 300.0
"""How long there may be no worker."""
AHEAD = 2
"""Cells that are given to the cluster for each worker: the next one is there when one ends."""


class _Client(distributed.Client):
    """A client that is closed where it was opened: one that never connected would try so for a minute as it goes."""

    def __del__(self) -> None:
        """Nothing."""


_client: Any = _Client


@dataclass
class _Task:
    """A cell that was given to the cluster; `starts` counts the workers that began it."""

    cell: bytes
    run: str
    ours: Future[None] = field(default_factory=Future)
    theirs: Any = None
    told: Told = field(default_factory=lambda: Told(WAITING, 0, ""))
    starts: int = 0
    rounds: int = 0


class DaskPool:
    """The workers of a cluster as an `Executor`; there are as many slots as it can use, more as workers join."""

    def __init__(self, at: At, workers: int, run: Path, kinds: Iterable[type], warn: Callable[[str], None]) -> None:
        """Connect, or start a cluster of `workers`, and see that all workers are as this program.

        Args:
            at: where the cluster is.
            workers: how many to start if it is our own.
            run: the run folder.
            kinds: the classes of what the config declares.
            warn: told what a user should know.

        Raises:
            UsageError: the address is none.
            NotFoundError: there is no such file.
            RunError: nothing answers, or a worker is not as this program.
        """
        self._warn = warn
        self._token = uuid.uuid4().hex
        self._numbers = itertools.count()
        self._tasks: dict[int, _Task] = {}  # by slot
        self._by_number: dict[int, _Task] = {}
        self._stopping = self._lost = False
        self._next_stop = self._next_look = 0.0
        self._held = ExitStack()
        self._cluster: Any = None
        self._address = at.resolved()
        try:
            self._client = self._connected(workers)
            self._workers: frozenset[str] = self._first_workers()
            self._terms = self._agreed(run.absolute(), list(kinds))
            self._client.subscribe_topic(TOPIC, self._hear)
        except BaseException:
            self.close()
            raise
        self._answered = self._peopled = time.monotonic()

    def _connected(self, workers: int) -> Any:
        try:
            if not self._address:
                self._cluster = self._held.enter_context(own_cluster(workers))
                self._address = self._cluster.scheduler_address
            client = _client(self._cluster or self._address, timeout=CONNECT_SECONDS, set_as_default=False)
        except Exception as error:
            if self._address:
                raise RunError(f"{self._address}: no Dask scheduler answers: {_in_short(error)}") from error
            raise RunError(f"a Dask cluster on this machine can't be started: {_in_short(error)}") from error
        self._held.callback(quietly, client.close, timeout=CLOSE_SECONDS)
        return client

    def _first_workers(self) -> frozenset[str]:
        try:
            self._client.wait_for_workers(1, timeout=CONNECT_SECONDS)
            known = self._ask(self._client.scheduler.identity, n_workers=-1)
        except TimeoutError:
            raise RunError(f"{self._address}: the Dask scheduler has no workers") from None
        except Exception as error:
            raise RunError(f"{self._address}: the Dask scheduler does not answer: {_in_short(error)}") from error
        if open_to_all := next(filter(is_exposed, (self._address, known["address"], *known["workers"])), None):
            self._warn(
                f"{open_to_all} is neither TLS nor on this machine alone: whoever reaches its port can run code as you"
            )
        return frozenset(known["workers"])

    def _agreed(self, run: Path, kinds: list[type]) -> Terms:
        """The terms that all workers were found to keep."""
        try:
            probe = lock(lock_of(run / f"{TEMPORARY}probe-{self._token[:8]}"), new=True, token=self._token)
        except OSError as error:
            raise RunError(f"{run}: can't be written: {reason(error)}") from error
        probe.beat()  # which also sends it to the others
        self._heart = Heart(probe)
        self._held.callback(probe.release, remove=True)
        plugins = tuple(str(file) for file in files())
        terms = Terms(self._token, facts(), str(probe.file), plugins, pickle.dumps(kinds), facts(kinds))
        answers = self._client.sync(_answers, self._client, sorted(self._workers), terms)
        for worker, told in answers.items():
            if isinstance(told, OSError):  # it is gone; it, or who comes in its place, is asked before its first cell
                continue
            if isinstance(told, Exception):
                told = f"can't run visitlab as it is here: {_in_short(told)}"
            if told:
                raise OtherCodeError(f"worker {worker} {told}")
        return terms

    def _ask(self, question: Callable[..., Any], *arguments: Any, **more: Any) -> Any:
        return self._client.sync(question, *arguments, callback_timeout=ASK_SECONDS, **more)

    @property
    def workers(self) -> int:
        """How many workers there are."""
        return len(self._workers)

    @property
    def count(self) -> int:
        """How many slots there are now."""
        if time.monotonic() >= self._next_look:
            self._look()
            self._next_look = time.monotonic() + LOOK_SECONDS
        return AHEAD * len(self._workers)

    def _look(self) -> None:
        self._heart.beat()
        try:
            self._workers, had = frozenset(self._ask(self._client.nthreads)), self._workers
            self._answered = time.monotonic()
        except Exception:  # whatever follows from a connection that is lost
            if time.monotonic() - self._answered > GONE_SECONDS:
                self._end(self._gone())
            return
        if self._workers:
            self._peopled = self._answered
        elif had:
            self._warn(f"{self._address}: no worker is left; waiting for one to join")
        elif self._answered - self._peopled > ALONE_SECONDS:
            self._end(EndOfRunError(f"{self._address}: no worker has joined; what was finished is kept"))

    def submit(self, run: Path, cell: Cell, slot: int) -> Future[None]:
        """Run a cell in a free `slot`."""
        task = self._tasks[slot] = _Task(pickle.dumps(cell), str(run.absolute()))
        self._send(task)
        return task.ours

    def _send(self, task: _Task) -> None:
        number = next(self._numbers)
        self._by_number[number] = task
        try:
            theirs = self._client.submit(
                do_cell,
                *(self._terms, number, task.run, task.cell),
                key=f"visitlab-{self._token}-{number}",
                pure=False,
            )
        except Exception:  # whatever follows from a connection that is lost
            task.ours.set_exception(self._gone())
            return
        task.theirs = theirs
        theirs.add_done_callback(lambda theirs: self._ended(number, theirs))

    def _ended(self, number: int, theirs: Any) -> None:
        task = self._by_number.pop(number)
        error: BaseException | None = None
        if theirs.status == "error":
            error = theirs.exception()
            if isinstance(error, KilledWorker):
                task.rounds += 1
                if max(task.starts, task.rounds) < DEATHS_GIVEN_UP and not self._stopping:
                    self._send(task)  # it stood behind one that killed their worker
                    return
                error = RunError(OUT_OF_MEMORY)
        elif theirs.status != "finished":
            error = Interrupted("stopped") if self._stopping else self._gone()
        _settle(task.ours, error)

    def _hear(self, event: Any) -> None:
        token, number, *told = event[1]
        if token != self._token or (task := self._by_number.get(number)) is None:
            return
        task.told = Told(*told)
        task.starts += task.told.steps == NOT_BEGUN
        if task.starts > DEATHS_GIVEN_UP:
            _settle(task.ours, RunError(OUT_OF_MEMORY))
            self._client.loop.add_callback(self._client.cancel, [task.theirs])

    def _gone(self) -> EndOfRunError:
        self._lost = True
        kept = "what was finished is kept, and the same command goes on from there when it is back"
        return EndOfRunError(f"{self._address}: the Dask scheduler is gone; {kept}")

    def _end(self, error: EndOfRunError) -> None:
        for task in list(self._by_number.values()):
            _settle(task.ours, error)

    def steps_done(self, slot: int) -> int:
        """Steps that the cell in `slot` has done so far; `WAITING` also where its worker is gone."""
        told = self._tasks[slot].told
        return told.steps if told.worker in self._workers else WAITING

    def went_on_from(self, slot: int) -> int:
        """The step from which the cell in `slot` was gone on with; 0 where it was begun."""
        return self._tasks[slot].told.begun_at

    def place(self, slot: int) -> str:
        """Which worker and process runs the cell in `slot`, in words."""
        told = self._tasks[slot].told
        return f"worker {told.worker}, process {told.process}"

    def stop(self) -> None:
        """Ask every cell to stop after its block; those that no worker has begun are taken back."""
        if self._lost or time.monotonic() < self._next_stop:
            return
        if not self._stopping:
            self._stopping = True
            tasks = list(self._by_number.values())
            quietly(self._ask, self._client.cancel, [each.theirs for each in tasks if each.told.steps == WAITING])
        quietly(self._ask, self._client.run, stop_cells, self._token, wait=False)  # workers may have joined since
        self._next_stop = time.monotonic() + LOOK_SECONDS

    def replace(self) -> int:
        """Nothing: a cluster starts its workers anew by itself."""
        return 0

    def kill(self) -> None:
        """End the workers of our own cluster; others have been asked to stop."""
        for nanny in [] if self._cluster is None else list(self._cluster.workers.values()):
            nanny.auto_restart = False
            if nanny.pid is not None:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(nanny.pid, signal.SIGKILL)

    def close(self) -> None:
        """Take leave; a cluster of our own ends."""
        self._stopping = True
        self._held.close()


async def _answers(client: Any, workers: list[str], terms: Terms) -> dict[str, str | Exception]:
    """What each worker says of its `difference`."""

    async def one(worker: str) -> Any:
        try:
            asked = client.run(difference, terms, workers=[worker], on_error="return")
            return (await asyncio.wait_for(asked, ANSWER_SECONDS))[worker]
        except TimeoutError:
            return RunError(f"no answer in {ANSWER_SECONDS:.0f} seconds")
        except Exception as error:
            return error

    return dict(zip(workers, await asyncio.gather(*map(one, workers)), strict=True))


def _settle(ours: Future[None], error: BaseException | None) -> None:
    """End a future, unless it has ended."""
    with contextlib.suppress(Exception):
        if error is None:
            ours.set_result(None)
        else:
            ours.set_exception(error)


def _in_short(error: BaseException) -> str:
    """A line, whatever Dask raised."""
    return next(iter(str(error).splitlines()), "") or type(error).__name__
