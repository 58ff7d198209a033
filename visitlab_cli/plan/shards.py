"""Dividing the cells of a plan among runners that know nothing of each other: the same on every machine."""

import heapq
from collections.abc import Callable, Sequence
from typing import NamedTuple

from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.estimate import seconds_of

WORTH = 1.1
"""A division that cuts chains must make the longest shard this much shorter than one that cuts fewer."""


class Shard(NamedTuple):
    """One of `total` shards, from 1."""

    number: int
    total: int

    @classmethod
    def from_words(cls, words: str) -> "Shard":
        """From such as '2/8'."""
        number, total = words.split("/")
        return cls(int(number), int(total))

    def of(self, cells: Sequence[Cell]) -> list[Cell]:
        """Its cells of a plan in their order, then those of other shards that they need, which maybe nobody does."""
        own = shards(cells, self.total)[self.number - 1]
        planned, chosen = {cell.path: cell for cell in cells}, {cell.path for cell in own}
        needed: dict[str, Cell] = {}
        wanting = list(own)
        while wanting:
            found = {path: planned[path] for path in wanting.pop().modules.values() if path in planned}
            new = {path: cell for path, cell in found.items() if path not in chosen | needed.keys()}
            needed |= new
            wanting += new.values()
        return own + [cell for cell in cells if cell.path in needed]


def shards(cells: Sequence[Cell], count: int) -> list[list[Cell]]:
    """The cells of a plan in `count` parts of about the same cost, each cell once.

    Cells that need each other stay together where that costs no time to speak of; else those that share a cheap module
    are divided, and where that does not suffice, all.
    """
    costs = {cell.path: seconds_of(cell) for cell in cells}
    divisions = [_divided(_joined(cells, binds), costs, count) for binds in (_all_needed, _dearest(costs), _nothing)]
    longest = [max(_loads(parts, costs, count)) for parts in divisions]
    chosen = next(parts for parts, cost in zip(divisions, longest, strict=True) if cost <= WORTH * min(longest))
    found: list[list[Cell]] = [[] for _ in range(count)]
    for cell in cells:
        found[chosen[cell.path]].append(cell)
    return found


Binds = Callable[[Cell], Sequence[str]]
"""Which of the cells that a cell needs must be in its shard."""


def _all_needed(cell: Cell) -> Sequence[str]:
    return list(cell.modules.values())


def _nothing(cell: Cell) -> Sequence[str]:
    return []


def _dearest(costs: dict[str, float]) -> Binds:
    def binds(cell: Cell) -> Sequence[str]:
        known = [path for path in cell.modules.values() if path in costs]
        return [max(known, key=lambda path: costs[path])] if known else []

    return binds


def _joined(cells: Sequence[Cell], binds: Binds) -> list[list[Cell]]:
    """The cells in groups that are bound together, each in the order of the plan."""
    group: dict[str, str] = {cell.path: cell.path for cell in cells}

    def first(path: str) -> str:
        while group[path] != path:
            group[path] = group[group[path]]
            path = group[path]
        return path

    for cell in cells:
        for path in binds(cell):
            if path in group:
                group[first(cell.path)] = first(path)
    found: dict[str, list[Cell]] = {}
    for cell in cells:
        found.setdefault(first(cell.path), []).append(cell)
    return list(found.values())


def _divided(groups: list[list[Cell]], costs: dict[str, float], count: int) -> dict[str, int]:
    """The part of each cell, by its path: the dearest group first, each to the part that has cost least so far."""
    totals = [sum(costs[cell.path] for cell in group) for group in groups]
    loads = [(0.0, part) for part in range(count)]
    parts: dict[str, int] = {}
    for number in sorted(range(len(groups)), key=lambda number: (-totals[number], number)):
        load, part = heapq.heappop(loads)
        heapq.heappush(loads, (load + totals[number], part))
        parts.update(dict.fromkeys((cell.path for cell in groups[number]), part))
    return parts


def _loads(parts: dict[str, int], costs: dict[str, float], count: int) -> list[float]:
    loads = [0.0] * count
    for path, part in parts.items():
        loads[part] += costs[path]
    return loads
