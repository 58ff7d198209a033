"""What an environment's agent observes: the task's state, or a scene in its parts; for one lane or many."""

from typing import Any, NamedTuple

import numpy as np
from gymnasium import spaces

from visitlab_cli.errors import UsageError
from visitlab_cli.gym.episodes import COLUMN, Integers
from visitlab_cli.wording import or_else
from visitlab_cli.world.columns import ENGAGEMENT, GOAL, HUMAN
from visitlab_cli.world.enums import N_DIRECTIONS, N_DISTANCES, N_LEVELS
from visitlab_cli.world.lab import Lab
from visitlab_cli.world.tasks import Task

STATE, DICT = KINDS = ("state", "dict")
ONE: Any = 0
"""The place of the scene of an environment that is alone; that of all lanes is `ALL`."""
ALL: Any = slice(None)

Scenes = Integers
"""Shape (lanes, fields of a scene)."""


class Observation(NamedTuple):
    """The space of what is observed, and of its parts the columns of a scene; of a state, which has none, None."""

    space: "spaces.Space[Any]"
    columns: dict[str, int | list[int]] | None = None

    def of(self, state: Any, scenes: Scenes, whose: Any) -> Any:
        """What is observed of states and scenes, and whose, `ONE` or `ALL`; it shares nothing with what is given.

        Of `ALL`, states have the shape (lanes,), and so has what is observed.
        """
        if self.columns is None:
            return state
        return {name: scenes[whose, places].copy() for name, places in self.columns.items()}


class _Part(NamedTuple):
    space: "spaces.Space[Any]"
    columns: int | list[int]


def observation_of(kind: str, task: Task, lab: Lab) -> Observation:
    """What is observed in a task in `lab`, by the word that says how.

    Raises:
        UsageError: there is no such word.
    """
    if kind == STATE:
        return Observation(spaces.Discrete(task.size(lab).n_states))
    if kind != DICT:
        raise UsageError(f"observation={kind!r}: there is none{or_else(str(kind), KINDS)}")
    parts = _parts(task, lab)
    space = spaces.Dict({name: part.space for name, part in parts.items()})
    return Observation(space, {name: part.columns for name, part in parts.items()})


def _parts(task: Task, lab: Lab) -> dict[str, _Part]:
    """What there is in a scene of a task; together it is all that decides how it goes on, but for the time left."""
    directions = spaces.Discrete(N_DIRECTIONS)
    parts: dict[str, _Part] = {}
    who = ["robot"]
    if task.has(HUMAN):
        who.append("human")
        parts["level"] = _Part(spaces.Discrete(N_LEVELS), COLUMN["interaction_level"])
        parts["distance"] = _Part(spaces.Discrete(N_DISTANCES), COLUMN["distance"])
        parts["angle"] = _Part(directions, COLUMN["angle"])
    if task.has(ENGAGEMENT):
        parts["direction"] = _Part(directions, COLUMN["desired_direction"])
    if task.has(GOAL):
        parts["goal_room"] = _Part(spaces.Discrete(lab.n_rooms), COLUMN["goal_room"])
    if task.has(HUMAN):
        headings = [COLUMN[f"{each}_heading"] for each in who]
        parts["headings"] = _Part(spaces.MultiDiscrete([N_DIRECTIONS] * len(who)), headings)
    cells = [COLUMN[f"{each}_{axis}"] for each in who for axis in ("row", "col")]
    highest = np.array([lab.rows - 1, lab.cols - 1] * len(who))
    parts["cells"] = _Part(spaces.Box(np.zeros_like(highest), highest, dtype=np.int64), cells)
    return parts
