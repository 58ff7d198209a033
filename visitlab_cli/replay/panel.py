"""One panel of the strip: a step of a trial, drawn with matplotlib in the scene's colours."""

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.replay.actors import REACH, fields_around
from visitlab_cli.replay.away import LENGTH, sign_of
from visitlab_cli.replay.blueprint import view_of
from visitlab_cli.replay.lab import FACES, GOAL_FLOOR, REACHED_FLOOR, SEES
from visitlab_cli.replay.trial import Trial
from visitlab_cli.story import (
    DESIRED,
    FACING_FIELD,
    GESTURES,
    HUMAN,
    ROBOT,
    VISUAL_FIELD,
    Colour,
    executed,
    room_name,
)
from visitlab_cli.world.enums import Action
from visitlab_cli.world.lab import LAB_SIZE, N_ROOMS, ROOM_SIZE, ROOMS_PER_SIDE
from visitlab_cli.world.tasks import VISIT

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DIMMED = 0.35
NEAR_ALPHA, ELSEWHERE_ALPHA = 0.32, 0.1


def draw(axes: "Axes", trial: Trial, step: int) -> None:
    """Draw the place, the two, and what the robot just did."""
    if trial.has_goal:
        _goal(axes, trial, step)
    if trial.has_rooms:
        _rooms(axes)
    if trial.has_human:
        _field(axes, trial, step)
    if trial.has_engagement:
        place, way = trial.places("human")[step], trial.headings("desired_direction")[step]
        _arrow(axes, place + 1.1 * way, 2.4 * way, DESIRED, 1.6)
    if step:
        _before(axes, trial, step, "robot", ROBOT)
        if trial.has_human:
            _before(axes, trial, step, "human", HUMAN)
    if trial.has_human:
        _body(axes, trial, step, "human", HUMAN, "o")
    _body(axes, trial, step, "robot", ROBOT, "s")
    _away(axes, trial, step)
    _gesture(axes, trial, step)


def rgb(colour: Colour) -> tuple[float, float, float]:
    """A colour as matplotlib has it."""
    return colour[0] / 255, colour[1] / 255, colour[2] / 255


def _rooms(axes: "Axes") -> None:
    for line in range(0, LAB_SIZE + 1, ROOM_SIZE):
        axes.plot([line, line], [0, LAB_SIZE], color="0.55", linewidth=0.5)
        axes.plot([0, LAB_SIZE], [line, line], color="0.55", linewidth=0.5)
    for room in range(N_ROOMS):
        x, y = room % ROOMS_PER_SIDE * ROOM_SIZE, room // ROOMS_PER_SIDE * ROOM_SIZE
        axes.text(x + 0.4, y + 0.35, room_name(room), fontsize=4.5, color="0.6", va="top")


def _goal(axes: "Axes", trial: Trial, step: int) -> None:
    """The goal room; where it was reached in this step, that room too."""
    goals = trial.steps["goal_room"]
    _room(axes, int(goals[step]), GOAL_FLOOR)
    x, y = int(goals[step]) % ROOMS_PER_SIDE * ROOM_SIZE, int(goals[step]) // ROOMS_PER_SIDE * ROOM_SIZE
    axes.plot([x + 6.3, x + 6.3], [y + 0.6, y + 2.4], color="0.2", linewidth=0.8)
    axes.fill([x + 6.3, x + 7.6, x + 6.3], [y + 0.6, y + 1.1, y + 1.6], color="0.2", linewidth=0)
    if trial.task == VISIT and step and trial.steps["reward"][step] > 0:
        _room(axes, int(goals[step - 1]), REACHED_FLOOR)


def _room(axes: "Axes", room: int, colour: Colour) -> None:
    x, y = room % ROOMS_PER_SIDE * ROOM_SIZE, room // ROOMS_PER_SIDE * ROOM_SIZE
    axes.fill(
        [x, x + ROOM_SIZE, x + ROOM_SIZE, x], [y, y, y + ROOM_SIZE, y + ROOM_SIZE], color=rgb(colour), linewidth=0
    )


def _field(axes: "Axes", trial: Trial, step: int) -> None:
    """The human's visual and facing fields, as cells."""
    fields, near = fields_around(trial.distances)
    seen = fields[int(trial.steps["human_heading"][step])]
    image = np.zeros((*seen.shape, 4))
    for kind, colour in ((SEES, VISUAL_FIELD), (FACES, FACING_FIELD)):
        image[seen == kind, :3] = rgb(colour)
    image[..., 3] = np.where(seen > 0, np.where(near, NEAR_ALPHA, ELSEWHERE_ALPHA), 0)
    x, y = trial.places("human")[step]
    half = REACH + 0.5
    shown = axes.imshow(image, extent=(x - half, x + half, y + half, y - half), interpolation="nearest", zorder=1)
    seen_world = [(max(low, 0), min(high, trial.size)) for low, high in view_of(trial)]
    frame: Any = _rectangle(*seen_world)
    axes.add_patch(frame)
    shown.set_clip_path(frame)


def _rectangle(x_range: tuple[float, float], y_range: tuple[float, float]) -> Any:
    from matplotlib.patches import Rectangle

    (left, right), (top, bottom) = x_range, y_range
    return Rectangle((left, top), right - left, bottom - top, fill=False, linewidth=0)


def _before(axes: "Axes", trial: Trial, step: int, who: str, colour: Colour) -> None:
    """Where one of the two was before this step, dimmed, and the way from there."""
    then, now = trial.places(who)[step - 1], trial.places(who)[step]
    if (then == now).all():
        return
    axes.plot(*np.stack([then, now]).T, color=rgb(colour), linewidth=0.8, linestyle=(0, (2, 1.5)), zorder=3)
    marker = "o" if who == "human" else "s"
    axes.plot(*then, marker=marker, markersize=3.6, color=rgb(colour), alpha=DIMMED, markeredgewidth=0, zorder=3)


def _body(axes: "Axes", trial: Trial, step: int, who: str, colour: Colour, marker: str) -> None:
    place, way = trial.places(who)[step], trial.headings(f"{who}_heading")[step]
    _arrow(axes, place, 1.7 * way, colour, 1.1)
    axes.plot(
        *place, marker=marker, markersize=4.6, color=rgb(colour), markeredgecolor="k", markeredgewidth=0.4, zorder=5
    )


def _away(axes: "Axes", trial: Trial, step: int) -> None:
    """Where the robot is, if it is outside of what is seen."""
    sign = sign_of(trial, step)
    if sign is None:
        return
    tail = sign.place - LENGTH * sign.way
    _arrow(axes, tail, LENGTH * sign.way, ROBOT, 1.1)
    x, y = tail - 0.4 * sign.way
    style: Any = {"fontsize": 4.5, "color": rgb(ROBOT), "zorder": 6, "clip_on": True}
    axes.text(x, y, f"robot, {sign.cells} cells away", ha="right" if sign.way[0] > 0 else "left", va="center", **style)


def _arrow(axes: "Axes", start: npt.NDArray[Any], vector: npt.NDArray[Any], colour: Colour, width: float) -> None:
    arrow = {"arrowstyle": "-|>,head_width=0.13,head_length=0.2", "color": rgb(colour), "linewidth": width}
    axes.annotate(
        "", xy=tuple(start + vector), xytext=tuple(start), arrowprops=arrow | {"shrinkA": 0, "shrinkB": 0}, zorder=4
    )


def _gesture(axes: "Axes", trial: Trial, step: int) -> None:
    """What the robot says, in a bubble."""
    action = int(executed(trial.steps)[step])
    if action not in set(GESTURES):
        return
    x, y = trial.places("robot")[step]
    up = -1 if y > 4 else 1
    bubble = {"boxstyle": "round,pad=0.25", "facecolor": "white", "edgecolor": "k", "linewidth": 0.5}
    axes.annotate(
        GESTURES[Action(action)].capitalize(),
        xy=(x, y + 0.5 * up),
        xytext=(min(max(x, 3.0), trial.size - 3.0), y + 3.0 * up),
        fontsize=5.5,
        ha="center",
        va="center",
        bbox=bubble,
        arrowprops={"arrowstyle": "-", "linewidth": 0.5, "shrinkA": 0, "shrinkB": 0},
        zorder=6,
    )
