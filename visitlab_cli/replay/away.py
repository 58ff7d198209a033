"""Where the robot is while it is outside of what is seen: a sign at the edge, as a social trial begins."""

from typing import NamedTuple

import numpy as np

from visitlab_cli.replay.blueprint import view_of
from visitlab_cli.replay.lettering import strokes
from visitlab_cli.replay.stage import Line, Stage
from visitlab_cli.replay.trial import Trial, Vectors
from visitlab_cli.story import ROBOT

INSET, LENGTH, HEIGHT = 1.2, 2.4, 1.1
"""In cells: how far from the edge a sign ends, its arrow's length, the height of its number."""
ORDER = 40.0


class Sign(NamedTuple):
    """An arrow that ends at `place` and points along `way`, a unit vector, to a robot `cells` away from the human."""

    place: Vectors
    way: Vectors
    cells: int


def sign_of(trial: Trial, step: int) -> Sign | None:
    """The sign of a step; None where the robot is seen, as it always is in the lab."""
    if trial.has_rooms:
        return None
    low, high = np.array(view_of(trial), np.float32).T
    robot, human = trial.places("robot")[step], trial.places("human")[step]
    if ((low <= robot) & (robot <= high)).all():
        return None
    towards = robot - human
    ends = np.where(towards > 0, high - INSET, low + INSET) - human
    shares = np.divide(ends, towards, out=np.full(2, np.inf, np.float32), where=towards != 0)
    way = towards / np.linalg.norm(towards)
    return Sign(human + towards * max(float(shares.min()), 0.0), way, int(abs(towards).max()))


def draw_signs(stage: Stage) -> None:
    """The signs of a trial in the viewer's scene: an arrow in the robot's colour, and how many cells away it is."""
    signs = [sign_of(stage.trial, step) for step in range(stage.trial.length)]
    stage.lines("robot/away", [_lines(sign) if sign else [] for sign in signs], ORDER)


def _lines(sign: Sign) -> list[Line]:
    tail = sign.place - LENGTH * sign.way
    aside = np.array([-sign.way[1], sign.way[0]], np.float32)
    head = [sign.place - 0.8 * sign.way + side * 0.6 * aside for side in (-1, 1)]
    arrow = np.stack([tail, sign.place]), np.stack([head[0], sign.place, head[1]])
    middle = tail - 1.6 * sign.way
    number = strokes(str(sign.cells), (float(middle[0]), float(middle[1])), HEIGHT)
    return [Line(points.astype(np.float32), 0.12, ROBOT) for points in (*arrow, *number)]
