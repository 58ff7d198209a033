"""What `info` has: the interaction level, what was just reached, on demand the whole scene; of one lane or of all."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import UsageError
from visitlab_cli.gym.episodes import COLUMN, Integers, Told
from visitlab_cli.gym.observations import ALL, ONE
from visitlab_cli.wording import shown
from visitlab_cli.world.columns import ENGAGEMENT, GOAL, HUMAN, MODULES
from visitlab_cli.world.tasks import Task

LESSON, LEVEL, NEW_LEVEL, NEW_GOAL = "social_reward", "interaction_level", "level_reached", "goal_reached"
TOLD = {LESSON: (2, MODULES), LEVEL: (4, HUMAN), NEW_LEVEL: (5, HUMAN), NEW_GOAL: (6, GOAL)}
"""Where each stands in what a step tells, and the part of a task that it is told of."""


class Informing:
    """Makes the `info` of a task."""

    def __init__(self, task: Task, *, full_info: bool) -> None:
        """With the whole scene, if that is wanted.

        Raises:
            UsageError: it is not said whether.
        """
        if not isinstance(full_info, bool | np.bool_):
            raise UsageError(f"full_info={shown(full_info)}: must be True or False")
        self._told = [(name, place) for name, (place, part) in TOLD.items() if task.has(part)]
        names = [column.name for column in task.columns if full_info and column.name in COLUMN and column.name != LEVEL]
        names += ["engagement"] if full_info and task.has(ENGAGEMENT) else []
        self._scene = [(name, COLUMN[name]) for name in names]

    def of_one(self, told: Told, scenes: Integers) -> dict[str, Any]:
        """Of an environment that is alone."""
        info: dict[str, Any] = {name: told[place] for name, place in self._told}
        if self._scene:
            scene = scenes[ONE].tolist()
            info.update((name, scene[place]) for name, place in self._scene)
        return info

    def of_all(self, told: Mapping[str, npt.NDArray[Any]], scenes: Integers) -> dict[str, Any]:
        """Of all lanes: arrays of shape (lanes,), and for each, as Gymnasium has it, which lanes told it: every one."""
        info: dict[str, Any] = {name: told[name] for name, _ in self._told if name != LEVEL}
        levels = [(LEVEL, COLUMN[LEVEL])] if any(name == LEVEL for name, _ in self._told) else []
        info.update((name, scenes[ALL, place].copy()) for name, place in [*levels, *self._scene])
        return info | {f"_{name}": np.ones(len(scenes), np.bool_) for name in info}
