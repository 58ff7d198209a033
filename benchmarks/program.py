"""The program as a whole: start-up against a bare typer application, compilation, and the memory of a cell.

python -m benchmarks.program
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROUNDS = 15
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


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        count, seconds, ratio = help_against_bare_typer(folder)
        print(
            f"visitlab --help: {seconds:.3f} s of CPU, {ratio:.2f} times a bare typer application of {count} commands"
        )
        cold, _ = run_cell(folder, folder / "cache", "cold")
        warm, megabytes = run_cell(folder, folder / "cache", "warm")
        print(f"a cell of 500,000 social steps: {cold:.1f} s with an empty cache, {warm:.1f} s with a warm one")
        print(f"its peak memory with a warm cache, everything in one process: {megabytes:.0f} MB")


if __name__ == "__main__":
    main()
