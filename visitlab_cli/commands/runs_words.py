"""Sizes, ages and mending commands in the words that the `runs` commands share."""

import shlex
from pathlib import Path

from visitlab_cli.commands.options import RUNS

KILO = 1000
AGES = ((86_400.0, "d"), (3_600.0, "h"), (60.0, "min"))


def size_in_words(size: int) -> str:
    """Bytes as a short number: 950 B, 12.3 MB."""
    number = float(size)
    for unit in ("B", "kB", "MB", "GB"):
        if number < KILO:
            return f"{number:.0f} {unit}" if unit == "B" else f"{number:.1f} {unit}"
        number /= KILO
    return f"{number:.1f} TB"


def age_in_words(seconds: float) -> str:
    """How long ago, in its largest unit."""
    for length, unit in AGES:
        if seconds >= length:
            return f"{seconds / length:.0f} {unit}"
    return f"{max(seconds, 0):.0f} s"


def number(value: float | None, form: str) -> str:
    """A number, or a dash where it is not known."""
    return "-" if value is None else format(value, form)


def run_again(run: Path) -> str:
    """The command that does what a run lacks."""
    out = "" if run.absolute().parent == RUNS.absolute() else f" --out {shlex.quote(str(run.parent))}"
    return f"visitlab run {shlex.quote(str(run / 'config.yaml'))}{out}"
