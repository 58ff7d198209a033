"""What `visitlab runs watch` shows: a bar for each group of cells, a line for each that is being done or was left."""

import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from visitlab_cli.console.dry_run import duration
from visitlab_cli.console.words import age_in_words, aligned
from visitlab_cli.terminal import plain

if TYPE_CHECKING:
    from visitlab_cli.plan.cells import Cell
    from visitlab_cli.results.watching import Look, Part, Watch
    from visitlab_cli.storage.under_way import UnderWay

WIDTH, DONE, TO_DO = 24, "\u2501", "\u254c"
SECONDS_BETWEEN, LOOKING = 2.0, 0.2
"""How often is looked, and which part of the time that takes at most."""
SILENT_SECONDS = 120.0
"""Whoever gave no sign of life for so long may be gone, which is told."""
HEAD, FEWEST_LINES = 2, 3


def follow(watch: "Watch", clock: Callable[[], float] = time.monotonic) -> None:
    """Show on a terminal how far a run is, again and again, until it is done."""
    from rich.console import Console
    from rich.live import Live
    from rich.text import Text

    console = Console(highlight=False, emoji=False)
    first, begun = watch.look(), clock()
    with Live(console=console, auto_refresh=False) as live:
        while True:
            looked = clock()
            now = watch.look()
            speed = (now.whole.cost_done - first.whole.cost_done) / max(looked - begun, 1e-9)
            left = (now.whole.cost - now.whole.cost_done) / speed if speed > 0 else None
            live.update(Text(text(now, left, console.height - 1), no_wrap=True, overflow="ellipsis"), refresh=True)
            if now.whole.done == now.whole.cells:
                return
            time.sleep(max(SECONDS_BETWEEN, (clock() - looked) / LOOKING))


def text(look: "Look", left: float | None = None, lines: int | None = None) -> str:
    """How far a run is, in at most so many `lines`; `left` are the seconds that it will take, where they are known."""
    whole = look.whole
    cells = f"{whole.done} of {whole.cells} cells, {len(look.cells)} under way"
    cells += f", {len(look.left)} to go on with" if look.left else ""
    head = f"{cells}, {whole.share:.0%} of the steps"
    if left is not None and whole.done < whole.cells:
        head += f", about {duration(left)} left"
    groups = look.groups
    rows = [_row(*each) for each in look.cells] + [_row_of_left(*each) for each in look.left]
    running = aligned(rows, words=2).splitlines() if rows else []
    if lines is not None:
        if HEAD + len(groups) + 1 + len(running) > lines:  # what is done tells least
            groups = {name: part for name, part in groups.items() if part.done < part.cells} or groups
        running = _first(running, max(FEWEST_LINES, lines - HEAD - 1 - len(groups)), "cells begun")
    bars = aligned([_bar(name, part) for name, part in groups.items()], words=2).splitlines()
    if lines is not None:
        bars = _first(bars, max(FEWEST_LINES, lines - HEAD - 1 - len(running)), "groups")
    return "\n".join([plain(str(look.run)), head, *bars, *(["", *running] if running else [])])


def _first(lines: list[str], most: int, what: str) -> list[str]:
    return lines if len(lines) <= most else [*lines[: most - 1], f"... and {len(lines) - most + 1} more {what}"]


def _bar(name: str, part: "Part") -> list[str]:
    full = int(part.share * WIDTH)
    return [name, DONE * full + TO_DO * (WIDTH - full), f"{part.share:.0%}", f"{part.done}/{part.cells}"]


def _row(each: "UnderWay", cell: "Cell") -> list[str]:
    where = f"{each.owner.host} process {each.owner.process}"
    if each.silent >= SILENT_SECONDS:
        where += f", no sign of life for {age_in_words(each.silent)}"
    return [each.cell, where, *_how_far(min(each.steps, cell.steps), cell)]


def _row_of_left(steps: int, cell: "Cell") -> list[str]:
    return [cell.path, "nobody now, to be gone on with", *_how_far(steps, cell)]


def _how_far(steps: int, cell: "Cell") -> list[str]:
    return [f"{steps / cell.steps:.0%}", f"{steps:,} of {cell.steps:,} steps"]
