"""Compares a picture of the viewer with what the log says: where the goal room's and the robot's colours are."""

import numpy as np
from PIL import Image

from visitlab_cli.scene.colours import FLOOR, GOAL_FLOOR, HUMAN, ROBOT, WALL
from visitlab_cli.scene.sight import REACH
from visitlab_cli.scene.words import GESTURES

LIKE = 14
"""Largest difference of a channel from a colour, for what is drawn on a screen with smooth edges."""


SEEN_SIDE = 8 - 2 * 0.06
"""Cells of a room's side between its walls."""


class Scene:
    """The scene in a picture of the viewer, found by the goal room, which must not be hidden at its edges."""

    def __init__(self, picture, goal_room):
        self.pixels = np.asarray(Image.open(picture).convert("RGB")).astype(int)
        left_half = self.pixels[:, : self.pixels.shape[1] // 2]
        rows, cols = np.nonzero(_like(left_half, GOAL_FLOOR))
        assert len(rows), "the goal room's colour is nowhere"
        top, bottom = np.percentile(rows, [0.1, 99.9])
        left, right = np.percentile(cols, [0.1, 99.9])
        self.cell = (bottom - top + 1) / SEEN_SIDE
        assert abs((right - left + 1) / SEEN_SIDE - self.cell) < 0.03 * self.cell, "the goal room is no square"
        middle = np.array([top + bottom, left + right]) / 2
        self.origin = middle - (8 * np.array(divmod(goal_room, 3)) + 4) * self.cell

    def around(self, row, col, reach):
        """The pixels within `reach` cells of a place, given in cells."""
        middle = self.origin + np.array([row, col]) * self.cell
        low, high = ((middle + side * reach * self.cell).round().astype(int) for side in (-1, 1))
        assert (low >= 0).all(), f"{row}, {col} is not in the picture"
        return self.pixels[low[0] : high[0] + 1, low[1] : high[1] + 1].reshape(-1, 3)

    def share(self, row, col, reach, colour):
        """The share of those pixels that are like `colour`."""
        return _like(self.around(row, col, reach), colour).mean()


def _like(pixels, colour):
    return (abs(pixels - np.array(colour)) <= LIKE).all(axis=-1)


def goal_is_in_sight(trial, step):
    """Whether nothing is drawn over the goal room: the human does not look there, the robot is not there."""
    steps = trial.steps
    corner = 8 * np.array(divmod(int(steps["goal_room"][step]), 3))
    cells = corner + np.stack(np.mgrid[0:8, 0:8], axis=-1).reshape(-1, 2)
    human, robot = (np.array([steps[f"{who}_row"][step], steps[f"{who}_col"][step]], int) for who in ("human", "robot"))
    look = trial.headings("human_heading")[step][::-1]
    looked_at = ((cells - human) @ look > -0.5) & (abs(cells - human).max(axis=1) <= REACH)
    near = abs(cells - robot).max(axis=1).min() < 3 or abs(cells - human).max(axis=1).min() < 4
    return not (looked_at.any() or near or steps["action"][step] in GESTURES or steps["reward"][step] > 0)


def assert_shows(picture, steps, step):
    """The goal room and the two are where the log says, and nowhere else."""
    scene = Scene(picture, int(steps["goal_room"][step]))
    for corner in ((0, 0), (0, 24), (24, 0), (24, 24), (8, 8), (16, 8)):
        assert scene.share(*corner, 0.1, WALL) > 0.2, f"no corner of a room at {corner}"
    assert scene.share(-0.3, 12, 0.1, FLOOR) == 1, "the lab ends at row 0"
    places = {who: [int(steps[f"{who}_{axis}"][step]) for axis in ("row", "col")] for who in ("robot", "human")}
    for who, colour in (("robot", ROBOT), ("human", HUMAN)):
        row, col = places[who]
        assert scene.share(row + 0.5, col + 0.5, 0.45, colour) > 0.2, f"the {who} is not in its cell"
    crowd = np.array(list(places.values()))
    for row, col in np.ndindex(24, 24):
        if abs(crowd - [row, col]).max(axis=1).min() > 3:
            assert scene.share(row + 0.5, col + 0.5, 0.4, ROBOT) < 0.2, f"a second robot at {row}, {col}"
