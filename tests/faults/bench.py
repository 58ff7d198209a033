"""The bench: an undisturbed run to compare with, the program run as a user runs it, and what this machine allows."""

import importlib.util
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.program import TINY, hashes, only_cells, the_run

CONFIG = """
name: faults
seed: 7
seeds: 2
humans:
  fast: {p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.05}
  slow: {p_S: [1, 0, 0], p_M: 0.1, p_O: 0.1}
agents:
  mf: {kind: q_learning}
  mb: {kind: model_based}
  multi: {kind: multi_model}
experiments:
  navigation: {task: navigation, agents: [mf], steps: 200000}
  go_to_human: {task: go_to_human, agents: [mb], steps: 100000}
  social: {task: social, agents: [mb], humans: [fast], steps: 100000}
  visit:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb}
    humans: [fast]
    trials: 200
  several: {task: social, agents: [multi], humans: [fast, slow], steps: 50000}
  friends:
    task: visit
    modules:
      navigation: navigation/mf
      go_to_human: go_to_human/mb
      social: {pool: [several/multi/fast, several/multi/slow]}
    phases: [{trials: 60, human: fast}, {trials: 60, human: slow}]
"""
LIMIT = 180.0
"""Seconds after which a command hangs."""
SURROUNDINGS = Path(__file__).with_name("surroundings.c")


@dataclass
class Done:
    """A command that ended, by itself or since it hung; `memory` is the most that it held, in bytes."""

    words: str
    code: int
    stdout: str
    stderr: str
    seconds: float
    timed_out: bool
    memory: int


class Bench:
    """Where all tries take place: a folder that vanishes at the end."""

    def __init__(self, fast: bool = False) -> None:
        self.fast = fast
        self.folder = Path(tempfile.mkdtemp(prefix="visitlab-faults-"))
        self.config = self.folder / "faults.yaml"
        self.config.write_text(CONFIG)
        script = Path(sys.executable).with_name("visitlab")
        self.command = [str(script)] if script.exists() else [sys.executable, "-P", "-m", "visitlab_cli"]
        self._missing: dict[str, str] = {}
        self._lock = threading.Lock()

    def prepare(self) -> None:
        """Make the undisturbed run, twice over: the first may compile, the second tells how long one takes."""
        for name in ("first", "whole"):
            done = self.run("run", self.config, "--out", self.folder / name, "-q", "--workers", 2, cwd=self.folder)
            if done.code:
                raise SystemExit(f"the undisturbed run failed: {done.stderr}")
        self.seconds = done.seconds
        self.whole = the_run(self.folder / "whole")
        self.expected = only_cells(hashes(self.whole))
        if self.expected != only_cells(hashes(the_run(self.folder / "first"))):
            raise SystemExit("two undisturbed runs differ")
        shutil.rmtree(self.folder / "first")

    def tiny_run(self) -> Path:
        """The run whose files are fuzzed, made when it is first asked for."""
        with self._lock:
            out = self.folder / "tiny"
            if not out.exists():
                self.run("run", TINY, "--out", out, "-q", "--workers", 1, cwd=self.folder)
            return the_run(out)

    def close(self) -> None:
        """Remove everything."""
        shutil.rmtree(self.folder, ignore_errors=True)

    def forget(self, folder: Path) -> None:
        """Remove the folder of a try."""
        shutil.rmtree(folder, ignore_errors=True)

    def new_folder(self, name: str) -> Path:
        """A folder for one try."""
        folder = self.folder / "tries" / name
        folder.mkdir(parents=True)
        return folder

    def start(
        self, *arguments: object, cwd: Path, env: dict[str, str | None] | None = None, **options: object
    ) -> "subprocess.Popen[bytes]":
        """Start the program in a session of its own; a variable that is None is unset."""
        environment = os.environ | {"NO_COLOR": "1", "COLUMNS": "200"} | (env or {})
        return subprocess.Popen(
            [*self.command, *map(str, arguments)],
            cwd=cwd,
            env={name: value for name, value in environment.items() if value is not None},
            start_new_session=True,
            **({"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "stdin": subprocess.DEVNULL} | options),  # type: ignore[call-overload]
        )

    def run(
        self, *arguments: object, limit: float = LIMIT, limits: Sequence[tuple[int, int]] = (), **options: object
    ) -> Done:
        """Run the program to its end, under `limits` of the system (`resource.RLIMIT_...`, value) if given."""

        def limited() -> None:
            for which, value in limits:
                resource.setrlimit(which, (value, resource.getrlimit(which)[1]))

        if limits:
            options["preexec_fn"] = limited
        return self.wait(self.start(*arguments, **options), limit=limit)  # type: ignore[arg-type]

    def wait(self, program: "subprocess.Popen[bytes]", limit: float = LIMIT) -> Done:
        """Wait for the end of a program, and end it and its workers where it hangs."""
        begun = time.monotonic()
        most = _Watch(program.pid)
        try:
            stdout, stderr = program.communicate(timeout=limit)
            timed_out = False
        except subprocess.TimeoutExpired:
            timed_out = True
            os.killpg(program.pid, signal.SIGKILL)
            stdout, stderr = program.communicate()
        words = " ".join(["visitlab", *map(str, program.args[len(self.command) :])])  # type: ignore[index,arg-type]
        text = [(each or b"").decode("utf-8", "replace") for each in (stdout, stderr)]
        return Done(
            words.replace(str(self.folder), "."),
            program.returncode,
            *text,
            time.monotonic() - begun,
            timed_out,
            most.end(),
        )

    def missing(self, needs: Sequence[str]) -> str:
        """Why this machine can't do a class of faults; empty if it can."""
        with self._lock:
            for need in needs:
                if need not in self._missing:
                    self._missing[need] = NEEDS[need](self)
        return next(filter(None, (self._missing[need] for need in needs)), "")

    @property
    def surroundings(self) -> str:
        """The library that makes locks fail and clocks jump, for LD_PRELOAD."""
        return str(self.folder / "surroundings.so")


class _Watch:
    """Looks how much memory a program's session holds, four times a second."""

    def __init__(self, session: int) -> None:
        self._session, self._most, self._ended = session, 0, threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)
        self._thread.start()

    def _look(self) -> None:
        while not self._ended.wait(0.25):
            self._most = max(self._most, *(resident(pid) for pid in members_of(self._session)), 0)

    def end(self) -> int:
        self._ended.set()
        self._thread.join()
        return self._most


def resident(pid: int) -> int:
    """Bytes of memory that a process held at most; 0 if it ended."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM")), 0)


def members_of(session: int) -> dict[int, int]:
    """The living processes of a session, each with its parent."""
    found = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            fields = Path(f"/proc/{name}/stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[3]) == session and fields[0] != "Z":
            found[int(name)] = int(fields[1])
    return found


def workers_of(main: int) -> list[int]:
    """The processes that run cells: neither the main one, nor what it started to start them."""
    members = members_of(main)
    return sorted(pid for pid, parent in members.items() if pid != main and parent != main)


def _mount(bench: Bench) -> str:
    place = bench.new_folder("may-mount")
    tried = subprocess.run(["mount", "-t", "tmpfs", "none", str(place)], capture_output=True, check=False)
    if tried.returncode:
        return "nothing can be mounted here (root alone may)"
    subprocess.run(["umount", str(place)], check=True)
    return ""


def _compiler(bench: Bench) -> str:
    if sys.platform != "linux" or not shutil.which("cc"):
        return "there is no C compiler"
    command = ["cc", "-shared", "-fPIC", "-O1", "-o", bench.surroundings, str(SURROUNDINGS), "-ldl"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    return done.stderr if done.returncode else ""


NEEDS: dict[str, Callable[[Bench], str]] = {
    "mount": _mount,
    "compiler": _compiler,
    "dask": lambda bench: "" if importlib.util.find_spec("distributed") else "there is no Dask",
    "linux": lambda bench: "" if sys.platform == "linux" else "processes are found in /proc only",
}
