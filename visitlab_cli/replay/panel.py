"""One panel of the strip: the shapes of a moment drawn with matplotlib, for paper."""

from collections.abc import Sequence
from functools import singledispatch
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.pictures.words import width_of
from visitlab_cli.scene.colours import FACING_FIELD, VISUAL_FIELD, shares
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Area, Arrow, Body, Line, Polygon, Role, Shape, Sight, Speech, Vectors
from visitlab_cli.scene.sight import FACES, NOTHING, SEES

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DIMMED = 0.35
NEAR_ALPHA, ELSEWHERE_ALPHA = 0.32, 0.1
POINTS_A_CELL = 4.0
"""How wide lines are: thinner than on a screen."""
BODY, BEFORE = 4.6, 3.6
"""Points: how wide a body is, and one that was there before the step."""
MARKERS = {Role.ROBOT: "s", Role.HUMAN: "o", Role.ROBOT_WAY: "s", Role.HUMAN_WAY: "o"}
LETTERS = 4.5


def draw(axes: "Axes", scene: Scene, step: int) -> None:
    """Draw the place, the two, and what the robot just did; the view is set."""
    x_range, y_range = scene.view
    axes.set(xlim=x_range, ylim=y_range[::-1], aspect="equal", xticks=[], yticks=[])
    shapes: Sequence[Shape] = [*scene.moment(step), *scene.place()]
    draw_shapes(axes, shapes)
    for sight in (shape for shape in shapes if isinstance(shape, Sight)):
        _draw_sight(axes, sight, scene)


def draw_shapes(axes: "Axes", shapes: Sequence[Shape]) -> None:
    """Draw shapes, but for the sight; x eastwards, y southwards, in cells."""
    for shape in shapes:
        _draw(shape, axes)


@singledispatch
def _draw(shape: object, axes: "Axes") -> None:
    """What has no place on paper: the tiles, which are lines, and the sight, which ends at the world."""


@_draw.register(Area)
def _draw_area(shape: Area, axes: "Axes") -> None:
    """Walls as lines, goal rooms filled, names in the corner."""
    if shape.role in (Role.GOAL, Role.REACHED, Role.SOLID):
        axes.fill(*shape.outline[:4].T, color=shares(shape.style.colour), linewidth=0, zorder=0.5)
        return
    if shape.style.width:
        axes.plot(*shape.outline.T, color="0.55", linewidth=0.5, zorder=2)
    x, y = shape.corner
    cell = _inches_a_cell(axes)
    name = shape.name(lambda words: width_of(words, LETTERS) / cell, margin=0.9)
    axes.text(x + 0.4, y + 0.35, name, fontsize=LETTERS, color="0.6", va="top")


def _inches_a_cell(axes: "Axes") -> float:
    """How large a cell is drawn."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    sides = axes.get_position().size * figure.get_size_inches()
    cells = [abs(high - low) for low, high in (axes.get_xlim(), axes.get_ylim())]
    return float(min(side / n for side, n in zip(sides, cells, strict=True)))


@_draw.register(Polygon)
def _draw_polygon(shape: Polygon, axes: "Axes") -> None:
    axes.fill(*shape.points.T, color=shares(shape.style.colour), linewidth=0, zorder=2)


@_draw.register(Line)
def _draw_line(shape: Line, axes: "Axes") -> None:
    """A flag's pole; of a way the last step, with a dimmed body where it began."""
    if shape.role == Role.TILE:
        return
    colour, marker = shares(shape.style.colour), MARKERS.get(shape.role)
    if marker is None:
        axes.plot(*shape.points.T, color=colour, linewidth=shape.style.width * POINTS_A_CELL, zorder=2)
        return
    then, now = shape.points[-2:][0], shape.points[-1]
    if (then != now).any():
        axes.plot(*np.stack([then, now]).T, color=colour, linewidth=0.8, linestyle=(0, (2, 1.5)), zorder=3)
        axes.plot(*then, marker=marker, markersize=BEFORE, color=colour, alpha=DIMMED, markeredgewidth=0, zorder=3)


@_draw.register(Arrow)
def _draw_pointer(shape: Arrow, axes: "Axes") -> None:
    _draw_arrow(axes, shape.start, shape.end, shape)
    if shape.text:
        way = (shape.end - shape.start) / np.linalg.norm(shape.end - shape.start)
        x, y = shape.start - 0.4 * way
        style: Any = {"fontsize": LETTERS, "color": shares(shape.style.colour), "zorder": 6, "clip_on": True}
        axes.text(x, y, shape.text, ha="right" if way[0] > 0 else "left", va="center", **style)


@_draw.register(Body)
def _draw_body(shape: Body, axes: "Axes") -> None:
    _draw_arrow(axes, shape.place, shape.tip, shape)
    look: Any = {"markersize": BODY * shape.scale, "markeredgecolor": "k", "markeredgewidth": 0.4, "zorder": 5}
    axes.plot(*shape.place, marker=MARKERS[shape.role], color=shares(shape.style.colour), gid=str(shape.role), **look)


@_draw.register(Speech)
def _draw_speech(shape: Speech, axes: "Axes") -> None:
    """What is said, in a bubble within the panel."""
    (x, y), up = shape.place, -1 if shape.above else 1
    low, high = sorted(axes.get_xlim())
    axes.annotate(
        shape.text.capitalize(),
        xy=(x, y + 0.5 * up),
        xytext=(min(max(x, low + 3.6), high - 3.6), y + 3.0 * up),
        fontsize=5.5,
        ha="center",
        va="center",
        bbox={"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": "k", "linewidth": 0.5},
        arrowprops={"arrowstyle": "-", "linewidth": 0.5, "shrinkA": 0, "shrinkB": 0},
        zorder=6,
    )


def _draw_arrow(axes: "Axes", start: Vectors, end: Vectors, shape: Arrow | Body) -> None:
    width = shape.style.width * POINTS_A_CELL
    arrow: Any = {"arrowstyle": "-|>,head_width=0.13,head_length=0.2", "shrinkA": 0, "shrinkB": 0}
    look = arrow | {"color": shares(shape.style.colour), "linewidth": width}
    axes.annotate("", xy=tuple(end), xytext=tuple(start), arrowprops=look, zorder=4)


def _draw_sight(axes: "Axes", sight: Sight, scene: Scene) -> None:
    """The cells of the human's fields, within the panel."""
    from matplotlib.patches import Rectangle

    image: npt.NDArray[Any] = np.zeros((*sight.cells.shape, 4))
    for kind, colour in ((SEES, VISUAL_FIELD), (FACES, FACING_FIELD)):
        image[sight.cells == kind, :3] = shares(colour)
    image[..., 3] = np.where(sight.cells != NOTHING, np.where(sight.near, NEAR_ALPHA, ELSEWHERE_ALPHA), 0)
    (x, y), (rows, cols) = sight.corner, sight.cells.shape
    extent: Any = (x, x + cols, y + rows, y)
    limits = axes.get_xlim(), axes.get_ylim()
    shown = axes.imshow(image, extent=extent, interpolation="nearest", zorder=1)
    axes.set(xlim=limits[0], ylim=limits[1])
    world = scene.trial.cols, scene.trial.rows
    (left, right), (top, bottom) = (
        (max(low, 0), min(high, n)) for (low, high), n in zip(scene.view, world, strict=True)
    )
    frame = Rectangle((left, top), right - left, bottom - top, fill=False, linewidth=0)
    axes.add_patch(frame)
    shown.set_clip_path(frame)
