"""Who sees whom: what the straight line between the middles of two cells meets, in exact fractions."""

from fractions import Fraction
from functools import cache

Cell = tuple[int, int]
Border = tuple[Cell, Cell]  # the side that two straight neighbours share

HALF = Fraction(1, 2)


@cache
def borders_met(down: int, right: int) -> tuple[Border, ...]:
    """Every border of cells that the line meets from cell (0, 0) to (down, right), one of its ends included.

    Cell (r, c) is the square from (r, c) to (r + 1, c + 1). Each line between rows or columns is cut on its own, in no
    order; where the cut is a corner of cells, all four borders that end there are met.
    """
    met: set[Border] = set()
    for row in _lines_between(down):
        col = HALF + (row - HALF) * Fraction(right, down)
        if col.denominator == 1:
            met |= _at_corner(row, int(col))
        else:
            met.add(((row - 1, col // 1), (row, col // 1)))
    for col in _lines_between(right):
        row = HALF + (col - HALF) * Fraction(down, right)
        if row.denominator == 1:
            met |= _at_corner(int(row), col)
        else:
            met.add(((row // 1, col - 1), (row // 1, col)))
    return tuple(met)


def _lines_between(cells: int) -> range:
    return range(min(cells, 0) + 1, max(cells, 0) + 1)


def _at_corner(row: int, col: int) -> set[Border]:
    around = [(row - 1, col - 1), (row - 1, col), (row, col), (row, col - 1)]
    return {(around[i - 1], around[i]) for i in range(4)}
