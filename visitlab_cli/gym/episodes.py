"""Tasks stepped from outside, one action a call: a record that stays in compiled memory, one lane or many in it.

Each lane is a task of its own, with its scene and its random stream. What is passed at a call is a pointer: the
arrays of a lab and a geometry as arguments would cost more than the step itself.
"""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from numba import types
from numba.experimental import structref

from visitlab_cli.compiled import JIT_DISABLED, array_kernel, written
from visitlab_cli.world.scene import NOWHERE, Scene
from visitlab_cli.world.task import begin_trial, observe, step

Integers = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Told = tuple[int, float, float, bool, int, int, int]
"""State, reward, the reward that the deciding module learns from, whether the time is up, interaction level, the
level that was just reached, the room of the goal that was just reached; -1 for none."""

FIELDS = ("task", "n_actions", "every_goal", "scenes", "randoms", "steps", "rewards")
NO_SUCH_ACTION, NOT_BEGUN = -1, -2
NONE = -1
BEFORE_BEGIN = -1
COLUMN = {name: place for place, name in enumerate(Scene._fields)}
"""Where a field of a scene stands in a row of `scenes`."""
_LEVEL = COLUMN["interaction_level"]

if JIT_DISABLED:

    class Episodes:
        """The same with the compiler switched off."""

        def __init__(self, *values: Any) -> None:
            """With the values of `FIELDS`."""
            vars(self).update(zip(FIELDS, values, strict=True))

else:
    _structref: Any = structref
    _types: Any = types

    @_structref.register
    class _EpisodesType(types.StructRef):
        def preprocess_fields(self, fields: Any) -> Any:
            return tuple((name, _types.unliteral(field)) for name, field in fields)

    class Episodes(structref.StructRefProxy):  # type: ignore[no-redef]
        """`FIELDS` in compiled memory: Python holds a pointer."""

    _structref.define_proxy(Episodes, _EpisodesType, list(FIELDS))


class Memory(NamedTuple):
    """Where each lane stands; a trial that begins follows the scene that is there."""

    scenes: Integers  # shape (lanes, fields of a scene)
    steps: Integers  # shape (lanes,): taken in the trial
    rewards: Floats  # shape (lanes,): of the last step

    @classmethod
    def of(cls, lanes: int) -> "Memory":
        """Of lanes in which nothing has begun."""
        made = cls(np.zeros((lanes, len(COLUMN)), np.int64), np.zeros(lanes, np.int64), np.zeros(lanes))
        made.forget()
        return made

    def forget(self) -> None:
        """Let the next trial of each lane be its first."""
        self.scenes[:] = NOWHERE
        self.steps[:] = BEFORE_BEGIN
        self.rewards[:] = 0


@array_kernel
def _hold(
    task: Any, n_actions: int, every_goal: bool, scenes: Integers, randoms: Any, steps: Integers, rewards: Floats
) -> Any:
    return Episodes(task, n_actions, every_goal, scenes, randoms, steps, rewards)


def episodes_of(task: Any, n_actions: int, every_goal: bool, memory: Memory, randoms: npt.NDArray[np.uint64]) -> Any:
    """Lanes that play `task`.

    Args:
        task: its record.
        n_actions: how many actions there are.
        every_goal: whether each rewarded step reaches another goal; else a goal is reached where rewards begin.
        memory: where they stand, changed in place.
        randoms: shape (lanes, 4), likewise: the streams.
    """
    return _hold(task, n_actions, every_goal, memory.scenes, randoms, memory.steps, memory.rewards)


_read_scene = written(
    "read_scene",
    "scenes, lane",
    [f"return Scene({', '.join(f'{name}=scenes[lane, {place}]' for name, place in COLUMN.items())})"],
    Scene=Scene,
)
_write_scene = written(
    "write_scene", "scenes, lane, scene", [f"scenes[lane, {place}] = scene.{name}" for name, place in COLUMN.items()]
)


@array_kernel
def _begin(episodes: Any, lane: int) -> int:
    """Begin a trial in a lane; its state."""
    scene = begin_trial(episodes.task, _read_scene(episodes.scenes, lane), episodes.randoms[lane])
    _write_scene(episodes.scenes, lane, scene)
    episodes.steps[lane] = 0
    episodes.rewards[lane] = 0.0
    return int(observe(episodes.task, scene))


@array_kernel
def _advance(episodes: Any, lane: int, action: int) -> Told:
    before = _read_scene(episodes.scenes, lane)
    scene, reward, lesson = step(episodes.task, before, action, episodes.randoms[lane])
    _write_scene(episodes.scenes, lane, scene)
    episodes.steps[lane] += 1
    over = bool(episodes.steps[lane] >= episodes.task.trial_steps)
    state, level = int(observe(episodes.task, scene)), int(scene.interaction_level)
    new_level = level if level > before.interaction_level else NONE
    begins = episodes.every_goal or episodes.rewards[lane] == 0.0
    new_goal = int(before.goal_room) if reward > 0.0 and begins else NONE
    episodes.rewards[lane] = reward
    return state, reward, lesson, over, level, new_level, new_goal


@array_kernel
def begin_one(episodes: Any) -> Told:
    """Begin a trial in the first lane: what there is to tell, nothing having been reached."""
    state = _begin(episodes, 0)
    return state, 0.0, 0.0, False, int(episodes.scenes[0, _LEVEL]), NONE, NONE


@array_kernel
def step_one(episodes: Any, action: int) -> Told:
    """A step in the first lane; the state is `NO_SUCH_ACTION` or `NOT_BEGUN` where there can be none."""
    if action < 0 or action >= episodes.n_actions:
        return NO_SUCH_ACTION, 0.0, 0.0, False, NONE, NONE, NONE
    if episodes.steps[0] < 0 or episodes.steps[0] >= episodes.task.trial_steps:
        return NOT_BEGUN, 0.0, 0.0, False, NONE, NONE, NONE
    return _advance(episodes, 0, action)


@array_kernel
def begin_lanes(episodes: Any, states: Integers) -> None:
    """Begin a trial in every lane: `states`, shape (lanes,), is filled."""
    for lane in range(len(states)):
        states[lane] = _begin(episodes, lane)


@array_kernel
def step_lanes(
    episodes: Any,
    actions: Integers,
    states: Integers,
    rewards: Floats,
    lessons: Floats,
    over: npt.NDArray[np.bool_],
    new_levels: Integers,
    new_goals: Integers,
) -> int:
    """A step in every lane; one whose time was up begins its next trial instead, whatever its action.

    All arrays have the shape (lanes,), those after `actions` are filled. A lane with an action that there is not is
    given back, and then nothing was done; -1 where all went well; -2 where nothing had begun.
    """
    for lane in range(len(actions)):
        if actions[lane] < 0 or actions[lane] >= episodes.n_actions:
            return lane
        if episodes.steps[lane] < 0:
            return NOT_BEGUN
    for lane in range(len(actions)):
        if episodes.steps[lane] >= episodes.task.trial_steps:
            states[lane] = _begin(episodes, lane)
            rewards[lane], lessons[lane], over[lane], new_levels[lane], new_goals[lane] = 0.0, 0.0, False, NONE, NONE
        else:
            told = _advance(episodes, lane, actions[lane])
            states[lane], rewards[lane], lessons[lane], over[lane] = told[0], told[1], told[2], told[3]
            new_levels[lane], new_goals[lane] = told[5], told[6]
    return NONE
