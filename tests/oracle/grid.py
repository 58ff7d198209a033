"""Movement and sight: cells, walls, unit steps, rooms."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from itertools import permutations, product

from visitlab_cli.world.enums import Direction

from .sight import Cell, borders_met

Wall = frozenset[Cell]

# (rows down, columns right) of a unit step in each direction; row 0 is north.
UNIT_STEP: dict[int, Cell] = {
    Direction.EAST: (0, 1),
    Direction.NORTH_EAST: (-1, 1),
    Direction.NORTH: (-1, 0),
    Direction.NORTH_WEST: (-1, -1),
    Direction.WEST: (0, -1),
    Direction.SOUTH_WEST: (1, -1),
    Direction.SOUTH: (1, 0),
    Direction.SOUTH_EAST: (1, 1),
}
ROOM_SIDE = 8


def is_move(action: int) -> bool:
    return 0 <= action < 24


def move_parts(action: int) -> tuple[int, int]:
    """(speed, direction) of one of the 24 moves."""
    if not is_move(action):
        raise ValueError(f"action {action} is no move")
    return action // 8 + 1, action % 8


def move_action(speed: int, direction: int) -> int:
    return 8 * (speed - 1) + direction


@dataclass(frozen=True)
class Grid:
    """A grid of cells; `walls` holds the pairs of straight neighbours that nobody passes or looks between.

    `rooms` has each cell's room, row by row, -1 where it is solid; without it rooms are squares of 8 x 8.
    """

    height: int = 24
    width: int = 24
    walls: frozenset[Wall] = field(default_factory=frozenset)
    rooms: tuple[tuple[int, ...], ...] = ()

    @classmethod
    def with_walls(cls, height: int, width: int, walls: Iterable[tuple[Cell, Cell]] = ()) -> "Grid":
        pairs = [(tuple(map(int, a)), tuple(map(int, b))) for a, b in walls]
        for a, b in pairs:
            if abs(a[0] - b[0]) + abs(a[1] - b[1]) != 1:
                raise ValueError(f"a wall stands between straight neighbours, not {a} and {b}")
        return cls(height, width, frozenset(frozenset(pair) for pair in pairs))  # type: ignore[arg-type]

    def holds(self, cell: Cell) -> bool:
        return 0 <= cell[0] < self.height and 0 <= cell[1] < self.width

    @cached_property
    def _parted(self) -> set[tuple[Cell, ...]]:
        """The pairs of `walls`, both ways round."""
        return {pair for wall in self.walls for pair in permutations(wall)}

    def _open(self, a: Cell, b: Cell) -> bool:
        return (a, b) not in self._parted

    def unit_step(self, cell: Cell, direction: int) -> Cell | None:
        """The neighbouring cell, or None where the border or a wall is in the way."""
        down, right = UNIT_STEP[direction]
        target = (cell[0] + down, cell[1] + right)
        if not self.holds(target):
            return None
        if not self.walls:
            return target
        if down == 0 or right == 0:
            return target if self._open(cell, target) else None
        for corner in ((cell[0] + down, cell[1]), (cell[0], cell[1] + right)):
            if not (self._open(cell, corner) and self._open(corner, target)):
                return None
        return target

    def move(self, cell: Cell, speed: int, direction: int) -> Cell:
        """`speed` unit steps; the first one that is blocked ends the move."""
        for _ in range(speed):
            neighbour = self.unit_step(cell, direction)
            if neighbour is None:
                return cell
            cell = neighbour
        return cell

    def after(self, cell: Cell, action: int) -> Cell:
        """Where an action leaves whoever takes it; only moves change the cell."""
        if not is_move(action):
            return cell
        return self.move(cell, *move_parts(action))

    def sees(self, a: Cell, b: Cell) -> bool:
        """Whether the straight line between the middles of two cells meets no wall, not even the end of one."""
        if not self.walls:
            return True
        (row, col), (end_row, end_col) = a, b
        for (r0, c0), (r1, c1) in borders_met(end_row - row, end_col - col):
            if ((row + r0, col + c0), (row + r1, col + c1)) in self._parted:
                return False
        return True

    def cells(self) -> Iterator[Cell]:
        """All but the solid ones, row by row."""
        for cell in product(range(self.height), range(self.width)):
            if not self.rooms or self.room(cell) >= 0:
                yield cell

    def room(self, cell: Cell) -> int:
        if self.rooms:
            return self.rooms[cell[0]][cell[1]]
        return cell[0] // ROOM_SIDE * (self.width // ROOM_SIDE) + cell[1] // ROOM_SIDE

    @property
    def n_rooms(self) -> int:
        if self.rooms:
            return max(map(max, self.rooms)) + 1
        return (self.height // ROOM_SIDE) * (self.width // ROOM_SIDE)

    @property
    def n_cells(self) -> int:
        return self.height * self.width

    def cell_number(self, cell: Cell) -> int:
        return cell[0] * self.width + cell[1]
