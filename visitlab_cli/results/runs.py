"""A line for each run in a folder: how far it is, how large, how old."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.config.model import Config
from visitlab_cli.errors import VisitlabError
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.on_disk import bytes_below
from visitlab_cli.storage.reading import UnreadableError
from visitlab_cli.storage.run_folder import all_runs, read_config

DONE, INCOMPLETE, DAMAGED, UNREADABLE = "done", "incomplete", "damaged", "unreadable"


class RunLine(NamedTuple):
    """A run at a glance; of one that is damaged or can't be read, cells and seeds are not known and `problem` says why.

    `changed` is when something last came into its folder, in seconds since 1970: the latest is `latest`.
    """

    run: Path
    done: int | None
    cells: int | None
    seeds: int | None
    size: int
    changed: float
    problem: str | None = None
    is_readable: bool = True

    @property
    def state(self) -> str:
        """In a word."""
        if self.problem is not None:
            return DAMAGED if self.is_readable else UNREADABLE
        return DONE if self.done == self.cells else INCOMPLETE

    def as_json(self) -> dict[str, Any]:
        """The line as plain values."""
        return {
            "name": self.run.name,
            "path": str(self.run),
            "state": self.state,
            "cells_done": self.done,
            "cells": self.cells,
            "seeds": self.seeds,
            "bytes": self.size,
            "changed": self.changed,
            "problem": self.problem,
        }


def run_lines(out: Path) -> list[RunLine]:
    """The runs below `out`, the latest first."""
    return sorted((_opened(run) for run in all_runs(out)), key=lambda line: (-line.changed, line.run.name))


def run_line(run: Path, config: Config, cells: Sequence[Cell]) -> RunLine:
    """The line of a run with this config and plan."""
    done = sum(read_cell(run / cell.path) is not None for cell in cells)
    return RunLine(run, done, len(cells), config.seeds, bytes_below(run), run.stat().st_mtime)


def _opened(run: Path) -> RunLine:
    try:
        config = read_config(run)
        return run_line(run, config, plan(config))
    except VisitlabError as error:
        is_readable = not isinstance(error, UnreadableError)
        return RunLine(run, None, None, None, bytes_below(run), run.stat().st_mtime, str(error), is_readable)
