"""Polar maps of the best action around the human: the human in the middle, the desired direction up."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from visitlab_cli.affordances.policy import UNSEEN, PolicyMap
from visitlab_cli.pictures.style import INK
from visitlab_cli.scene.colours import ACTION_COLOURS, HUMAN, shares
from visitlab_cli.scene.words import ACTION_KINDS, action_kind
from visitlab_cli.world.enums import N_DIRECTIONS, N_DISTANCES, N_MOVES
from visitlab_cli.world.geometry import is_appropriate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HOLE = 0.75
"""The radius that the human has for itself; each distance is a ring of width 1 around it."""
SECTOR = 360 / N_DIRECTIONS
UP = 90.0
"""Matplotlib counts angles from the right."""
ARROW_LENGTH = (0.42, 0.66, 0.9)
PALEST = 0.2
"""How strong the colour of an action is that hardly any of the eight desired directions agrees on."""


class Sector(NamedTuple):
    """A situation of a level's map and the action there."""

    distance: int
    bearing: int
    action: int
    share: float


def sectors(policy: PolicyMap, level: int) -> list[Sector]:
    """The situations of a level that the module ever was in."""
    seen = zip(*(policy.action[level] != UNSEEN).nonzero(), strict=True)
    return [Sector(int(d), int(b), int(policy.action[level, d, b]), float(policy.share[level, d, b])) for d, b in seen]


def colour_of(action: int) -> tuple[float, float, float]:
    """As in the replay."""
    return shares(ACTION_COLOURS[ACTION_KINDS.index(action_kind(action))])


def draw_map(axes: "Axes", policy: PolicyMap, level: int, before: PolicyMap | None = None) -> None:
    """The map of a level; where `before` had another best action, the sector is outlined."""
    from matplotlib.patches import Circle, Wedge

    shown = sectors(policy, level)
    for sector in shown:
        middle = UP + SECTOR * sector.bearing
        strength = PALEST + (1 - PALEST) * sector.share
        pale = tuple(1 - strength * (1 - part) for part in colour_of(sector.action))
        changed = before is not None and before.action[level, sector.distance, sector.bearing] != sector.action
        wedge = Wedge(
            (0, 0),
            HOLE + sector.distance + 1,
            middle - SECTOR / 2,
            middle + SECTOR / 2,
            width=1,
            facecolor=pale,
            edgecolor=INK if changed else "white",
            linewidth=0.55 if changed else 0.25,
            zorder=2 if changed else 1,
        )
        wedge.set_gid(f"{level}/{sector.distance}/{sector.bearing}/{sector.action}")
        axes.add_patch(wedge)
    _draw_moves(axes, [sector for sector in shown if sector.action < N_MOVES])
    near = [distance for distance in range(N_DISTANCES) if is_appropriate(distance)]
    for radius in (HOLE + near[0], HOLE + near[-1] + 1):
        axes.add_patch(Circle((0, 0), radius, fill=False, edgecolor=INK, linewidth=0.6, zorder=3))
    axes.plot(0, 0, marker="o", markersize=2.2, color=shares(HUMAN), zorder=4)
    edge = HOLE + N_DISTANCES
    axes.set(xlim=(-edge, edge), ylim=(-edge, edge), aspect="equal", xticks=[], yticks=[])
    axes.spines[:].set_visible(False)


def _draw_moves(axes: "Axes", moves: Sequence[Sector]) -> None:
    """An arrow for each move, as long as it is fast."""
    if not moves:
        return
    radius = np.array([HOLE + move.distance + 0.5 for move in moves])
    place = np.radians([UP + SECTOR * move.bearing for move in moves])
    way = np.radians([UP + SECTOR * (move.action % N_DIRECTIONS) for move in moves])
    length = np.array(ARROW_LENGTH)[[move.action // N_DIRECTIONS for move in moves]]
    axes.quiver(
        radius * np.cos(place),
        radius * np.sin(place),
        length * np.cos(way),
        length * np.sin(way),
        angles="xy",
        scale_units="xy",
        scale=1,
        pivot="middle",
        units="xy",
        width=0.09,
        headwidth=3.6,
        headlength=3.6,
        headaxislength=3.4,
        minlength=0,
        color=INK,
        zorder=5,
    )


def key() -> list[tuple[str, Any]]:
    """What the colours of the maps mean."""
    return [(name.lower(), shares(colour)) for name, colour in zip(ACTION_KINDS, ACTION_COLOURS, strict=True)]
