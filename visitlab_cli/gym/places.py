"""What an environment plays: a task's record made of settings, which are checked as those of a config are."""

import json
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.config.experiment import Experiment, Site
from visitlab_cli.config.loading import load_text
from visitlab_cli.errors import ConfigError, UsageError
from visitlab_cli.exact.models import go_to_human_mean_q
from visitlab_cli.exact.navigation import navigation_optimal_q
from visitlab_cli.gym.humans import HUMAN, HUMAN_2, entry_and_record, shipped_humans
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.lab import Lab, paper_lab
from visitlab_cli.world.social import ARENA, DIRECTION_CHANGE
from visitlab_cli.world.task import TRAINING_TRIAL_STEPS, VISIT_TRIAL_STEPS
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, TASKS, VISIT, Task

GAMMA = 0.9
"""The discount of the modules that a visit has unless others are given."""
AGENT = "chance"
LENGTH = "steps"
CONFIG: dict[str, Any] = {
    "name": "environment",
    "agents": {AGENT: {"kind": "random"}},
    "experiments": {
        NAVIGATION: {"task": NAVIGATION, "agents": [AGENT]},
        GO_TO_HUMAN: {"task": GO_TO_HUMAN, "agents": [AGENT]},
        SOCIAL: {"task": SOCIAL, "agents": [AGENT], "humans": [HUMAN]},
        VISIT: {
            "task": VISIT,
            "modules": {task: f"{task}/{AGENT}" for task in (NAVIGATION, GO_TO_HUMAN, SOCIAL)},
            "humans": [HUMAN],
        },
    },
}
"""A config that has every task, to which an environment's settings are added."""


class Place(NamedTuple):
    """A task with its record, the `world` in which it plays, and what is needed to draw it.

    `lab` is the one with the rooms; `arena` the side of the open square that the world is, where it is none.
    """

    task: Task
    record: Any
    world: Lab
    lab: Lab
    distances: tuple[int, ...]
    arena: int | None = None


def navigation(*, trial_steps: int = TRAINING_TRIAL_STEPS, lab: Lab | None = None) -> Place:
    """Navigation in `lab`, the paper's unless given.

    Raises:
        UsageError: a setting is wrong.
    """
    lab = lab or paper_lab()
    settings, _ = _checked(NAVIGATION, {"trial_steps": trial_steps}, DISTANCES)
    return Place(TASKS[NAVIGATION], settings.task_in(Site(lab, None, DISTANCES, {})), lab, lab, DISTANCES)


def go_to_human(
    *,
    trial_steps: int = TRAINING_TRIAL_STEPS,
    success: str = "facing",
    distances: Sequence[int] = DISTANCES,
    lab: Lab | None = None,
) -> Place:
    """Go to human in `lab`, the paper's unless given.

    Raises:
        UsageError: a setting is wrong.
    """
    lab = lab or paper_lab()
    settings, thresholds = _checked(GO_TO_HUMAN, {"trial_steps": trial_steps, "success": success}, distances)
    return Place(TASKS[GO_TO_HUMAN], settings.task_in(Site(lab, None, thresholds, {})), lab, lab, thresholds)


def social(
    *,
    human: Any = HUMAN_2,
    trial_steps: int = TRAINING_TRIAL_STEPS,
    arena: int = ARENA,
    direction_change: float = DIRECTION_CHANGE,
    distances: Sequence[int] = DISTANCES,
) -> Place:
    """The social task with a human, in an arena of its own.

    Raises:
        UsageError: a setting is wrong.
    """
    entry, record = entry_and_record(human)
    wanted = {"trial_steps": trial_steps, "arena": arena, "direction_change": direction_change}
    settings, thresholds, met = _checked_with(SOCIAL, wanted, distances, entry)
    made = settings.task_in(Site(paper_lab(), met if record is None else record, thresholds, {}))
    return Place(TASKS[SOCIAL], made, made.lab, paper_lab(), thresholds, arena)


def visit(
    *,
    human: Any = HUMAN_2,
    modules: Mapping[str, npt.ArrayLike] | None = None,
    trial_steps: int = VISIT_TRIAL_STEPS,
    goal_rooms: str | Sequence[int] = "all",
    distances: Sequence[int] = DISTANCES,
    lab: Lab | None = None,
) -> Place:
    """A visit with a human in `lab`, the paper's unless given.

    `modules` has the Q of `navigation` and `go_to_human`, shapes (goal rooms * cells, 25) and (320, 25); for one
    that is left out stands the exact one: of the known motion, discounted by `GAMMA`.

    Raises:
        UsageError: a setting is wrong.
    """
    lab = lab or paper_lab()
    entry, record = entry_and_record(human)
    rooms = goal_rooms if isinstance(goal_rooms, str) else [*goal_rooms]
    settings, thresholds, met = _checked_with(
        VISIT, {"trial_steps": trial_steps, "goal_rooms": rooms}, distances, entry
    )
    tables = _tables(modules or {}, lab, thresholds)
    made = settings.task_in(Site(lab, met if record is None else record, thresholds, tables))
    return Place(TASKS[VISIT], made, lab, lab, thresholds)


PLACES: dict[str, Callable[..., Place]] = {
    NAVIGATION: navigation,
    GO_TO_HUMAN: go_to_human,
    SOCIAL: social,
    VISIT: visit,
}
"""What makes the place of each task, of its settings."""


def _tables(
    given: Mapping[str, npt.ArrayLike], lab: Lab, distances: tuple[int, ...]
) -> dict[str, npt.NDArray[np.float64]]:
    tables = {}
    for name in given:
        if name not in (NAVIGATION, GO_TO_HUMAN):
            raise UsageError(f"modules: has {name!r}; there are {NAVIGATION} and {GO_TO_HUMAN}")
    for name in (NAVIGATION, GO_TO_HUMAN):
        if name in given:
            table, shape = np.ascontiguousarray(given[name], np.float64), tuple(TASKS[name].size(lab))
            if table.shape != shape or not np.isfinite(table).all():
                raise UsageError(f"modules: the Q of {name} must be finite numbers of shape {shape}, not {table.shape}")
            tables[name] = table
        else:
            exact = navigation_optimal_q(GAMMA, lab) if name == NAVIGATION else None
            tables[name] = go_to_human_mean_q(GAMMA, "facing", distances, lab) if exact is None else exact
    return tables


def _checked(task: str, settings: Mapping[str, Any], distances: Sequence[int]) -> tuple[Experiment, tuple[int, ...]]:
    return _checked_with(task, settings, distances, HUMAN_2)[:2]


def _checked_with(
    task: str, settings: Mapping[str, Any], distances: Sequence[int], human: str | Mapping[str, Any]
) -> tuple[Experiment, tuple[int, ...], Any]:
    """The task's settings as a config has them, the distances, and the human's record."""
    own = {"like": human} if isinstance(human, str) else dict(human)
    trial_steps = settings["trial_steps"]
    length = {} if task == VISIT else {LENGTH: trial_steps}  # one trial, so that any number of steps will do
    experiments = CONFIG["experiments"]
    config = CONFIG | {
        "humans": {**shipped_humans(), HUMAN: own},
        "experiments": {**experiments, task: {**experiments[task], **settings, **length}},
        "interaction": {"distances": list(distances)},
    }
    try:
        checked = load_text(json.dumps(config), CONFIG["name"])
    except ConfigError as error:
        theirs = [problem for problem in error.problems if not str(problem["path"]).endswith(f".{LENGTH}")]
        raise UsageError(*dict.fromkeys(map(_in_words, theirs))) from None
    except (TypeError, ValueError) as error:
        raise UsageError(f"settings must be plain values, as YAML has them: {error}") from None
    return checked.experiments[task], checked.interaction.distances, checked.humans[HUMAN].create()


def _in_words(problem: Mapping[str, Any]) -> str:
    """What is wrong with which argument."""
    path = str(problem["path"] or "").removeprefix("humans.").removeprefix("interaction.")
    return f"{'.'.join(path.split('.')[2:]) if path.startswith('experiments.') else path}: {problem['message']}"
