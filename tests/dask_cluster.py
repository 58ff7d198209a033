"""A Dask cluster on this machine as a user starts one: a scheduler and workers, processes of their own."""

import contextlib
import json
import os
import subprocess
import sys
import time
from pathlib import Path

DASK = [sys.executable, "-m", "dask"]
PATIENCE = 60.0
QUIET = {"DASK_LOGGING__DISTRIBUTED": "critical"}


class Cluster:
    """Ended at the end of the block; `file` is the scheduler's file, `nannies` are the processes of the workers."""

    def __init__(self, folder, **variables):
        self.folder, self.variables = Path(folder), variables
        self.file = self.folder / "scheduler.json"
        self.nannies = []

    def __enter__(self):
        own = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
        self.scheduler = self._start("scheduler", *own, "--scheduler-file", self.file)
        until(self.file.exists)
        until(lambda: self.address)
        return self

    def __exit__(self, *anything):
        for process in (*self.nannies, self.scheduler):
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, 9)
            process.wait()

    @property
    def address(self):
        """The scheduler's; None while it is not yet written."""
        try:
            return json.loads(self.file.read_text())["address"]
        except ValueError:
            return None

    def add_worker(self, *options, **variables):
        """Start a worker, in a session of its own, with further variables."""
        own = ["--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard", "--local-directory", self.folder / "scratch"]
        nanny = self._start("worker", self.address, *own, *options, **variables)
        self.nannies.append(nanny)
        return nanny

    def _start(self, *words, **variables):
        environment = os.environ | QUIET | self.variables | variables
        return subprocess.Popen(
            [*DASK, *map(str, words)],
            cwd=self.folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )


def until(there):
    """Wait until something is true."""
    deadline = time.monotonic() + PATIENCE
    while not there():
        assert time.monotonic() < deadline, "nothing happened for a minute"
        time.sleep(0.02)
