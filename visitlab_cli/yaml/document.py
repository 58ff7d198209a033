"""A config before validation: plain YAML values that know where they stand."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

Plain = Any
"""None, bool, int, float, str, or a list or dict (text keys) of these."""


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A place in a file, counted from 1; `line` 0 where the source has no lines (an override)."""

    source: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return f"{self.source}:{self.line}:{self.column}" if self.line else self.source

    def further(self, lines: int, columns: int) -> "Place":
        """The place so many lines and columns further on."""
        return Place(self.source, self.line + lines, self.column + columns)


@dataclass(frozen=True, slots=True)
class Node:
    """A value (a dict and a list hold nodes), where it stands, and where its key does if it has one.

    `text` is where a text of several lines begins, if each of them stands on a line of its own.
    """

    value: Plain
    place: Place
    key: Place | None = None
    text: Place | None = None

    def plain(self) -> Plain:
        """The value without its places."""
        if isinstance(self.value, dict):
            return {key: child.plain() for key, child in self.value.items()}
        if isinstance(self.value, list):
            return [child.plain() for child in self.value]
        return self.value

    def size(self) -> int:
        """How many values it is, with itself."""
        inner = self.value.values() if isinstance(self.value, dict) else self.value
        return 1 + sum(child.size() for child in inner) if isinstance(self.value, dict | list) else 1

    def sources(self) -> set[str]:
        """Where it and what it holds come from."""
        inner = self.value.values() if isinstance(self.value, dict) else self.value
        held = inner if isinstance(self.value, dict | list) else ()
        return {self.place.source}.union(*(child.sources() for child in held))

    def child(self, part: str | int) -> "Node | None":
        """The entry under a key or at an index."""
        if isinstance(self.value, dict):
            return self.value.get(part)
        if isinstance(self.value, list) and isinstance(part, int) and part < len(self.value):
            return self.value[part]  # type: ignore[no-any-return]
        return None

    def entries(self) -> "dict[str, Node]":
        """The entries of a mapping; none where it is something else, which validation reports."""
        return self.value if isinstance(self.value, dict) else {}

    def with_entries(self, entries: "dict[str, Node]") -> "Node":
        """The same node with other entries."""
        return replace(self, value=entries)

    def nearest(self, path: Sequence[str | int]) -> "tuple[Node, bool]":
        """The node at `path`, or the last one before the way ends; and whether it is all the way."""
        node = self
        for part in path:
            child = node.child(part)
            if child is None:
                return node, False
            node = child
        return node, True


def located(plain: Plain, place: Place) -> Node:
    """Plain values as nodes that all stand at one place."""
    if isinstance(plain, dict):
        return Node({key: located(value, place) for key, value in plain.items()}, place, place)
    if isinstance(plain, list | tuple):
        return Node([located(value, place) for value in plain], place, place)
    return Node(plain, place, place)


def split_path(tree: Plain, dotted: str) -> list[str]:
    """The parts of a dotted path into `tree` (plain or nodes), in which names may hold dots themselves."""
    parts: list[str] = []
    rest = dotted
    while rest:
        if isinstance(tree, Node):
            tree = tree.value
        entries = tree if isinstance(tree, dict) else {}
        fitting = [key for key in entries if rest == key or rest.startswith(f"{key}.")]
        part = max(fitting, key=len) if fitting else rest.split(".", 1)[0]
        parts.append(part)
        tree = entries.get(part)
        if len(rest) == len(part):
            return parts
        rest = rest[len(part) + 1 :]
    return [*parts, rest]
