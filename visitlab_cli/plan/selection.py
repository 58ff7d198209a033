"""Which cells of a run a user's words choose: by experiment, human, agent, seed, and values of what varies."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from visitlab_cli.config.grid import value_in_words
from visitlab_cli.config.phases import PHASES
from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.wording import few, or_else, printable

MOST_NAMED = 3


@dataclass(frozen=True)
class Selection:
    """What is wanted of a run; empty or None is anything.

    `at` has values of what varies, as `path=value`; a cell to which a path does not matter is at each of its values.
    `in_phases` says that a cell is one with the human, too, which meets it in a phase.
    """

    experiment: str = ""
    human: str = ""
    agent: str = ""
    seed: int | None = None
    at: tuple[str, ...] = ()
    in_phases: bool = False

    def matches(self, cell: Cell) -> bool:
        """Whether a cell is of the wanted kind."""
        return (
            self.experiment in ("", cell.experiment)
            and (self.human in ("", cell.human) or (self.in_phases and self.human in cell.humans))
            and self.agent in ("", cell.agent)
            and self.seed in (None, cell.seed)
            and all(_is_at(cell, *_parts(each)) for each in self.at)
        )

    def __str__(self) -> str:
        wanted = {"experiment": self.experiment, "human": self.human, "agent": self.agent, "seed": self.seed}
        words = [f"--{name} {value}" for name, value in wanted.items() if value not in ("", None)]
        return " ".join([*words, *(f"--at {each}" for each in self.at)])

    def of(self, run: Path, cells: Sequence[Cell]) -> list[Cell]:
        """The cells of a run's plan that match, at least one.

        Raises:
            NotFoundError: there is none, or a path of `at` does not vary; with what there is.
            UsageError: `at` is no `path=value`.
        """
        for each in self.at:
            self._check_at(run, cells, *_parts(each))
        matching = [cell for cell in cells if self.matches(cell)]
        if matching:
            return matching
        in_phases = replace(self, human=PHASES)
        if any(in_phases.matches(cell) and cell.human == PHASES and self.human in cell.humans for cell in cells):
            raise NotFoundError(
                f"{run}: {self.human} is met in phases there: use --human {PHASES}, or --phase N where a command has it"
            )
        for name in ("experiment", "human", "agent"):
            value, known = getattr(self, name), sorted({getattr(cell, name) for cell in cells} - {""})
            if value and value not in known:
                raise NotFoundError(f"{run}: no {name} {printable(value)}{or_else(value, known)}")
        seeds = max(cell.seed for cell in cells)
        if self.seed is not None and self.seed > seeds:
            raise NotFoundError(f"{run}: no seed {self.seed}; its seeds are 0 to {seeds}")
        raise NotFoundError(f"{run}: no cell with {self}; there are {few([cell.path for cell in cells], MOST_NAMED)}")

    def _check_at(self, run: Path, cells: Sequence[Cell], path: str, value: str) -> None:
        known = list(dict.fromkeys(value_in_words(cell.point[path]) for cell in cells if path in cell.point))
        if not known:
            paths = list(dict.fromkeys(path for cell in cells for path in cell.point))
            raise NotFoundError(f"--at {path}: does not vary in {run}{or_else(path, paths) if paths else ''}")
        if not any(_same(value, words) for words in known):
            raise NotFoundError(f"{run}: never at {path}={printable(value)}; known: {', '.join(known)}")


def _parts(at: str) -> tuple[str, str]:
    path, equals, value = at.partition("=")
    if not equals:
        raise UsageError(f"--at {printable(at)}: must be PATH=VALUE, such as agents.mb.epsilon=0.1")
    return path, value


def _is_at(cell: Cell, path: str, value: str) -> bool:
    return path not in cell.point or _same(value, value_in_words(cell.point[path]))


def _same(value: str, words: str) -> bool:
    """Whether a user's word means a value: the same text, or the same number."""
    try:
        return value == words or float(value) == float(words)
    except ValueError:
        return False
