"""Problems of a config as lines `file:line:column: path: message`, all at once and sorted."""

import difflib
import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from visitlab_cli.config.document import Node, Place
from visitlab_cli.errors import ConfigError
from visitlab_cli.terminal import plain

MOST_LINES = 50
LONGEST_SHOWN = 60
MOST_NAMES = 20
MOST_COMPARED = 5_000

Path = tuple[str | int, ...]


@dataclass(frozen=True, slots=True)
class Issue:
    """Something wrong at a path of the config; `at` says what to point at."""

    path: Path
    message: str
    at: Literal["value", "key"] = "value"


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
    return Problem(node.key if at_key and node.key else node.place, issue.path, issue.message)


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
    return ".".join(printable(_cut(str(part))) for part in path)


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."


def printable(text: str) -> str:
    """A name as it is, or quoted and escaped if it could break the line."""
    return text if text.isprintable() else repr(text)


def shown(value: Any) -> str:
    """A value in a message, on one line and not too long."""
    if isinstance(value, dict | list | tuple):
        return "a mapping" if isinstance(value, dict) else "a list"
    return _cut({None: "nothing", True: "true", False: "false"}[value] if _is_word(value) else repr(value))


def _is_word(value: Any) -> bool:
    return value is None or isinstance(value, bool)


def few(things: Sequence[Any], most: int) -> str:
    """The first `most` of some things in words, and how many more there are."""
    more = f" and {len(things) - most} more" if len(things) > most else ""
    return ", ".join(map(str, things[:most])) + more


_compared = itertools.count()


def start_comparing() -> None:
    """Names are compared anew: a config with thousands of wrong ones gets suggestions for the first of them only."""
    global _compared
    _compared = itertools.count()


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """The known name that `name` is probably a slip of."""
    by_lower = {other.lower(): other for other in reversed(list(known))}
    if len(by_lower) > MOST_COMPARED or len(name) > LONGEST_SHOWN or next(_compared) * len(by_lower) > MOST_COMPARED:
        return None
    near = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=0.6)
    return by_lower[near[0]] if near else None


def or_else(name: Any, known: Sequence[str]) -> str:
    """How a message about an unknown name ends: the nearest known name, else all of them."""
    near = nearest_name(name, known) if isinstance(name, str) else None
    if near is not None:
        return f"; did you mean {printable(near)}?"
    names = [printable(_cut(other)) for other in known[:MOST_NAMES]] + ["..."] * (len(known) > MOST_NAMES)
    return f"; known: {', '.join(names)}" if names else "; none is declared"
