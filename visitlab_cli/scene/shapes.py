"""What a scene is made of: shapes that say what they stand for, where they are, how they look and what they say.

x goes eastwards and y southwards, in cells, from the north-western corner of the world. A drawer adds nothing. The
strip draws whatever there is; Rerun, Foxglove and the report draw the roles that they name.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.scene.colours import Colour

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
    world; `near` tells which are at a distance to interact, up to `radius` cells.
    """

    role: Role
    place: Vectors
    heading: int
    corner: Vectors
    cells: npt.NDArray[np.uint8]
    near: npt.NDArray[np.bool_]
    radius: float


@dataclass(frozen=True)
class Speech:
    """What robot or human at `place` says, in a bubble `above` it or below."""

    role: Role
    place: tuple[float, float]
    text: str
    above: bool


Shape = Area | Line | Polygon | Arrow | Body | Sight | Speech
