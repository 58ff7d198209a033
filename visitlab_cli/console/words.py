"""Sizes, ages, tables and mending commands as commands print them."""

import shlex
from pathlib import Path

from visitlab_cli.console.options import RUNS
from visitlab_cli.terminal import plain

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


def aligned(rows: list[list[str]], words: int) -> str:
    """Rows as columns two spaces apart; the first `words` columns are words, to the left, the others numbers."""
    rows = [list(map(plain, row)) for row in rows]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if column < words else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    )
