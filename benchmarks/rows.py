"""A measured figure as a row, and rows as the one table that all benchmarks print and docs/performance.md shows."""

from collections.abc import Iterable
from typing import NamedTuple

HEADS = ("what", "value", "unit", "beside", "ratio", "to reach")


class Row(NamedTuple):
    """One figure, what was measured beside it in the same run, and how often it is that; `wanted` is what to reach."""

    what: str
    value: float
    unit: str
    beside: str = ""
    ratio: float | None = None
    wanted: str = ""


def number(value: float) -> str:
    """Three digits that count."""
    if value == 0 or not abs(value) < 1e15:
        return f"{value:g}"
    if abs(value) >= 100:
        return f"{float(f'{value:.3g}'):,.0f}"
    return f"{value:.3g}"


def cells_of(row: Row) -> tuple[str, ...]:
    """A row's texts, in the order of the heads."""
    ratio = "" if row.ratio is None else number(row.ratio)
    return row.what, number(row.value), row.unit, row.beside, ratio, row.wanted


WIDTHS = (58, 12, 22, 34, 8, 14)


def line(cells: Iterable[str]) -> str:
    """A row of the table in a terminal."""
    what, value, unit, beside, ratio, wanted = cells
    aligned = (f"{what:{WIDTHS[0]}}", f"{value:>{WIDTHS[1]}}", f"{unit:{WIDTHS[2]}}", f"{beside:{WIDTHS[3]}}")
    return " ".join((*aligned, f"{ratio:>{WIDTHS[4]}}", f"{wanted:>{WIDTHS[5]}}")).rstrip()


def show(rows: Iterable[Row]) -> list[Row]:
    """Print rows as they come, and give them back."""
    shown = []
    print(line(HEADS), flush=True)
    for row in rows:
        print(line(cells_of(row)), flush=True)
        shown.append(row)
    return shown


def markdown(rows: Iterable[Row]) -> str:
    """The same as a table of Markdown."""
    lines = ["| " + " | ".join(HEADS) + " |", "|---|--:|---|---|--:|--:|"]
    return "\n".join([*lines, *("| " + " | ".join(cells_of(row)) + " |" for row in rows)]) + "\n"
