"""A lab from a text map: rooms, walls, solid cells, doors by name, and what can be reached."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise

from .grid import Cell, Grid, Wall

SOLID = "#"
NO_DOORS = -1  # open_doors of a trial in which none toggles


@dataclass(frozen=True, eq=False)
class Lab:
    """One character a cell: the room's letter, in lower case in a doorway; `#` is solid.

    `closed` doors are shut, for good unless they are among `toggling`, each of which is opened or shut before every
    trial with its probability. Rooms are numbered as they first appear, row by row; a door is named by the letters of
    its two rooms in order.
    """

    map: str
    corridor: str = ""
    closed: Iterable[str] = ()
    toggling: Mapping[str, float] = field(default_factory=dict)

    @cached_property
    def lines(self) -> list[str]:
        return self.map.split()

    @cached_property
    def letters(self) -> list[str]:
        """The rooms' letters, by number."""
        return list(dict.fromkeys(each.upper() for each in "".join(self.lines) if each != SOLID))

    @cached_property
    def doors(self) -> dict[str, set[Wall]]:
        """Where each door is, by name: the borders that are open between two rooms."""
        doors: dict[str, set[Wall]] = {}
        for a, b in self._neighbours():
            first, second = self._at(a), self._at(b)
            if first.islower() and second.islower() and first != second:
                doors.setdefault("".join(sorted((first + second).upper())), set()).add(frozenset((a, b)))
        return doors

    @cached_property
    def toggled(self) -> list[str]:
        """The doors that toggle, in the order of the bits of `open_doors`."""
        return sorted(self.toggling)

    @property
    def open_at_first(self) -> int:
        """`open_doors` before the first toggle."""
        return self.bits(set(self.toggled) - set(self.closed)) if self.toggled else NO_DOORS

    def bits(self, doors: Iterable[str]) -> int:
        return sum(2 ** self.toggled.index(name) for name in doors)

    def is_open(self, door: str, open_doors: int) -> bool:
        return open_doors // 2 ** self.toggled.index(door) % 2 == 1

    def grid(self, open_doors: int) -> Grid:
        """The lab in a trial; where no door toggles, `open_doors` says nothing."""
        walls = set()
        for a, b in self._neighbours():
            first, second = self._at(a), self._at(b)
            doorway = first.islower() and second.islower()
            if SOLID in (first, second) or (first.upper() != second.upper() and not doorway):
                walls.add(frozenset((a, b)))
        shut = {name for name in self.toggled if not self.is_open(name, open_doors)}
        for name in shut | (set(self.closed) - set(self.toggled)):
            walls |= self.doors[name]
        rooms = tuple(tuple(self._number(each) for each in line) for line in self.lines)
        return Grid(len(rooms), len(rooms[0]), frozenset(walls), rooms)

    @cached_property
    def starts(self) -> tuple[Cell, ...]:
        """The largest set of cells that can be reached from each other, every toggling door being shut.

        Of several as large it is the one that holds the first cell, row by row.
        """
        grid, left, largest = self.grid(0), dict.fromkeys(self._cells()), set[Cell]()
        while left:
            found, edge = set(), [next(iter(left))]
            while edge:
                cell = edge.pop()
                if cell not in found:
                    found.add(cell)
                    edge += [each for way in (0, 2, 4, 6) if (each := grid.unit_step(cell, way)) is not None]
            left = {cell: None for cell in left if cell not in found}
            largest = max(largest, found, key=len)
        return tuple(sorted(largest))

    @cached_property
    def goals(self) -> frozenset[int]:
        """The numbers of the rooms that can be reached and are no corridor."""
        reached = {self._at(cell).upper() for cell in self.starts}
        return frozenset(self.letters.index(each) for each in reached - set(self.corridor))

    def _at(self, cell: Cell) -> str:
        return self.lines[cell[0]][cell[1]]

    def _number(self, letter: str) -> int:
        return -1 if letter == SOLID else self.letters.index(letter.upper())

    def _cells(self) -> Iterator[Cell]:
        """All but the solid ones."""
        for row, line in enumerate(self.lines):
            yield from ((row, col) for col, letter in enumerate(line) if letter != SOLID)

    def _neighbours(self) -> Iterator[tuple[Cell, Cell]]:
        height, width = len(self.lines), len(self.lines[0])
        for row in range(height):
            yield from pairwise((row, col) for col in range(width))
        for col in range(width):
            yield from pairwise((row, col) for row in range(height))
