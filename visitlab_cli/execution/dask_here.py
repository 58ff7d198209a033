"""A Dask cluster of our own on this machine, which ends with us."""

import contextlib
import logging
import multiprocessing.resource_tracker
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import dask
import distributed

from visitlab_cli.execution.executor import DEATHS_GIVEN_UP
from visitlab_cli.execution.workers import as_the_program
from visitlab_cli.stopping import ending_signals

ANSWER_SECONDS = 60.0
"""How long a worker may take to import visitlab and say what it has."""
CLOSE_SECONDS = 10.0
OWN = {
    "distributed.scheduler.allowed-failures": DEATHS_GIVEN_UP - 1,
    "distributed.worker.profile.enabled": False,
}
"""Dask's settings for a cluster of our own."""

_dask: Any = distributed
"""As Dask declares few of its types."""


@contextmanager
def own_cluster(workers: int) -> Iterator[Any]:
    """A cluster that only this machine reaches; its processes are deaf to what a terminal sends to all."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    with as_the_program(), dask.config.set(OWN):
        try:
            for _ in range(2):  # the tracker's start unblocks some
                signal.pthread_sigmask(signal.SIG_BLOCK, ending_signals())
                _start_tracker()
            cluster = _dask.LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                host="127.0.0.1",
                protocol="tcp",
                security=_dask.Security(require_encryption=False),
                dashboard_address=None,
                memory_limit=0,
                death_timeout=ANSWER_SECONDS,
                silence_logs=logging.CRITICAL,
            )
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        try:
            yield cluster
        finally:
            quietly(cluster.close, timeout=CLOSE_SECONDS)


def _start_tracker() -> None:
    """Start what cleans up after us, told not to say so where we are killed."""
    before = list(sys.warnoptions)
    sys.warnoptions[:] = ["ignore"]
    try:
        multiprocessing.resource_tracker.ensure_running()
    finally:
        sys.warnoptions[:] = before


def quietly(do: Callable[..., Any], *arguments: Any, **more: Any) -> None:
    """Do what may fail where the other side is gone."""
    with contextlib.suppress(Exception):
        do(*arguments, **more)
