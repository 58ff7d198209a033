"""What varies in a grid, short: a column for each path, headed by the shortest end of it that no other column has."""

import json
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from visitlab_cli.config.grid import value_in_words
from visitlab_cli.results.groups import Group, Point

BETWEEN = " · "
"""Stands between what names a condition."""
NOTHING = "-"
"""Stands where a line does not depend on a column."""


@dataclass(frozen=True)
class Varying:
    """What varies over the lines of a table: the head of each column by its path, in the order of the grid.

    Where a whole human, agent or module varies, each of its settings that differs is a column of its own.
    """

    heads: dict[str, str]

    def values(self, point: Point) -> list[str]:
        """The value in each column of a line at this point of the grid."""
        settings = dict(_settings(point))
        return [settings.get(path, NOTHING) for path in self.heads]

    def words(self, point: Point) -> list[str]:
        """Its settings, without those that it does not depend on: ['plan_every=500', 'p_A=0.1']."""
        told = zip(self.heads.values(), self.values(point), strict=True)
        return [f"{head}={value}" for head, value in told if value != NOTHING]


def varying(points: Iterable[Point], taken: Collection[str] = ()) -> Varying:
    """What varies over the lines at these points; no head is among the `taken` ones."""
    found: dict[str, set[str]] = {}
    for point in sorted(points, key=len, reverse=True):  # the longest have the order of the grid
        for path, value in _settings(point):
            found.setdefault(path, set()).add(value)
    paths = [path for path, values in found.items() if len(values) > 1]
    return Varying({path: _short(path, [*(other for other in paths if other != path), *taken]) for path in paths})


def names_within(groups: Sequence[Group], varied: Varying) -> list[str]:
    """What tells groups apart: agent, human, settings, as far as they differ, and if need be the experiment."""
    parts = [(group.agent, group.human, BETWEEN.join(varied.words(group.point))) for group in groups]
    differs = [len(set(column)) > 1 for column in zip(*parts, strict=True)]
    names = [
        BETWEEN.join(word for word, wanted in zip(part, differs, strict=True) if word and wanted)
        or BETWEEN.join(filter(None, part))
        for part in parts
    ]
    if len(set(names)) == len(names):
        return names
    return [BETWEEN.join((group.experiment, name)) for group, name in zip(groups, names, strict=True)]


def _short(path: str, others: Sequence[str]) -> str:
    parts = path.split(".")
    ends = (".".join(parts[-length:]) for length in range(1, len(parts)))
    return next((end for end in ends if not any(f".{other}".endswith(f".{end}") for other in others)), path)


def _settings(point: Point) -> Iterator[tuple[str, str]]:
    """The values of a point one by one, those within an entry that varies as a whole, too."""
    for path, words in point:
        if words.startswith("{"):
            yield from _leaves(path, json.loads(words))
        else:
            yield path, words


def _leaves(path: str, value: Any) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _leaves(f"{path}.{key}", inner)
    else:
        yield path, value_in_words(value)
