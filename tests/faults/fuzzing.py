"""The fuzzing as classes of faults: batches in processes of their own, under a memory limit; a crash counts, too.

Any module `fuzz_*.py` beside this one with `fuzz(n, seed) -> list of what was wrong` is one; `readers.py` has five.
"""

import importlib
import json
import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

from tests.faults.fault import Try, fault
from tests.faults.readers import TINY_RUN

BATCH, SMALL_BATCH = 700, 60
ROOM = 1 << 30
"""Bytes of memory that reading may take beside what the program takes to start."""
LIMIT = 900.0


def fuzzers() -> list[str]:
    """The names of all: `readers:yaml` or `fuzz_mcap`."""
    beside = sorted(path.stem for path in Path(__file__).parent.glob("fuzz_*.py"))
    return [*(f"readers:{kind}" for kind in ("yaml", "npz", "parquet", "json", "mcap")), *beside]


def _class_of(name: str) -> None:
    about = f"random changes of {name.partition(':')[2]} files" if ":" in name else f"`tests/faults/{name}.py`"
    whole = 6 if ":" in name else 7

    @fault(
        f"fuzz-{name.removeprefix('fuzz_').removeprefix('readers:')}" + ("" if ":" in name else "-more"),
        about,
        whole,
        1,
    )
    def check(this: Try) -> None:
        this.count = SMALL_BATCH if this.bench.fast else BATCH
        command = [
            sys.executable,
            "-m",
            "tests.faults.fuzzing",
            name,
            str(this.count),
            str(this.seed * 1000 + this.index),
        ]
        program = subprocess.Popen(
            command,
            cwd=Path(__file__).parents[2],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env=os.environ | {"TMPDIR": str(this.folder), TINY_RUN: str(this.bench.tiny_run())},
        )
        try:
            stdout, stderr = program.communicate(timeout=LIMIT)
        except subprocess.TimeoutExpired:
            os.killpg(program.pid, signal.SIGKILL)
            program.communicate()
            this.wrong.append(f"{' '.join(command[2:])}: hangs")
            return
        if program.returncode:
            this.wrong.append(f"{' '.join(command[2:])}: exit {program.returncode}: {stderr[-300:]!r}")
        else:
            this.wrong += json.loads(stdout.splitlines()[-1])


for _name in fuzzers():
    _class_of(_name)


def main(name: str, n: int, seed: int) -> None:
    """Run one fuzzer in this process, memory limited, and print what was wrong as a list in JSON."""
    import faulthandler

    faulthandler.enable()
    module, _, kind = name.partition(":")
    found = importlib.import_module(f"tests.faults.{module}")
    function = found.FUZZERS[kind] if kind else found.fuzz
    function(1, 0)  # what is imported and compiled on the way is not the readers'
    held = (
        next(
            int(line.split()[1])
            for line in Path("/proc/self/status").read_text().splitlines()
            if line.startswith("VmSize")
        )
        * 1024
    )
    resource.setrlimit(resource.RLIMIT_AS, (held + ROOM, resource.RLIM_INFINITY))
    print(json.dumps([str(each) for each in function(n, seed)]))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
