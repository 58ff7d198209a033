"""What `--dry-run` of `run`, `train` and `eval` prints: the cells that are yet to do, and what they would cost."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from visitlab_cli.console.words import aligned, size_in_words
from visitlab_cli.terminal import tell, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.plan.cells import Cell
    from visitlab_cli.plan.estimate import Estimate


def tell_plan(run: Path, cells: Sequence["Cell"], *, workers: int, as_json: bool) -> None:
    """Print what running `cells` in the folder `run` would do; nothing is written."""
    from visitlab_cli.execution.runner import missing_cells
    from visitlab_cli.plan.estimate import estimate

    missing = missing_cells(run, cells)
    if missing:
        warn_of_hindrance(run)
    groups: dict[str, list[Cell]] = {}
    for cell in missing:
        groups.setdefault(cell.group, []).append(cell)
    costs = {group: estimate(members, 1) for group, members in groups.items()}
    total = estimate(missing, workers)
    if as_json:
        told = {"run": str(run), "done": len(cells) - len(missing), "workers": workers, **_json(total)}
        tell_json({**told, "groups": {name: _json(cost) for name, cost in costs.items()}})
        return
    if costs:
        tell_text(_table(costs, {group: members[0] for group, members in groups.items()}) + "\n")
    done = f", {len(cells) - len(missing)} done already" if len(missing) < len(cells) else ""
    tell(f"{total.cells} cells to do{done}; {total.steps:,} steps, {size_in_words(total.bytes)}")
    tell(f"about {duration(total.seconds)} on {workers} worker{'s' if workers > 1 else ''}; the run is {run}")


def warn_of_hindrance(run: Path) -> None:
    """Tell what would come of writing in the folder `run` where that can't be: no failure of a plan, but a warning."""
    from visitlab_cli.storage.file_system import hindrance

    if why := hindrance(run):
        whither = "copy the run to a folder that can be" if run.is_dir() else "choose another folder with --out"
        tell(f"{run}: can't be written: {why}; without --dry-run this would fail, exit code 4: {whither}", err=True)


def _json(cost: "Estimate") -> dict[str, float]:
    return {"cells": cost.cells, "steps": cost.steps, "seconds": round(cost.seconds, 1), "bytes": cost.bytes}


def _table(costs: "dict[str, Estimate]", cells: "dict[str, Cell]") -> str:
    """A line for each group, of which `cells` has one each."""
    from visitlab_cli.results.groups import point_of
    from visitlab_cli.results.varying import varying

    which, head = "module or visit", ["cells", "steps", "time on one core", "disk"]
    varied = varying((point_of(cell) for cell in cells.values()), taken=(which, *head))
    rows = [[which, *varied.heads.values(), *head]]
    for name, cost in costs.items():
        told = str(cost.cells), f"{cost.steps:,}", duration(cost.seconds), size_in_words(cost.bytes)
        rows.append([cells[name].condition, *varied.values(point_of(cells[name])), *told])
    return aligned(rows, words=1 + len(varied.heads))


def duration(seconds: float) -> str:
    """A time in words, coarse."""
    if seconds < 99.5:
        return f"{max(seconds, 1):.0f} s"
    minutes = seconds / 60
    return f"{minutes:.0f} min" if minutes < 99.5 else f"{minutes / 60:.1f} h"
