"""Many environments of one task in one compiled loop: `gymnasium.make_vec("visitlab/Social-v0", num_envs=1024)`.

Lane i is, step for step, the environment that is seeded with `seed + i`.
"""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt
from gymnasium import spaces
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from visitlab_cli.errors import UsageError
from visitlab_cli.gym.episodes import NONE, NOT_BEGUN, Memory, begin_lanes, episodes_of, step_lanes
from visitlab_cli.gym.informing import LESSON, NEW_GOAL, NEW_LEVEL, Informing
from visitlab_cli.gym.observations import ALL, STATE, observation_of
from visitlab_cli.gym.places import PLACES
from visitlab_cli.gym.streams import WORDS, derived
from visitlab_cli.whole_number import whole_number
from visitlab_cli.wording import shown
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT

Array = npt.NDArray[Any]


class Lanes(VectorEnv[Any, Array, Array]):
    """`num_envs` lanes of a task; all else as `Environment` says, but that it is not rendered.

    A lane whose time is up begins its next episode with the next step, whatever its action (`AutoresetMode.NEXT_STEP`).

    Raises:
        UsageError: a setting is wrong.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # type: ignore[misc]
    task: ClassVar[str]

    def __init__(
        self,
        num_envs: int = 1,
        *,
        observation: str = STATE,
        full_info: bool = False,
        render_mode: str | None = None,
        **settings: Any,
    ) -> None:
        if render_mode is not None:
            raise UsageError('lanes are not rendered: gymnasium.make_vec(..., vectorization_mode="sync") renders each')
        number = whole_number(num_envs)
        if number is None or number < 1:
            raise UsageError(f"num_envs={shown(num_envs)}: must be a whole number, at least 1")
        self.num_envs = num_envs = number
        place = PLACES[self.task](**settings)
        self._n_actions = n_actions = place.task.size(place.world).n_actions
        self._observation = observation_of(observation, place.task, place.world)
        self._informing = Informing(place.task, full_info=full_info)
        self.single_observation_space = self._observation.space
        self.single_action_space = spaces.Discrete(n_actions)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._memory = Memory.of(num_envs)
        self._randoms = np.zeros((num_envs, WORDS), np.uint64)
        self._episodes = episodes_of(place.record, n_actions, place.task.counts_goals, self._memory, self._randoms)
        self._seed(None)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode in every lane.

        Args:
            seed: lane i is seeded with `seed + i`, or with the i-th of several. Left out: the streams go on.
            options: there are none for lanes.

        Raises:
            UsageError: as many seeds as lanes are needed, or there is an option.
        """
        if options:
            raise UsageError(f"reset: no option {next(iter(options))!r} for lanes")
        if seed is not None:
            self._seed(seed)
            self._memory.forget()
        states = np.zeros(self.num_envs, np.int64)
        begin_lanes(self._episodes, states)
        nothing, lessons = np.full(self.num_envs, NONE), np.zeros(self.num_envs)
        return self._seen(states, lessons, nothing, nothing.copy())

    def step(self, actions: npt.ArrayLike) -> tuple[Any, Array, Array, Array, dict[str, Any]]:
        """Take an action in every lane, shape (lanes,).

        Raises:
            gymnasium.error.InvalidAction: there is no such action in a lane, or there are not as many as lanes.
            gymnasium.error.ResetNeeded: no episode has begun.
        """
        chosen = np.asarray(actions)
        if chosen.shape != (self.num_envs,) or chosen.dtype.kind not in "iu":
            raise InvalidAction(f"actions must be {self.num_envs} whole numbers, not {chosen.dtype} of {chosen.shape}")
        lanes = self.num_envs
        states, rewards, lessons = np.empty(lanes, np.int64), np.empty(lanes), np.empty(lanes)
        over, new_levels, new_goals = np.empty(lanes, np.bool_), np.empty(lanes, np.int64), np.empty(lanes, np.int64)
        whole = np.ascontiguousarray(chosen, np.int64)
        wrong = step_lanes(self._episodes, whole, states, rewards, lessons, over, new_levels, new_goals)
        if wrong == NOT_BEGUN:
            raise ResetNeeded("no episode has begun: call reset() first")
        if wrong != NONE:
            raise InvalidAction(f"lane {wrong}: action {chosen[wrong]}: must be from 0 to {self._n_actions - 1}")
        seen, info = self._seen(states, lessons, new_levels, new_goals)
        return seen, rewards, np.zeros(lanes, np.bool_), over, info

    def _seen(self, states: Array, lessons: Array, new_levels: Array, new_goals: Array) -> tuple[Any, dict[str, Any]]:
        scenes = self._memory.scenes
        told = {LESSON: lessons, NEW_LEVEL: new_levels, NEW_GOAL: new_goals}
        return self._observation.of(states, scenes, ALL), self._informing.of_all(told, scenes)

    def _seed(self, seed: int | Sequence[int | None] | None) -> None:
        if isinstance(seed, int | np.integer):
            self._np_random_seed = int(seed)
            seeds: Sequence[int | None] = [int(seed) + lane for lane in range(self.num_envs)]
        elif seed is None:
            seeds = [None] * self.num_envs
        else:
            seeds = list(seed)
        if len(seeds) != self.num_envs:
            raise UsageError(f"reset: {len(seeds)} seeds for {self.num_envs} lanes")
        for lane, own in enumerate(seeds):
            self._randoms[lane] = derived(seeding.np_random(own)[0])


class NavigationLanes(Lanes):
    """Of `NavigationEnv`."""

    task = NAVIGATION


class GoToHumanLanes(Lanes):
    """Of `GoToHumanEnv`."""

    task = GO_TO_HUMAN


class SocialLanes(Lanes):
    """Of `SocialEnv`."""

    task = SOCIAL


class VisitLanes(Lanes):
    """Of `VisitEnv`."""

    task = VISIT
