"""Python's way to play a task: `visitlab_cli.make_task`, by the same rules that a run is simulated with."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from visitlab_cli.config.experiment import Site, lab_of
from visitlab_cli.config.one_task import one_task, q_table
from visitlab_cli.errors import UsageError
from visitlab_cli.random_numbers import RandomState, random_state
from visitlab_cli.whole_number import whole_number
from visitlab_cli.wording import or_else, printable, shown
from visitlab_cli.world.columns import ENGAGEMENT
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.scene import NOWHERE, Scene
from visitlab_cli.world.task import begin_trial, observe, step
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, TASKS, VISIT, Task

SETTINGS = {
    NAVIGATION: ("trial_steps",),
    GO_TO_HUMAN: ("trial_steps", "success"),
    SOCIAL: ("trial_steps", "arena", "direction_change"),
    VISIT: ("trial_steps", "goal_rooms"),
}
"""What an experiment may be told that changes the task itself."""


@dataclass(frozen=True)
class PlayableTask:
    """A task that is played from Python, one step at a time; it holds no state, so that one serves many trials.

    `record` is what kernels take: `visitlab_cli.world.task` has `begin_trial`, `step` and `observe` of it, which these
    methods call and a kernel of yours may call, too, at the speed of a run.
    """

    about: Task
    record: Any
    n_states: int
    n_actions: int
    trial_steps: int

    def random(self, seed: int) -> RandomState:
        """A stream of random numbers, which the other methods draw from and so change: shape (4,).

        Raises:
            UsageError: `seed` is no whole number from 0.
        """
        root = whole_number(seed)
        if root is None or root < 0:
            raise UsageError(f"seed {shown(seed)}: must be a whole number, at least 0")
        return random_state(root, "task", self.about.name)

    def begin(self, random: RandomState, last: Scene = NOWHERE) -> Scene:
        """The scene that a trial begins in; a visit carries goal room and direction over from the `last` trial's."""
        scene: Scene = begin_trial(self.record, last, random)
        return scene

    def step(self, scene: Scene, action: int, random: RandomState) -> tuple[Scene, float]:
        """The scene after an action of the robot, 0..n_actions-1, and the task's reward.

        Raises:
            UsageError: there is no such action.
        """
        number = whole_number(action)
        if number is None or not 0 <= number < self.n_actions:
            raise UsageError(f"action {printable(str(action))}: {self.about.name} has 0 to {self.n_actions - 1}")
        after, reward, _ = step(self.record, scene, number, random)
        return after, float(reward)

    def observe(self, scene: Scene) -> int:
        """The state, 0..n_states-1, that an agent sees of a scene."""
        return int(observe(self.record, scene))


def make_task(
    task: str,
    *,
    human: Mapping[str, Any] | None = None,
    lab: Mapping[str, Any] | str | None = None,
    distances: Sequence[int] = DISTANCES,
    tables: Mapping[str, npt.ArrayLike] | None = None,
    **settings: Any,
) -> PlayableTask:
    """Make a task of plain values, as an experiment of a config has them: `make_task("social", human={...})`.

    Args:
        task: `navigation`, `go_to_human`, `social` or `visit`.
        human: in social and visit whom the robot meets, as under `humans` in a config.
        lab: but for social where it takes place: as under `labs` in a config, or a map; the paper's unless given.
        distances: the four thresholds of the categories of distance, in cells.
        tables: in a visit the `q` of its modules `navigation` and `go_to_human`, of shape (states, actions).
        settings: `trial_steps`; of go_to_human `success`, of social `arena` and `direction_change`, of a visit
            `goal_rooms`.

    Raises:
        UsageError: there is no such task, or a setting is missing, unknown or wrong; a line for each.
    """
    if not isinstance(task, str) or task not in TASKS:
        raise UsageError(f"{task}: no such task{or_else(task, list(TASKS))}")
    about = TASKS[task]
    if about.has(ENGAGEMENT) != (human is not None):
        raise UsageError(f"human: {'must be given' if human is None else 'there is none'} in {task}")
    for name in settings:
        if name not in SETTINGS[task]:
            raise UsageError(f"{name}: no setting of {task}{or_else(name, SETTINGS[task])}")
    if task == SOCIAL and lab is not None:
        raise UsageError("lab: social is played in an open arena")
    made, thresholds, met = one_task(task, settings, distances, human, lab=lab)
    place = lab_of(made)
    asked = {name: tuple(TASKS[name].size(place)) for name in made.steering}
    told: Mapping[str, npt.ArrayLike] = {} if tables is None else tables
    if not isinstance(told, Mapping) or set(told) != set(asked):
        wanted = " and ".join(f"{name} of shape {shape}" for name, shape in asked.items())
        raise UsageError(f"tables: must have {wanted or 'nothing'} in {task}")
    given = {name: q_table("tables", name, told[name], shape) for name, shape in asked.items()}
    size = about.size(place)
    record = made.task_in(Site(place, met and met.create(), thresholds, given))
    return PlayableTask(about, record, size.n_states, size.n_actions, made.trial_steps)
