"""Problems of a config as lines `file:line:column: path: message`, all at once and sorted."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from visitlab_cli.errors import ConfigError
from visitlab_cli.terminal import plain
from visitlab_cli.wording import cut, printable
from visitlab_cli.yaml.document import Node, Place

MOST_LINES = 50

Path = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Issue:
    """Something wrong at a path of the config; `at` says what to point at.

    In a text of several lines `within` is the line and column of it, from 1.
    """

    path: Path
    message: str
    at: Literal["value", "key"] = "value"
    within: tuple[int, int] | None = None


@dataclass(frozen=True, slots=True)
class Problem:
    """Something wrong at a place."""

    place: Place
    path: Path
    message: str

    def __str__(self) -> str:
        where = f"{dotted(self.path)}: " if self.path else ""
        return f"{self.place}: {where}{self.message}"

    def as_json(self) -> dict[str, Any]:
        """Plain values; an override has no line and column."""
        line, column = (self.place.line, self.place.column) if self.place.line else (None, None)
        where = {"file": self.place.source, "line": line, "column": column}
        return {**where, "path": dotted(self.path), "message": self.message}


def positioned(document: Node, issue: Issue) -> Problem:
    """Where an issue stands: its value or key; its parent's key if it is missing itself."""
    node, found = document.nearest(issue.path)
    at_key = issue.at == "key" or not found
    if found and issue.within is not None:
        line, column = issue.within
        if node.text is not None:
            return Problem(node.text.further(line - 1, column - 1), issue.path, issue.message)
        return Problem(node.place, issue.path, f"line {line}, column {column} of it: {issue.message}")
    return Problem(node.key if at_key and node.key else node.place, issue.path, issue.message)


def by_an_override(document: Node, issue: Issue, overrides: Sequence[str]) -> Problem:
    """Where an issue stands that is none of the file without the overrides, which are `sources` of places.

    An issue of a whole mapping stands at the overrides in it; one that only follows from an override says so.
    """
    problem = positioned(document, issue)
    if not problem.place.line:
        return problem
    node, found = document.nearest(issue.path)
    inside = [source for source in overrides if source in node.sources()] if found else []
    if inside:
        return Problem(Place(" and ".join(inside)), issue.path, issue.message)
    whose = overrides[0] if len(overrides) == 1 else "the overrides"
    return Problem(problem.place, issue.path, f"{issue.message} (by {whose})")


def failure(problems: Iterable[Problem]) -> ConfigError:
    """One error with a line for each problem, sorted by line; one mistake is told once."""
    told: dict[tuple[Place, str, Path], Problem] = {}
    for problem in problems:
        setting = problem.path[:1] + problem.path[2:]  # by `like`, several entries may share it
        told.setdefault((problem.place, problem.message, setting), problem)
    found = sorted(told.values(), key=_order)
    lines = [plain(str(problem)) for problem in found[:MOST_LINES]]
    more = len(found) - MOST_LINES
    lines += [f"... and {more} more"] if more > 0 else []
    return ConfigError("\n".join(lines), [problem.as_json() for problem in found])


def _order(problem: Problem) -> tuple[bool, Place]:
    return not problem.place.line, problem.place  # overrides last


def dotted(path: Path) -> str:
    """A path as the user writes it; what could break the line is escaped."""
    return ".".join(printable(cut(str(part))) for part in path)
