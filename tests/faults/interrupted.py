"""Processes that are killed, stopped and signalled at random moments, and cells that always fail."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from tests.faults.bench import members_of, workers_of
from tests.faults.fault import Try, fault
from tests.program import the_run
from visitlab_cli.storage.checkpoint_file import NAMES, stated

ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
PATIENCE = 20.0


def started(this: Try, out: Path, workers: int) -> "subprocess.Popen[bytes]":
    return this.bench.start("run", this.bench.config, "--out", out, "-q", "--workers", workers, cwd=this.folder)


def at_random(this: Try, program: "subprocess.Popen[bytes]") -> bool:
    """Wait until a random moment of a run; False if it ended before, and this try is none."""
    time.sleep(this.random.uniform(0.02, 0.9) * this.bench.seconds)
    if program.poll() is not None:
        this.count = 0
    return bool(this.count)


def no_orphans(this: Try, session: int) -> None:
    deadline = time.monotonic() + PATIENCE
    while left := members_of(session):
        if time.monotonic() > deadline:
            this.wrong.append(f"processes {sorted(left)} still live {PATIENCE:.0f} s after their parent")
            os.killpg(session, signal.SIGKILL)
            return
        time.sleep(0.1)


@fault("killed", "kill -9 of the main process at a random moment", 50, 2, ["linux"])
def killed(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, this.random.choice([1, 2]))
    moment = at_random(this, program)
    program.kill()
    program.communicate()
    no_orphans(this, program.pid)
    if moment:
        this.resumed(out)


OFTEN = """
from visitlab_cli.execution import checkpoints
checkpoints.EVERY, checkpoints.SHARE = 0.03, float("inf")
from visitlab_cli.__main__ import main
main()
"""
"""The program with checkpoints so often that each cell has some."""


@fault("killed-often", "kill -9 four times just after a checkpoint: cells go on from it, to the same bytes", 20, 1)
def killed_often(this: Try) -> None:
    out = this.folder / "runs"
    arguments = "run", this.bench.config, "--out", out, "--workers", 1
    for _ in range(4):
        program = subprocess.Popen([sys.executable, "-P", "-c", OFTEN, *map(str, arguments), "-q"], cwd=this.folder)
        begun = time.time()
        while program.poll() is None and not any(_since(path, begun) for path in out.glob(f"*/.tmp-*/{NAMES[0]}")):
            time.sleep(0.002)
        time.sleep(this.random.uniform(0, 0.05))
        program.kill()
        program.wait()
    kept, left = this.finished(out), [path for path in out.glob(f"*/.tmp-*/{NAMES[0]}") if _is_to_do(path)]
    this.count = int(bool(left))
    this.later(out)
    done = this.visitlab(*arguments)
    if this.told(done, 0):
        this.wrong += ["nothing went on from a checkpoint"] * (bool(left) and "goes on from step" not in done.stderr)
        this.whole(out, kept)


def _since(checkpoint: Path, begun: float) -> bool:
    """Whether a checkpoint was written since then, and is still there."""
    try:
        return checkpoint.stat().st_mtime > begun
    except OSError:
        return False


def _is_to_do(checkpoint: Path) -> bool:
    """Whether the cell of a checkpoint is not done: what was killed just then may leave one of a cell that is."""
    return not (checkpoint.parents[1] / str(stated(checkpoint).get("cell")) / "cell.json").exists()


@fault("killed-worker", "kill -9 of one worker at a random moment: its cell is done again", 16, 1, ["linux"])
def killed_worker(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, 2)
    if at_random(this, program):
        workers = workers_of(program.pid)
        if workers:
            os.kill(this.random.choice(workers), signal.SIGKILL)
        else:
            this.count = 0
    done = this.bench.wait(program)
    if this.told(done, 0):
        this.whole(out)


@fault("killed-server", "kill -9 of what starts the workers, or of what cleans up after them", 8, 0, ["linux"])
def killed_server(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, 2)
    if at_random(this, program):
        servers = [pid for pid, parent in members_of(program.pid).items() if parent == program.pid]
        if servers:
            os.kill(this.random.choice(servers), signal.SIGKILL)
        else:
            this.count = 0
    done = this.bench.wait(program)
    this.told(done, 0, 4)
    no_orphans(this, program.pid)
    this.resumed(out)


@fault("killed-all", "kill -9 of everything at once, as when the machine runs out of memory or power", 10, 0, ["linux"])
def killed_all(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, 2)
    moment = at_random(this, program)
    os.killpg(program.pid, signal.SIGKILL)
    program.communicate()
    if moment:
        this.resumed(out)


@fault(
    "signalled",
    "Ctrl-C, SIGTERM or SIGHUP at a random moment, to the program or to all its processes",
    30,
    1,
    ["linux"],
)
def signalled(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, this.random.choice([1, 2]))
    if at_random(this, program):
        send = this.random.choice([os.kill, os.killpg])
        send(program.pid, this.random.choice(ENDING))
    done = this.bench.wait(program, limit=60)
    this.told(done, *((0, 130) if this.count else (0,)), names="interrupted")
    no_orphans(this, program.pid)
    this.resumed(out)


@fault("signalled-twice", "Ctrl-C twice: it ends at once", 10, 0, ["linux"])
def signalled_twice(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, this.random.choice([1, 2]))
    at_random(this, program)
    program.send_signal(signal.SIGINT)
    time.sleep(this.random.uniform(0, 0.1))
    program.send_signal(signal.SIGINT)
    done = this.bench.wait(program, limit=60)
    if this.count:
        this.told(done, 0, 130, names="interrupted")
        this.wrong += [f"took {done.seconds:.0f} s to end"] * (done.seconds > 10)
    no_orphans(this, program.pid)
    this.resumed(out)


@fault("stopped", "SIGSTOP of everything for a second, then SIGCONT (a laptop that sleeps)", 6, 0, ["linux"])
def stopped(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, 2)
    at_random(this, program)
    os.killpg(program.pid, signal.SIGSTOP)
    time.sleep(1)
    os.killpg(program.pid, signal.SIGCONT)
    if this.told(this.bench.wait(program), 0):
        this.whole(out)


def working_on(main: int, name: str) -> int:
    """The worker that writes the cell whose hidden folder's name holds `name`; 0 if none comes."""
    deadline = time.monotonic() + PATIENCE
    while (members := members_of(main)) and time.monotonic() < deadline:
        for pid in members.keys() - {main}:
            try:
                files = [os.readlink(entry) for entry in Path(f"/proc/{pid}/fd").iterdir()]
            except OSError:
                continue
            if any(name in file and ".tmp-" in file for file in files):
                return pid
        time.sleep(0.005)
    return 0


@fault(
    "cell-dies",
    "a cell whose worker is killed each time: it alone is given up, what does not need it goes on",
    3,
    0,
    ["linux"],
)
def cell_dies(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, 2)
    deaths = 0
    while program.poll() is None and (pid := working_on(program.pid, "go_to_human-mb-seed-0000")):
        os.kill(pid, signal.SIGKILL)
        deaths += 1
    done = this.bench.wait(program)
    this.count = int(deaths >= 3)
    this.told(done, 4, names="go_to_human/mb/seed-0000.*died")
    run = the_run(out)
    others = [path for path in this.bench.expected if path.endswith("cell.json") and "seed-0001" in path]
    this.wrong += [f"{path}: was not done, though another cell died" for path in others if not (run / path).exists()]
    this.resumed(out)


@fault("cell-hangs", "a worker that is stopped for good: after a minute the run says which cell", 1, 0, ["linux"])
def cell_hangs(this: Try) -> None:
    out = this.folder / "runs"
    arguments = "run", this.bench.config, "--out", out, "--workers", 2
    log = this.folder / "stderr"
    with log.open("wb") as stream:
        program = this.bench.start(*arguments, cwd=this.folder, stderr=stream, stdout=subprocess.DEVNULL)
        pid = working_on(program.pid, "go_to_human-mb-seed-0000")
        if not pid:
            this.count = 0
            program.kill()
            return
        os.kill(pid, signal.SIGSTOP)
        deadline = time.monotonic() + 90
        told = False
        while not told and time.monotonic() < deadline and program.poll() is None:
            time.sleep(1)
            lines = log.read_text().splitlines()
            told = any("go_to_human/mb/seed-0000" in line and "reward a trial" not in line for line in lines)
        this.wrong += ["a worker that hung for 90 s was not told"] * (not told)
        os.kill(pid, signal.SIGCONT)
        this.bench.wait(program)
    this.resumed(out)


CHANGES = {
    "raises": "raise ZeroDivisionError('division by zero')",
    "yields NaN": "return result[0] * float('nan'), *result[1:]",
}
SITE = """
import importlib.abc, importlib.machinery, sys

def wrap(original, social):
    def simulate(simulation, *rest):
        result = original(simulation, *rest)
        task = type(simulation.stretches[-1].task).__name__
        if len(rest) and task.lower().startswith('social') and result[0].size > 1:
            {change}
        return result
    return simulate

class Loader(importlib.abc.Loader):
    def __init__(self, inner): self.inner = inner
    def create_module(self, spec): return self.inner.create_module(spec)
    def exec_module(self, module):
        self.inner.exec_module(module)
        module.simulate = wrap(module.simulate, None)

class Finder(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name != 'visitlab_cli.execution.cell_runner':
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path)
        spec.loader = Loader(spec.loader)
        return spec

sys.meta_path.insert(0, Finder())
"""


@fault("cell-fails", "a cell that raises, or yields NaN: it alone fails, in one line", 4, 1)
def cell_fails(this: Try) -> None:
    out = this.folder / "runs"
    site = this.folder / "site"
    site.mkdir()
    what = sorted(CHANGES)[this.index % 2]
    (site / "sitecustomize.py").write_text(SITE.format(change=CHANGES[what]))
    done = this.run(out, "--workers", 1 + this.index // 2 % 2, env={"PYTHONPATH": str(site)})
    this.told(done, 4, names="social/mb/fast/seed-000", exceptions=True)
    run = the_run(out)
    wanted = [path for path in this.bench.expected if path.startswith(("navigation", "go_to_human"))]
    this.wrong += [f"{path}: was not done, though another cell failed" for path in wanted if not (run / path).exists()]
    this.wrong += [f"{cell}: finished, though it {what}" for cell in run.glob("social/**/cell.json")]
    this.resumed(out)


@fault("together", "two or three runners of one run at once, begun at random moments", 10, 1)
def together(this: Try) -> None:
    out = this.folder / "runs"
    programs = []
    for _ in range(this.random.choice([2, 3])):
        programs.append(started(this, out, this.random.choice([1, 2])))
        time.sleep(this.random.uniform(0, 0.5))
    for program in programs:
        this.told(this.bench.wait(program), 0)
    this.whole(out)


@fault("together-killed", "two runners of one run, one of them killed at a random moment", 8)
def together_killed(this: Try) -> None:
    out = this.folder / "runs"
    victim, other = started(this, out, 1), started(this, out, 1)
    at_random(this, victim)
    victim.kill()
    victim.communicate()
    this.told(this.bench.wait(other), 0)
    this.resumed(out)


@fault("removed-meanwhile", "`runs rm` and `runs prune` at random moments of a run that is going on", 8, 0)
def removed_meanwhile(this: Try) -> None:
    out, was_removed = this.folder / "runs", False
    program = started(this, out, 2)
    time.sleep(0.3 * this.bench.seconds)
    for _ in range(6):
        name = next((path.name for path in out.glob("faults-*") if (path / "config.yaml").exists()), None)
        arguments = this.random.choice([["rm", name, "--yes"], ["prune", name]])
        if name is None or program.poll() is not None:
            break
        done = this.visitlab("runs", *arguments, "--out", out)
        if arguments[0] == "rm" and done.code == 0:  # all was done, and the program about to end
            was_removed = True
            try:
                program.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                this.wrong.append("the run that was going on was removed")
            break
        if program.poll() is None:
            this.told(done, *((0, 4) if arguments[0] == "prune" else (2, 4)))
    ended_well = this.told(this.bench.wait(program), 0)
    if list(out.glob("faults-*")):
        this.whole(out)
    elif not (was_removed and ended_well):  # else it had finished, and was removed then
        this.lost.append("the run that was going on was removed")


@fault("folder-vanishes", "the run's folder is deleted or renamed at a random moment", 6)
def folder_vanishes(this: Try) -> None:
    out = this.folder / "runs"
    program = started(this, out, this.random.choice([1, 2]))
    at_random(this, program)
    if out.exists():
        if this.random.random() < 0.5:
            out.rename(this.folder / "moved")
        else:
            shutil.rmtree(out, ignore_errors=True)
    done = this.bench.wait(program)
    this.told(done, 0, 4, 5)
    no_orphans(this, program.pid)
    shutil.rmtree(out, ignore_errors=True)
    this.resumed(out)


@fault("workers", "1, 2, 3 and 8 workers: the same bytes", 4)
def workers(this: Try) -> None:
    out = this.folder / "runs"
    if this.told(this.run(out, "--workers", [8, 1, 3, 2][this.index % 4]), 0):
        this.whole(out)
