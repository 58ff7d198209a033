"""An episode so far, kept to be drawn by what draws recorded trials: a picture, a line of words, the viewer."""

from pathlib import Path
from typing import Any

import numpy as np

from visitlab_cli.gym.episodes import COLUMN, Told
from visitlab_cli.gym.places import Place
from visitlab_cli.replay.blueprint import FRAMES_PER_SECOND as REPLAYED
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import LEVEL_NAMES, Steps, caption, direction_name, room_name
from visitlab_cli.world.columns import DTYPES

PICTURE, WORDS, VIEWER = "rgb_array", "ansi", "human"
RENDER_MODES = [VIEWER, PICTURE, WORDS]
FRAMES_PER_SECOND = int(REPLAYED)


class Rendering:
    """What has happened in the episode, and how it is shown."""

    def __init__(self, place: Place, mode: str) -> None:
        """Nothing has happened yet; the viewer is opened.

        Raises:
            UsageError: there is no display for the viewer.
        """
        self._place, self._mode = place, mode
        self._number = -1
        self._rows: list[dict[str, Any]] = []
        self._live: Any = None
        if mode == VIEWER:
            from visitlab_cli.replay.live import Live

            self._live = Live('use render_mode="rgb_array" or "ansi" instead')

    def add(self, told: Told, action: int, scene: list[int], *, first: bool) -> None:
        """A step, or the start of another episode, after which the scene is this."""
        if first:
            self._number, self._rows = self._number + 1, []
        row: dict[str, Any] = {name: scene[place] for name, place in COLUMN.items()}
        row |= {"trial": self._number, "step": len(self._rows), "state": told[0], "action": action, "explored": False}
        self._rows.append(row | {"reward": told[1], "social_reward": told[2]})
        if self._live is not None:
            self._live.show(self.trial())

    def trial(self) -> Trial:
        """The episode so far as a trial."""
        place = self._place
        steps: Steps = {
            column.name: np.array([row[column.name] for row in self._rows], DTYPES[column.kind])
            for column in place.task.columns
        }
        name, number = f"visitlab/{place.task.name}", max(self._number, 0)
        return Trial(Path(), name, place.task.name, number, steps, place.lab, place.distances, arena=place.arena)

    def frame(self) -> Any:
        """As the mode says; None where the viewer shows it, or no episode has begun."""
        if not self._rows or self._mode == VIEWER:
            return None
        if self._mode == WORDS:
            return in_a_line(self.trial())
        from visitlab_cli.replay.frame import frame

        return frame(self.trial())

    def close(self) -> None:
        """Close the viewer."""
        if self._live is not None:
            self._live.close()


def in_a_line(trial: Trial) -> str:
    """The last step in words: what is aimed at, what happened, how it stands, and what it brought."""
    steps, last = trial.steps, trial.last_step
    parts = [f"step {last}"]
    if trial.has_goal:
        parts.append(f"goal {room_name(trial.lab, int(steps['goal_room'][last]))}")
    if trial.has_engagement:
        parts.append(f"towards {direction_name(int(steps['desired_direction'][last]))}")
    if trial.has_human:
        parts.append(LEVEL_NAMES[int(steps["interaction_level"][last])])
    parts.append(f"reward {steps['reward'][last]:g}")
    return f"{', '.join(parts)}: {caption(steps, last, trial.lab)}"
