"""A task as a Gymnasium environment, and its compiled step's way to Python."""

import copy
from operator import index
from typing import Any, ClassVar

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.error import InvalidAction, ResetNeeded

from visitlab_cli.errors import UsageError
from visitlab_cli.execution.cell_runner import STREAM
from visitlab_cli.gym.episodes import NO_SUCH_ACTION, Memory, Told, begin_one, episodes_of, step_one
from visitlab_cli.gym.informing import Informing
from visitlab_cli.gym.observations import ONE, STATE, observation_of
from visitlab_cli.gym.places import PLACES
from visitlab_cli.gym.rendering import FRAMES_PER_SECOND, RENDER_MODES, Rendering
from visitlab_cli.gym.streams import WORDS, derived
from visitlab_cli.plan.cells import is_cell
from visitlab_cli.random_numbers import RandomState, random_state
from visitlab_cli.wording import or_else, shown
from visitlab_cli.world.enums import Action
from visitlab_cli.world.lab import Lab

CELL = "cell"
OPTIONS = (CELL,)


class Environment(gymnasium.Env[Any, int]):
    """One of the tasks; `docs/environments` has a page for each.

    Args:
        observation: `state`, the number of the task's state, or `dict`, the scene in its parts.
        full_info: whether `info` has the whole scene.
        render_mode: `rgb_array`, `ansi` or `human`.
        settings: of the task; see `NavigationEnv`, `GoToHumanEnv`, `SocialEnv`, `VisitEnv`.

    Raises:
        UsageError: a setting is wrong.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": RENDER_MODES, "render_fps": FRAMES_PER_SECOND}  # type: ignore[misc]
    task: ClassVar[str]

    def __init__(
        self, *, observation: str = STATE, full_info: bool = False, render_mode: str | None = None, **settings: Any
    ) -> None:
        if render_mode is not None and render_mode not in RENDER_MODES:
            raise UsageError(f"render_mode={render_mode!r}: there is none{or_else(str(render_mode), RENDER_MODES)}")
        self.render_mode = render_mode
        self._place = place = PLACES[self.task](**settings)
        self._observation = observation_of(observation, place.task, place.world)
        self._informing = Informing(place.task, full_info=full_info)
        self.observation_space = self._observation.space
        self._n_actions = place.task.size(place.world).n_actions
        self.action_space: spaces.Space[Any] = spaces.Discrete(self._n_actions)
        self._memory = Memory.of(1)
        self._rendering = None if render_mode is None else Rendering(place, render_mode)
        self.random_words = np.zeros(WORDS, np.uint64)
        """The stream of the rules as kernels take it, shape (4,), changed in place; visitlab's own agents share it."""
        self._derived_from: np.random.Generator | None = None
        self._hold()

    def _hold(self) -> None:
        task, record, randoms = self._place.task, self._place.record, self.random_words[None]
        self._episodes = episodes_of(record, self._n_actions, task.counts_goals, self._memory, randoms)

    @property
    def lab(self) -> Lab:
        """The world in which the two move."""
        return self._place.world

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: of the stream; the episode is then the first, which follows none. Left out: the stream goes on, and
                so does what carries over from an episode to the next.
            options: `cell`, the path of a cell of a run: `seed` is its config's, and the stream the cell's own.

        Raises:
            UsageError: there is no such option, no cell is called so, or there is a cell without a seed.
        """
        cell = _cell_in(options)
        if cell is not None and seed is None:
            raise UsageError("reset: a cell's stream needs its config's seed too, as in reset(seed=0, options=...)")
        super().reset(seed=seed)
        if self.np_random is not self._derived_from:
            self._derived_from = self.np_random
            self.random_words[:] = _stream(self.np_random, seed, cell)
            self._memory.forget()
        told = begin_one(self._episodes)
        return self._seen(told, Action.NO_ACTION.value, first=True)

    def step(self, action: int) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Take an action, a number of `visitlab_cli.Action`.

        Raises:
            gymnasium.error.InvalidAction: there is no such action.
            gymnasium.error.ResetNeeded: no episode has begun, or its time is up.
        """
        try:
            told = step_one(self._episodes, index(action))
        except TypeError:
            raise self._refused(NO_SUCH_ACTION, action) from None
        if told[0] < 0:
            raise self._refused(told[0], action)
        seen, info = self._seen(told, action)
        return seen, told[1], False, told[3], info

    def _seen(self, told: Told, action: int, *, first: bool = False) -> tuple[Any, dict[str, Any]]:
        scenes = self._memory.scenes
        if self._rendering is not None:
            self._rendering.add(told, int(action), scenes[ONE].tolist(), first=first)
        return self._observation.of(told[0], scenes, ONE), self._informing.of_one(told, scenes)

    def _refused(self, why: int, action: Any) -> Exception:
        if why == NO_SUCH_ACTION:
            return InvalidAction(f"action {action}: must be from 0 to {self._n_actions - 1}")
        return ResetNeeded("no episode has begun, or its time is up: call reset() first")

    def render(self) -> Any:
        """A picture of shape (height, width, 3), or a line of text; in the mode `human` the viewer has it already."""
        if self._rendering is None:
            gymnasium.logger.warn(f"nothing is rendered without a render_mode: choose one of {', '.join(RENDER_MODES)}")
            return None
        return self._rendering.frame()

    def close(self) -> None:
        """End the viewer, if there is one."""
        if self._rendering is not None:
            self._rendering.close()

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        memo[id(self._place)] = self._place  # nothing in it changes
        other = type(self).__new__(type(self))
        memo[id(self)] = other
        other.__setstate__(copy.deepcopy(self.__getstate__(), memo))
        return other

    def __getstate__(self) -> dict[str, Any]:
        """All of it but what lies in compiled memory, which is made again; so a copy has the same future."""
        return {name: value for name, value in vars(self).items() if name != "_episodes"}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._hold()


def _stream(generator: np.random.Generator, seed: int | None, cell: str | None) -> RandomState:
    return derived(generator) if cell is None or seed is None else random_state(seed, cell, STREAM)


def _cell_in(options: dict[str, Any] | None) -> str | None:
    for name in options or {}:
        if name not in OPTIONS:
            raise UsageError(f"reset: no option {name!r}{or_else(str(name), OPTIONS)}")
    cell = (options or {}).get(CELL)
    if cell is not None and not (isinstance(cell, str) and is_cell(cell)):
        raise UsageError(f"reset: cell={shown(cell)}: must be a cell's path, such as social/mb/human_2/seed-0000")
    return cell
