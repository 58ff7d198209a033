"""Handing jobs in to a queue, and what the site allows: the queue's own programs, each answer or failure one line."""

import re
import shlex
import shutil
import subprocess
from collections.abc import Sequence

from visitlab_cli.errors import RunError, reason

LONGEST = 120
"""Seconds that a queue may take to answer."""
LIMIT = re.compile(r"^MaxArraySize\s*=\s*(\d+)", re.MULTILINE)


def site_limit() -> int | None:
    """How many jobs an array of SLURM may have here; None where it does not tell."""
    if shutil.which("scontrol") is None:
        return None
    try:
        found = LIMIT.search(_answer(["scontrol", "show", "config"]))
    except RunError:
        return None
    return int(found[1]) or None if found else None


def hand_in(commands: Sequence[Sequence[str]]) -> list[str]:
    """The numbers of the jobs that the commands, of `sbatch` or `qsub`, made.

    Raises:
        RunError: one of them is missing or refuses; with what was handed in before.
    """
    numbers: list[str] = []
    for program, *words in commands:
        options = ["--parsable"] if program == "sbatch" else []
        try:
            told = _answer([program, *options, *words])
        except RunError as error:
            before = f"; handed in before that: {' '.join(numbers)}" if numbers else ""
            raise RunError(f"{error}{before}; by hand: {shlex.join([program, *words])}") from None
        numbers.append(told.strip().splitlines()[-1].split(";")[0] if told.strip() else "?")
    return numbers


def _answer(command: Sequence[str]) -> str:
    try:
        done = subprocess.run(
            command,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=LONGEST,
            check=False,
        )
    except FileNotFoundError:
        raise RunError(f"{command[0]}: not on this machine") from None
    except subprocess.TimeoutExpired:
        raise RunError(f"{command[0]}: no answer in {LONGEST} s") from None
    except OSError as error:
        raise RunError(f"{command[0]}: {reason(error)}") from error
    if done.returncode:
        lines = [line.strip() for line in (done.stderr or done.stdout).splitlines() if line.strip()]
        why = lines[-1].removeprefix(f"{command[0]}: ") if lines else f"exit code {done.returncode}"
        raise RunError(f"{command[0]}: {why}")
    return done.stdout
