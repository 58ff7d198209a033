"""Dask clusters of two workers on this machine: what is killed in them, and workers that are not as the program."""

import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

from tests.dask_cluster import Cluster, until
from tests.faults.bench import members_of
from tests.faults.fault import Try, fault
from tests.faults.interrupted import ENDING, no_orphans
from tests.program import copy_package

RULE = "world/navigation.py", "reward = 1.0 if", "reward = 2.0 if"
NEEDS = ["linux", "dask"]


class _Two(Cluster):
    """A cluster of two workers."""

    def __enter__(self) -> "_Two":
        super().__enter__()
        self.add_worker()
        self.add_worker()
        return self


def _started(this: Try, out: Path, *where: object) -> tuple["subprocess.Popen[bytes]", bool]:
    """A run in a cluster, at a random moment after it knows its workers; False if it ended before."""
    words = "run", this.bench.config, "--out", out, "-q", "--executor", "dask", *where
    program = this.bench.start(*words, cwd=this.folder)
    until(lambda: any(out.glob("*/.tmp-*-*.lock")) or program.poll() is not None)
    time.sleep(this.random.uniform(0, 0.6) * this.bench.seconds)
    this.count = int(program.poll() is None)
    return program, bool(this.count)


@fault("dask", "a Dask cluster, of one's own or one that is there: the same bytes", 4, 1, NEEDS)
def dask(this: Try) -> None:
    out = this.folder / "runs"
    if this.index % 2 == 0:
        if this.told(this.run(out, "--executor", "dask", "--workers", 2), 0):
            this.whole(out)
        return
    with _Two(this.folder) as cluster:
        if this.told(this.run(out, "--executor", "dask", "--scheduler-file", cluster.file), 0):
            this.whole(out)


@fault("dask-worker", "kill -9 of a Dask worker at a random moment: its cell is done again", 8, 1, NEEDS)
def dask_worker(this: Try) -> None:
    out = this.folder / "runs"
    with _Two(this.folder) as cluster:
        program, moment = _started(this, out, "--address", cluster.address)
        nanny = this.random.choice(cluster.nannies)
        if moment:
            processes = members_of(nanny.pid)
            whole = this.random.random() < 0.3  # else its nanny starts another one
            for pid in processes if whole else [pid for pid in processes if pid != nanny.pid]:
                os.kill(pid, signal.SIGKILL)
        if this.told(this.bench.wait(program), 0):
            this.whole(out)


@fault("dask-scheduler", "kill -9 of the scheduler: one line, and what was finished is kept", 8, 1, NEEDS)
def dask_scheduler(this: Try) -> None:
    out = this.folder / "runs"
    with _Two(this.folder) as cluster:
        program, moment = _started(this, out, "--address", cluster.address)
        cluster.scheduler.kill()
        done = this.bench.wait(program)
        if moment:
            this.told(done, 0, 4, names="the Dask scheduler is gone")
            this.wrong += [f"took {done.seconds:.0f} s to say so"] * (done.seconds > 45)
            lines = done.stderr.strip().splitlines()
            this.wrong += [f"{len(lines)} lines of a scheduler that is gone"] * (len(lines) > 1)
    this.resumed(out)


@fault("dask-other", "a Dask worker with an edited rule, or another Python package: refused by name", 2, 1, NEEDS)
def dask_other(this: Try) -> None:
    out = this.folder / "runs"
    copy = this.folder / "copy" / "visitlab_cli"
    copy_package(copy)
    file, old, new = RULE
    text = (copy / file).read_text()
    (copy / file).write_text(text.replace(old, new))
    site = this.folder / "site" / "numba-0.1.dist-info"
    site.mkdir(parents=True)
    (site / "METADATA").write_text("Metadata-Version: 2.1\nName: numba\nVersion: 0.1\n")
    other, named = [(copy.parent, "code of visitlab"), (site.parent, "numba 0.1")][this.index % 2]
    with _Two(this.folder) as cluster:
        cluster.add_worker(PYTHONPATH=str(other))
        done = this.run(out, "--executor", "dask", "--address", cluster.address)
        while done.code == 0 and this.count < 20:  # it may have joined when all was done
            shutil.rmtree(out)
            this.count += 1
            done = this.run(out, "--executor", "dask", "--address", cluster.address)
    this.count = 1
    this.told(done, 4, names=rf"worker tcp://127\.0\.0\.1:\d+ has {named}")
    this.resumed(out)


@fault("dask-killed", "kill -9 of, or Ctrl-C to, a run in a Dask cluster of its own: no process is left", 6, 0, NEEDS)
def dask_killed(this: Try) -> None:
    out = this.folder / "runs"
    program, moment = _started(this, out, "--workers", 2)
    number = this.random.choice([signal.SIGKILL, *ENDING])
    send = this.random.choice([os.kill, os.killpg]) if number != signal.SIGKILL else os.kill
    if moment:
        send(program.pid, number)
    done = this.bench.wait(program, limit=60)
    if number != signal.SIGKILL:
        this.told(done, 0, 130, names="interrupted")
    no_orphans(this, program.pid)
    this.resumed(out)
