"""What is seen of the world: the whole lab, or where the two are, with a sign to a robot outside of it."""

import numpy as np
import numpy.typing as npt

from visitlab_cli.scene.colours import ROBOT
from visitlab_cli.scene.shapes import Arrow, Role, Style, Vectors
from visitlab_cli.scene.trial import Trial

Range = tuple[float, float]
MARGIN = 0.6
LEAST_VIEW = 24.0
INSET, LENGTH = 1.2, 2.4
"""In cells: how far from the edge a sign ends, and its length."""


def view_of(trial: Trial) -> tuple[Range, Range]:
    """What is seen of the world, as ranges of x and y in cells: the whole lab, or where the two are."""
    if trial.has_rooms:
        return (-MARGIN, trial.cols + MARGIN), (-MARGIN, trial.rows + MARGIN)
    places = np.concatenate([trial.places("robot"), trial.places("human")])
    places = places[_together(trial)]
    low, high = places.min(axis=0), places.max(axis=0)
    middle, side = (low + high) / 2, max(LEAST_VIEW, float((high - low).max()) + 8)
    (x, y), half = middle, side / 2
    return (float(x - half), float(x + half)), (float(y - half), float(y + half))


def _together(trial: Trial) -> npt.NDArray[np.bool_]:
    """Which of the robot's places, then the human's, are seen: not those before the robot comes to the human."""
    apart = np.abs(trial.places("robot") - trial.places("human")).max(axis=1)
    return np.concatenate([apart <= LEAST_VIEW / 2, np.ones(trial.length, np.bool_)])


def sign_to(robot: Vectors, human: Vectors, view: tuple[Range, Range]) -> Arrow | None:
    """An arrow at the edge of a view to a robot outside of it, its text how many cells it is away from the human.

    None where the robot is seen, as it always is in the lab.
    """
    low, high = np.array(view, np.float32).T
    if ((low <= robot) & (robot <= high)).all():
        return None
    towards = robot - human
    ends = np.where(towards > 0, high - INSET, low + INSET) - human
    shares = np.divide(ends, towards, out=np.full(2, np.inf, np.float32), where=towards != 0)
    way = towards / np.linalg.norm(towards)
    end = human + towards * max(float(shares.min()), 0.0)
    return Arrow(Role.AWAY, end - LENGTH * way, end, Style(ROBOT, 0.24), f"robot, {int(abs(towards).max())} cells away")
