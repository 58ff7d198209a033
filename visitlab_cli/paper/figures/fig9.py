"""Fig. 9: which trial of a run tells the story best; the strip itself is drawn by whoever can."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from visitlab_cli.config.experiment import lab_of
from visitlab_cli.errors import NotFoundError
from visitlab_cli.log.reader import read_steps
from visitlab_cli.paper.figures.source import Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.scene.moments import BEGAN_THERE, FACTS, REACHED, moments, strip_steps
from visitlab_cli.scene.words import Steps
from visitlab_cli.storage.cell_folder import STEPS
from visitlab_cli.world.lab import Lab

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GROUP = "visit/human_2"
Strip = Callable[[Path, int], "Figure"]
"""Draws a trial of a log as a strip."""


def draw_fig9(source: Source, strip: Strip) -> Drawing:
    """An interaction between the robot and human 2, from the first cell."""
    group = source.groups.get(GROUP)
    if group is None:
        return Drawing(None, [f"without {GROUP}: not in this run"])
    log = source.run / group.cells[0].path / STEPS
    if not log.is_file():
        return Drawing(None, [f"{group.cells[0].path} has no log, the config records no steps"])
    trial = telling_trial(log, lab_of(group.cells[0].settings))
    figure = strip(log, trial)
    return Drawing(figure, [f"shows {group.cells[0].path}, trial {trial}"])


def telling_trial(log: Path, lab: Lab) -> int:
    """The recorded trial whose strip shows most kinds of moment, of these most goals, of these the first.

    Raises:
        NotFoundError: the log holds no trial.
    """
    steps = read_steps(log)
    if not len(steps["trial"]):
        raise NotFoundError(f"{log}: the log holds no trial")
    starts = np.flatnonzero(steps["step"] == 0)
    parts = [np.split(column, starts[1:]) for column in steps.values()]
    trials: list[Steps] = [dict(zip(steps, part, strict=True)) for part in zip(*parts, strict=True)]
    return int(max(trials, key=lambda steps: _told(steps, lab))["trial"][0])


def _told(steps: Steps, lab: Lab) -> tuple[int, int]:
    """How many kinds of moment the strip of a trial shows, and how many goals."""
    shown = set(strip_steps(steps, lab))
    kinds = [moment.kind for moment in moments(steps, lab) if moment.step in shown]
    return len(set(kinds) & set(FACTS)), kinds.count(REACHED) + kinds.count(BEGAN_THERE)
