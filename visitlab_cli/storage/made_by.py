"""Which code made the cells of a run, by the hash of its sources that each of them states."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from visitlab_cli.storage.cell_folder import SOURCES, read_cell
from visitlab_cli.wording import few

UNKNOWN = "unknown"
"""What made a cell of before cells stated it."""
MOST_NAMED = 4


def sources_of(facts: Mapping[str, Any]) -> str:
    """The hash of the sources that made a cell with these facts; `UNKNOWN` where it does not say."""
    return str(facts.get(SOURCES, UNKNOWN))


def made_by(run: Path, paths: Iterable[str]) -> dict[str, list[str]]:
    """The finished ones among some cells of a run, by the sources that made them."""
    found: dict[str, list[str]] = {}
    for path in dict.fromkeys(paths):
        if (facts := read_cell(run / path)) is not None:
            found.setdefault(sources_of(facts), []).append(path)
    return dict(sorted(found.items()))


def mixed(found: Mapping[str, list[str]]) -> str | None:
    """A line that says so where cells were made by different code, of `made_by`; else None."""
    if len(found) < 2:
        return None
    parts = [f"{_cells(len(paths))} by {sources} ({few(paths, 1)})" for sources, paths in found.items()]
    return f"made by different code: {few(parts, MOST_NAMED)}"


def continued(found: Mapping[str, list[str]], ours: str, goes_on: bool) -> str | None:
    """A line that says so where a program with the sources `ours` meets cells that others made; else None."""
    others = {sources: paths for sources, paths in found.items() if sources != ours}
    if not others:
        return None
    count = sum(map(len, others.values()))
    told = f"{_cells(count)} made by other code ({few(list(others), MOST_NAMED)}; this program is {ours})"
    then = "what is missing is made by this one" if goes_on else "nothing is made anew"
    return f"{told}; {then}; another --out begins a run of its own"


def _cells(count: int) -> str:
    return f"{count:,} cell{'' if count == 1 else 's'}"
