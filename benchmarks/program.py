"""The program as a whole: start-up against a bare typer application, compilation, and the memory of a cell.

python -m benchmarks.program
"""

import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
import zipfile
import zlib
from pathlib import Path

from benchmarks.rows import Row, number, show

ROUNDS = 15
MANY = 500
BARE = """
import typer
app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)
{commands}
app()
"""
CELL = """
name: cell
agents: {mb: {kind: model_based}}
humans: {h: {p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.05}}
experiments: {social: {task: social, agents: [mb], humans: [h], steps: 500000}}
"""


def children_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def as_a_user():
    """The variables of a user's shell: with Python's own bytecode kept, as it is where visitlab is installed."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}


def cpu_of(command):
    before = children_seconds()
    subprocess.run(command, env=as_a_user(), check=True, capture_output=True)
    return children_seconds() - before


def help_against_bare_typer(folder):
    """CPU seconds of `--help`, and the ratio to an application with as many commands, pair by pair."""
    from visitlab_cli.cli import app

    count = len(app.registered_commands)
    commands = "\n".join(f"@app.command()\ndef command{i}(name: str, n: int = 1): ..." for i in range(count))
    bare = folder / "bare.py"
    bare.write_text(BARE.format(commands=commands))
    ours, theirs = [sys.executable, "-m", "visitlab_cli", "--help"], [sys.executable, str(bare), "--help"]
    for command in (ours, theirs):
        cpu_of(command)
    pairs = [(cpu_of(ours), cpu_of(theirs)) for _ in range(ROUNDS)]
    seconds = statistics.median(one for one, _ in pairs)
    return count, seconds, statistics.median(one / other for one, other in pairs)


def run_cell(folder, cache, out):
    config = folder / "cell.yaml"
    config.write_text(CELL)
    command = [sys.executable, "-m", "visitlab_cli", "run", str(config), "--workers", "1", "--out", str(folder / out)]
    begun = time.perf_counter()
    process = subprocess.Popen(
        command,
        env=as_a_user() | {"VISITLAB_CACHE": str(cache)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    _, status, usage = os.wait4(process.pid, 0)
    assert status == 0
    unit = 1 if sys.platform == "darwin" else 1024
    return time.perf_counter() - begun, usage.ru_maxrss * unit / 1e6


def tiny_run(folder, cache):
    """Seconds by the clock of a run of one tiny cell, as a command; the median of some."""
    config = folder / "tiny.yaml"
    config.write_text(CELL.replace("500000", "2000"))
    seconds = []
    for turn in range(ROUNDS):
        out = str(folder / f"tiny-{turn}")
        command = [sys.executable, "-m", "visitlab_cli", "run", str(config), "--workers", "1", "--out", out]
        begun = time.perf_counter()
        environment = as_a_user() | {"VISITLAB_CACHE": str(cache)}
        subprocess.run(command, env=environment, check=True, capture_output=True)
        seconds.append(time.perf_counter() - begun)
    return statistics.median(seconds[1:])


def many_cells(folder, cache):
    """Of a run of many cells of 2,000 steps: milliseconds of CPU a cell beyond playing, and beyond a run of one cell;
    those of compressing the model of one; seconds to list the run.
    """
    config = folder / "many.yaml"
    config.write_text(CELL.replace("500000", "2000") + f"seeds: {MANY}\nrecord: {{steps: none}}\n")
    environment = as_a_user() | {"VISITLAB_CACHE": str(cache)}
    out = ["--out", str(folder / "many")]
    spent = []
    for run in (["seeds=1", "name=one", "--out", str(folder / "one")], out):
        before = children_seconds()
        command = [sys.executable, "-m", "visitlab_cli", "run", str(config), "--workers", "1", *run]
        subprocess.run(command, env=environment, check=True, capture_output=True)
        spent.append(children_seconds() - before)
    playing = sum(json.loads(file.read_text())["cpu_seconds"] for file in (folder / "many").rglob("timing.json"))
    playing *= (MANY - 1) / MANY
    model = next((folder / "many").rglob("model.npz"))
    begun = time.perf_counter()
    command = [sys.executable, "-m", "visitlab_cli", "runs", "list", *out]
    subprocess.run(command, env=environment, check=True, capture_output=True)
    listing = time.perf_counter() - begun
    return 1e3 * (spent[1] - spent[0] - playing) / (MANY - 1), compressing(model), listing


def compressing(model):
    """Milliseconds of CPU that zlib needs for the arrays of a model; the least of some."""
    with zipfile.ZipFile(model) as archive:
        arrays = [archive.read(name) for name in archive.namelist()]
    spent = []
    for _ in range(ROUNDS):
        begun = time.process_time()
        for array in arrays:
            zlib.compress(array)
        spent.append(time.process_time() - begun)
    return 1e3 * min(spent)


def figures(folder, cache):
    """Seconds of CPU of `visitlab figures` of a run of two agents, ten seeds each."""
    config = folder / "two.yaml"
    two = CELL.replace("{mb: {kind: model_based}}", "{mb: {kind: model_based}, mf: {kind: q_learning}}")
    config.write_text(two.replace("[mb]", "[mb, mf]").replace("500000", "20000") + "seeds: 10\n")
    environment, out = as_a_user() | {"VISITLAB_CACHE": str(cache)}, ["--out", str(folder / "two")]
    program = [sys.executable, "-m", "visitlab_cli"]
    subprocess.run([*program, "run", str(config), *out], env=environment, check=True, capture_output=True)
    before = children_seconds()
    command = [*program, "figures", "latest", "--only", "curves", *out]
    subprocess.run(command, env=environment, check=True, capture_output=True)
    return children_seconds() - before


def compiling_quickstart(folder):
    """Seconds of CPU of as little of it as there can be, with an empty cache."""
    environment = as_a_user() | {"VISITLAB_CACHE": str(folder / "quickstart")}
    few = [f"experiments.{task}.steps=200" for task in ("navigation", "go_to_human", "social")]
    more = ["experiments.visit.trials=2", "--out", str(folder / "quick"), "--workers", "1"]
    command = [sys.executable, "-m", "visitlab_cli", "run", "quickstart", *few, *more]
    before = children_seconds()
    subprocess.run(command, env=environment, check=True, capture_output=True)
    return children_seconds() - before


def rows():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        count, seconds, ratio = help_against_bare_typer(folder)
        yield Row("visitlab --help", seconds, "s of CPU", f"bare typer of {count} commands", ratio, "1.2")
        cold, _ = run_cell(folder, folder / "cache", "cold")
        warm, megabytes = run_cell(folder, folder / "cache", "warm")
        beside = f"with an empty cache {number(cold)}"
        yield Row("a cell of 500,000 social steps, recorded", warm, "s", beside, warm / cold)
        yield Row("its peak memory, everything in one process", megabytes, "MB")
        yield Row("a run of one cell of 2,000 steps", tiny_run(folder, folder / "cache"), "s", wanted="1.2")
        overhead, zlib_alone, listing = many_cells(folder, folder / "cache")
        what, beside = (
            f"one more cell of 2,000 steps in a run of {MANY}, playing aside",
            f"zlib for its model {number(zlib_alone)}",
        )
        yield Row(what, overhead, "ms of CPU", beside, overhead / zlib_alone, "8")
        yield Row("visitlab runs list of that run", listing, "s", wanted="1")
        yield Row("visitlab figures of a run of twenty cells", figures(folder, folder / "cache"), "s of CPU")
        yield Row("a run that compiles what quickstart needs", compiling_quickstart(folder), "s of CPU", wanted="12")


if __name__ == "__main__":
    show(rows())
