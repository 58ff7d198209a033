"""What is wrong with a map: each fault with the line and column at which it stands."""

from collections.abc import Iterator
from typing import NamedTuple

from visitlab_cli.wording import shown
from visitlab_cli.world.layout import SOLID_CELL, Layout, Opening

MOST_CELLS_A_SIDE = 64
MOST_ROOMS = 26
MOST_FAULTS = 20
LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


class Fault(NamedTuple):
    """Something wrong; `line` and `column` of the map from 1."""

    line: int
    column: int
    message: str


def map_faults(text: str) -> list[Fault]:
    """What is wrong with a map, a line a row of cells: at most `MOST_FAULTS`, from the north-west on; none if it fits.

    Only where each row has the right length and knows its letters the rooms and doors are looked at.
    """
    found = list(_shape(text)) or list(_rooms_and_doors(Layout(text)))
    return sorted(found)[:MOST_FAULTS]


def _shape(text: str) -> Iterator[Fault]:
    lines = text.split("\n")
    if len(lines) > MOST_CELLS_A_SIDE:
        yield Fault(MOST_CELLS_A_SIDE + 1, 1, f"at most {MOST_CELLS_A_SIDE} rows of cells (got {len(lines)})")
    width = len(lines[0])
    if not width:
        yield Fault(1, 1, "a row without cells")
        return
    if width > MOST_CELLS_A_SIDE:
        yield Fault(1, MOST_CELLS_A_SIDE + 1, f"at most {MOST_CELLS_A_SIDE} cells in a row (got {width})")
        return
    for number, line in enumerate(lines[:MOST_CELLS_A_SIDE], 1):
        if len(line) != width:
            message = f"{len(line)} cells; the first row has {width}, and all have the same"
            yield Fault(number, min(len(line), width) + 1, message)
        for column, cell in enumerate(line[:width], 1):
            if cell != SOLID_CELL and cell.upper() not in LETTERS:
                what = f"{shown(cell)}; a cell is a letter, its room's, or {SOLID_CELL}, solid"
                yield Fault(number, column, what)


def _rooms_and_doors(layout: Layout) -> Iterator[Fault]:
    if len(layout.letters) < 2:
        yield Fault(1, 1, "fewer than two rooms; a goal must have another one to follow it")
        return
    within = layout.within_reach()
    main = layout.letters[layout.rooms[within][0]]
    reached = set(layout.rooms[within].tolist())
    for room, letter in enumerate(layout.letters):
        if room not in reached:
            first = layout.text.upper().replace("\n", "").index(letter)
            yield Fault(first // layout.cols + 1, first % layout.cols + 1, f"no way leads from {main} to {letter}")
    explained = {cell for pairs in layout.doors.values() for pair in pairs for cell in pair}
    for row, line in enumerate(layout.lines):
        for col, cell in enumerate(line):
            if cell.islower() and (row, col) not in explained and any(map(str.isupper, layout.text)):
                beside = "no neighbour is one of another room"
                yield Fault(row + 1, col + 1, f"{cell} is the cell of a doorway (lower case), but {beside}")
    for door in layout.doors:
        for opening in layout.openings(door):
            others = _by_accident(layout, door, opening)
            if others:
                row, col = min(cell for pair in opening for cell in pair)
                way = "move one of them, or write a cell in upper case"
                yield Fault(row + 1, col + 1, f"{' and '.join(others)} lie so close that {door} opens, too; {way}")


def _by_accident(layout: Layout, door: str, opening: Opening) -> list[str]:
    """The other doors whose cells alone make this opening; none where a cell of it is of no other door."""
    others: set[str] = set()
    for pair in opening:
        for cell in pair:
            elsewhere = [name for name, pairs in layout.doors.items() if name != door and _is_in(cell, pairs)]
            if not elsewhere:
                return []
            others.update(elsewhere)
    return sorted(others)


def _is_in(cell: tuple[int, int], pairs: Opening) -> bool:
    return any(cell in pair for pair in pairs)
