"""What a scene is made of: shapes that say what they stand for, where they are, how they look and what they say.

x goes eastwards and y southwards, in cells, from the north-western corner of the world. A drawer adds nothing. The
strip draws whatever there is; Rerun, Foxglove and the report draw the roles that they name.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.scene.colours import Colour
from visitlab_cli.world.lab import runs

Vectors = npt.NDArray[np.floating[Any]]
"""Points or ways: x and y in the last axis."""


class Role(StrEnum):
    """What a shape stands for."""

    FLOOR = "floor"
    TILE = "tile"
    ROOM = "room"
    SOLID = "solid"
    WALL = "wall"
    SHUT = "shut door"
    OPEN = "open border"
    GOAL = "goal"
    REACHED = "reached"
    POLE = "pole"
    CLOTH = "cloth"
    SIGHT = "sight"
    ROBOT_WAY = "robot way"
    HUMAN_WAY = "human way"
    DESIRED = "desired"
    WANTED_HUMAN = "wanted human"
    WANTED_ROBOT = "wanted robot"
    HUMAN = "human"
    ROBOT = "robot"
    AWAY = "away"
    POINTED = "pointed"
    ROBOT_SAYS = "robot says"
    HUMAN_SAYS = "human says"


@dataclass(frozen=True)
class Style:
    """A colour, and for what has lines their width in cells."""

    colour: Colour
    width: float = 0.0


@dataclass(frozen=True, eq=False)
class Area:
    """A rectangle from its north-western `corner` on, both of shape (2,); a room has its name as `text`."""

    role: Role
    corner: Vectors
    size: Vectors
    style: Style
    text: str = ""

    def name(self, width_of: Callable[[str], float], margin: float = 0.0) -> str:
        """Its text, or where that is too wide its last word, or nothing; `width_of` words is in cells."""
        room = float(self.size[0]) - margin
        return next((words for words in (self.text, self.text.split(" ")[-1]) if width_of(words) <= room), "")

    @property
    def outline(self) -> Vectors:
        """Its border as a closed line, shape (5, 2)."""
        (left, top), (width, height) = self.corner, self.size
        right, bottom = left + width, top + height
        return np.array([(left, top), (right, top), (right, bottom), (left, bottom), (left, top)], np.float32)


@dataclass(frozen=True, eq=False)
class Line:
    """A line through `points`, shape (points, 2)."""

    role: Role
    points: Vectors
    style: Style


@dataclass(frozen=True, eq=False)
class Polygon:
    """A filled shape with corners at `points`, shape (points, 2)."""

    role: Role
    points: Vectors
    style: Style


@dataclass(frozen=True, eq=False)
class Arrow:
    """An arrow between two points of shape (2,); `text` is told beside its start."""

    role: Role
    start: Vectors
    end: Vectors
    style: Style
    text: str = ""


@dataclass(frozen=True, eq=False)
class Body:
    """Robot or human: drawn around `place`, shape (2,), `scale` cells wide, looking along the unit vector `ahead`."""

    role: Role
    place: Vectors
    heading: int
    ahead: Vectors
    style: Style
    scale: float = 1.0

    @property
    def tip(self) -> Vectors:
        """Where the arrow of its heading ends, shape (2,)."""
        tip: Vectors = self.place + 1.7 * self.scale * self.ahead
        return tip


@dataclass(frozen=True, eq=False)
class Sight:
    """What a human at `place` sees: sectors around `ahead`, or the cells around it.

    `cells` are `sight.NOTHING`, `SEES` or `FACES`, of shape (rows, cols) from `corner` on, nothing outside of the
    world; `near` tells which are at a distance to interact, up to `radius` cells. Where there are walls (`walled`) the
    cells alone say what is seen.
    """

    role: Role
    place: Vectors
    heading: int
    corner: Vectors
    cells: npt.NDArray[np.uint8]
    near: npt.NDArray[np.bool_]
    radius: float
    walled: bool = False

    def rows_of_cells(self, kind: int) -> list[tuple[int, int, int]]:
        """The cells of a class within the radius, as x and y of rows of cells side by side, and their number."""
        rows, cols = self.cells.shape
        y, x = (
            np.arange(n) + corner + 0.5 - at
            for n, corner, at in zip((rows, cols), self.corner[::-1], self.place[::-1], strict=True)
        )
        inside = (self.cells == kind) & (np.hypot(y[:, None], x) <= self.radius)
        left, top = map(int, self.corner)
        return [(left + begin, top + row, end - begin) for row in range(rows) for begin, end in runs(inside[row])]


@dataclass(frozen=True)
class Speech:
    """What robot or human at `place` says, in a bubble `above` it or below."""

    role: Role
    place: tuple[float, float]
    text: str
    above: bool


Shape = Area | Line | Polygon | Arrow | Body | Sight | Speech
