"""A lab as people draw it: a map with a letter a cell, the rooms, walls and doors that follow from it, and a lab of it.

A letter is the room of a cell, `#` is solid. Between two straight neighbours of different rooms there is a wall,
unless both are written in lower case: such cells make a doorway. The door between two rooms is named by their letters
in order, and is all that is open between them; shutting it puts the walls back.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from visitlab_cli.world.lab import SOLID, Lab, make_lab
from visitlab_cli.world.walls import Cell, Pair

SOLID_CELL = "#"
Opening = tuple[Pair, ...]
"""Neighbouring pairs of cells that nothing parts, from the north-west on; each pair with the earlier letter first."""


@dataclass(frozen=True)
class Layout:
    """A map as its `text`, a line a row of cells, all of the same length; `map_faults` tells what else may be wrong."""

    text: str

    @cached_property
    def lines(self) -> list[str]:
        """The rows of cells."""
        return self.text.split("\n")

    @property
    def rows(self) -> int:
        """Cells from north to south."""
        return len(self.lines)

    @property
    def cols(self) -> int:
        """Cells from west to east."""
        return len(self.lines[0])

    @cached_property
    def letters(self) -> str:
        """The letters of the rooms, by their numbers: as they first appear, row by row from the north-west."""
        return "".join(dict.fromkeys(self.text.upper().replace(SOLID_CELL, "").replace("\n", "")))

    @cached_property
    def rooms(self) -> npt.NDArray[np.int64]:
        """The number of the room of each cell, `SOLID` where there is none: shape (rows, cols)."""
        number = {letter: place for place, letter in enumerate(self.letters)} | {SOLID_CELL: SOLID}
        return np.array([[number[cell] for cell in line.upper()] for line in self.lines], np.int64)

    @cached_property
    def doors(self) -> dict[str, Opening]:
        """What is open between each two rooms that have a door, by its name, in the order of the names."""
        found: dict[str, list[Pair]] = {}
        for first, second in self._borders():
            letters = self._at(first), self._at(second)
            if all(letter.islower() for letter in letters):
                pair = (first, second) if letters[0] < letters[1] else (second, first)
                found.setdefault("".join(sorted(letters)).upper(), []).append(pair)
        return {name: tuple(found[name]) for name in sorted(found)}

    def openings(self, door: str) -> list[Opening]:
        """What of a door hangs together, as one doorway: runs of pairs of cells side by side."""
        runs: list[list[Pair]] = []
        left = list(self.doors[door])
        while left:
            run = [left.pop(0)]
            for pair in run:
                beside = [other for other in left if all(_touch(*cells) for cells in zip(pair, other, strict=True))]
                run += beside
                left = [other for other in left if other not in beside]
            runs.append(run)
        return [tuple(sorted(run)) for run in runs]

    def within_reach(self, closed: Collection[str] = ()) -> npt.NDArray[np.bool_]:
        """The cells that can be reached from most others while these doors are shut: shape (rows, cols)."""
        barred = {frozenset(pair) for pair in self._walls(closed)}
        best: set[Cell] = set()
        left = set(self._cells())
        while left:
            part, edge = set(), [min(left)]
            while edge:
                cell = edge.pop()
                if cell not in part:
                    part.add(cell)
                    edge += [near for near in _around(cell) if near in left and frozenset((cell, near)) not in barred]
            left -= part
            best = max(best, part, key=len)
        found = np.zeros((self.rows, self.cols), np.bool_)
        found[tuple(zip(*best, strict=True))] = True
        return found

    def goals(self, corridor: str = "", closed: Collection[str] = ()) -> list[int]:
        """The numbers of the rooms that may be goals: no corridor, and within reach."""
        within = set(self.rooms[self.within_reach(closed)].tolist())
        return [room for room, letter in enumerate(self.letters) if letter not in corridor and room in within]

    def lab(self, corridor: str = "", closed: Collection[str] = (), toggling: Mapping[str, float] | None = None) -> Lab:
        """The lab for kernels.

        Args:
            corridor: letters of rooms that are no goals.
            closed: names of doors that are shut.
            toggling: how likely some doors are opened or shut before a trial, by their names, whose order is that of
                their bits in `Scene.open_doors`; those that are `closed`, too, are shut only at first. Trials begin,
                and goals are, where everybody can get while all of them are shut.
        """
        toggling = dict(sorted((toggling or {}).items()))
        never = {*closed, *toggling}
        return make_lab(
            self.rows,
            self.cols,
            self._walls(),
            [self.doors[door] for door in toggling],
            self.rooms,
            chances=list(toggling.values()),
            shut=[place for place, door in enumerate(toggling) if door in closed],
            starts=self.within_reach(never),
            goals=self.goals(corridor, never),
            letters=self.letters,
            named=list(toggling),
            closed={door: self.doors[door] for door in closed if door not in toggling},
        )

    def _walls(self, closed: Collection[str] = ()) -> Iterator[Pair]:
        opened = {frozenset(pair) for door, pairs in self.doors.items() if door not in closed for pair in pairs}
        yield from (pair for pair in self._borders(solid=True) if frozenset(pair) not in opened)

    def _borders(self, solid: bool = False) -> Iterator[Pair]:
        """Straight neighbours of different rooms, row by row; those with what is `solid`, too."""
        for row in range(self.rows):
            for col in range(self.cols):
                for other in ((row, col + 1), (row + 1, col)):
                    if other[0] < self.rows and other[1] < self.cols:
                        letters = {self._at((row, col)).upper(), self._at(other).upper()}
                        if len(letters) > 1 and (solid or SOLID_CELL not in letters):
                            yield (row, col), other

    def _cells(self) -> Iterator[Cell]:
        """Those that are not solid, row by row."""
        for row, line in enumerate(self.lines):
            yield from ((row, col) for col, cell in enumerate(line) if cell != SOLID_CELL)

    def _at(self, cell: Cell) -> str:
        return self.lines[cell[0]][cell[1]]


def rooms_in_rows(rows: int, cols: int, height: int, width: int, walled: bool, doorway: int) -> Layout:
    """Rooms of `height` x `width` cells, `rows` x `cols` of them, lettered row by row from the north-west.

    Args:
        rows: rooms from north to south.
        cols: rooms from west to east; at most 26 rooms in all.
        height: of a room, in cells.
        width: of a room, in cells.
        walled: whether there are walls between them.
        doorway: the cells of each doorway, in the middle of each shared wall.
    """

    def in_doorway(place: int, size: int) -> bool:
        begin = (size - doorway) // 2
        return begin <= place < begin + doorway

    def cell(row: int, col: int) -> str:
        letter = chr(ord("A") + row // height * cols + col // width)
        place, beside = (row % height, col % width), (row // height, col // width)
        north_south = (place[0] == 0 and beside[0] > 0) or (place[0] == height - 1 and beside[0] < rows - 1)
        east_west = (place[1] == 0 and beside[1] > 0) or (place[1] == width - 1 and beside[1] < cols - 1)
        opens = (north_south and in_doorway(place[1], width)) or (east_west and in_doorway(place[0], height))
        return letter.lower() if opens or not walled else letter

    lines = ["".join(cell(row, col) for col in range(cols * width)) for row in range(rows * height)]
    return Layout("\n".join(lines))


def names_of(doors: Iterable[str]) -> str:
    """Doors in words; 'none' where there are none."""
    return ", ".join(doors) or "none"


def _touch(first: Cell, second: Cell) -> bool:
    return abs(first[0] - second[0]) + abs(first[1] - second[1]) == 1


def _around(cell: Cell) -> Iterator[Cell]:
    row, col = cell
    yield from ((row, col + 1), (row - 1, col), (row, col - 1), (row + 1, col))
