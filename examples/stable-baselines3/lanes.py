"""The compiled lanes of `visitlab/Social-v0` as Stable-Baselines3 has environments: its VecEnv, trial by trial."""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from stable_baselines3.common.vec_env import VecEnv

import visitlab_cli.gym  # noqa: F401  registers them

PARTS = (8, 5, 8, 8)
"""How many interaction levels, distances, desired directions and angles there are: a state is one of each."""


class SocialLanes(VecEnv):
    """`lanes` robots, each with a human of its own, in one compiled loop.

    An observation is the state that visitlab's agents see, in its four parts, which Stable-Baselines3 encodes one-hot,
    as 29 inputs; `whole`: as one number, which it encodes as 2,560 inputs. `trials` has the rewards of the finished
    trials in the order of time, an array of shape (lanes,) for each round of trials.
    """

    def __init__(self, human: str, lanes: int, seed: int, *, whole: bool = False) -> None:
        self._lanes = gymnasium.make_vec("visitlab/Social-v0", num_envs=lanes, human=human)
        self._seed = lanes * seed  # lane i has the seed + i: no two of our seeds share one
        self._actions = self._rewards = np.zeros(lanes)
        self.trials: list[np.ndarray] = []
        self.render_mode = None
        self._seen = np.asarray if whole else parts_of
        space = self._lanes.single_observation_space if whole else spaces.MultiDiscrete(PARTS)
        super().__init__(lanes, space, self._lanes.single_action_space)

    def reset(self) -> np.ndarray:
        """Begin a trial in every lane."""
        states, _ = self._lanes.reset(seed=self._seed)
        self._rewards = np.zeros(self.num_envs)
        return self._seen(states)

    def step_async(self, actions: np.ndarray) -> None:
        """Say what each robot does."""
        self._actions = actions

    def step_wait(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[dict[str, Any]]]:
        """Do it. All trials are equally long, so all end together; the next begin at once, as a VecEnv's must."""
        states, rewards, _, over, _ = self._lanes.step(self._actions)
        self._rewards += rewards
        observations = self._seen(states)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        if over.all():
            # The trial is over, but not the task: what comes after is to be estimated, not taken for nothing.
            infos = [{"TimeLimit.truncated": True, "terminal_observation": last} for last in observations]
            self.trials.append(self._rewards)
            self._rewards = np.zeros(self.num_envs)
            states, *_ = self._lanes.step(self._actions)  # begins the next trials, whatever the actions
            observations = self._seen(states)
        return observations, rewards.astype(np.float32), over, infos

    def close(self) -> None:
        """There is nothing to close."""
        self._lanes.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The same of every lane."""
        return [getattr(self, attr_name)] * self.num_envs

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refused: lanes have no attributes of their own."""
        raise NotImplementedError("lanes have no attributes of their own")

    def env_method(self, method_name: str, *args: Any, indices: Any = None, **kwargs: Any) -> list[Any]:
        """Refused: lanes are no objects."""
        raise NotImplementedError("lanes are no objects")

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """None is."""
        return [False] * self.num_envs


def parts_of(states: np.ndarray) -> np.ndarray:
    """Level, distance, direction and angle of states, shape (lanes, 4); see docs/environments/social.md."""
    return np.stack(np.unravel_index(states, PARTS, order="F"), axis=1)
