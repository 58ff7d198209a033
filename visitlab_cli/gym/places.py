"""What an environment plays: a task's record made of settings, which are checked as those of a config are."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.config.experiment import Experiment, Site, lab_of
from visitlab_cli.config.goal_rooms import ALL
from visitlab_cli.config.one_task import one_task, q_table
from visitlab_cli.errors import UsageError
from visitlab_cli.exact.models import go_to_human_mean_q
from visitlab_cli.exact.navigation import navigation_optimal_q
from visitlab_cli.gym.humans import HUMAN_2, entry_and_record, shipped_humans
from visitlab_cli.wording import shown
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.lab import Lab, paper_lab
from visitlab_cli.world.social import ARENA, DIRECTION_CHANGE
from visitlab_cli.world.task import TRAINING_TRIAL_STEPS, VISIT_TRIAL_STEPS
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, TASKS, VISIT, Task

GAMMA = 0.9
"""The discount of the modules that a visit has unless others are given."""


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


AnyLab = Lab | Mapping[str, Any] | str
"""A record of `make_lab`; or as under `labs` in a config; or a map, a line a row of cells."""


def navigation(*, trial_steps: int = TRAINING_TRIAL_STEPS, lab: AnyLab | None = None) -> Place:
    """Navigation in `lab`, the paper's unless given.

    Raises:
        UsageError: a setting is wrong.
    """
    settings, _, _ = one_task(NAVIGATION, {"trial_steps": trial_steps}, DISTANCES, lab=_said(lab))
    place = _lab(lab, settings)
    return Place(TASKS[NAVIGATION], settings.task_in(Site(place, None, DISTANCES, {})), place, place, DISTANCES)


def go_to_human(
    *,
    trial_steps: int = TRAINING_TRIAL_STEPS,
    success: str = "facing",
    distances: Sequence[int] = DISTANCES,
    lab: AnyLab | None = None,
) -> Place:
    """Go to human in `lab`, the paper's unless given.

    Raises:
        UsageError: a setting is wrong.
    """
    wanted = {"trial_steps": trial_steps, "success": success}
    settings, thresholds, _ = one_task(GO_TO_HUMAN, wanted, distances, lab=_said(lab))
    place = _lab(lab, settings)
    return Place(TASKS[GO_TO_HUMAN], settings.task_in(Site(place, None, thresholds, {})), place, place, thresholds)


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
    settings, thresholds, met = one_task(SOCIAL, wanted, distances, entry, shipped_humans())
    made = settings.task_in(Site(paper_lab(), record or (met and met.create()), thresholds, {}))
    return Place(TASKS[SOCIAL], made, made.lab, paper_lab(), thresholds, arena)


def visit(
    *,
    human: Any = HUMAN_2,
    modules: Mapping[str, npt.ArrayLike] | None = None,
    trial_steps: int = VISIT_TRIAL_STEPS,
    goal_rooms: str | Sequence[int] = "all",
    distances: Sequence[int] = DISTANCES,
    lab: AnyLab | None = None,
) -> Place:
    """A visit with a human in `lab`, the paper's unless given.

    `modules` has the Q of `navigation` and `go_to_human`, shapes (goal rooms * cells, 25) and (320, 25); for one
    that is left out stands the exact one: of the known motion, discounted by `GAMMA`.

    Raises:
        UsageError: a setting is wrong.
    """
    entry, record = entry_and_record(human)
    rooms = [*goal_rooms] if isinstance(goal_rooms, Iterable) and not isinstance(goal_rooms, str) else goal_rooms
    wanted = {"trial_steps": trial_steps, "goal_rooms": rooms}
    settings, thresholds, met = one_task(VISIT, wanted, distances, entry, shipped_humans(), _said(lab))
    place = _lab(lab, settings)
    if isinstance(lab, Lab) and rooms == ALL:
        settings = settings.model_copy(update={"goal_rooms": ALL})
    tables = _tables({} if modules is None else modules, place, thresholds)
    made = settings.task_in(Site(place, record or (met and met.create()), thresholds, tables))
    return Place(TASKS[VISIT], made, place, place, thresholds)


PLACES: dict[str, Callable[..., Place]] = {
    NAVIGATION: navigation,
    GO_TO_HUMAN: go_to_human,
    SOCIAL: social,
    VISIT: visit,
}
"""What makes the place of each task, of its settings."""


def _said(lab: AnyLab | None) -> Mapping[str, Any] | str | None:
    """What a config would say of the lab; nothing of one that is a record."""
    return None if isinstance(lab, Lab) else lab


def _lab(lab: AnyLab | None, settings: Experiment) -> Lab:
    return lab if isinstance(lab, Lab) else lab_of(settings)


def _tables(
    given: Mapping[str, npt.ArrayLike], lab: Lab, distances: tuple[int, ...]
) -> dict[str, npt.NDArray[np.float64]]:
    tables = {}
    if not isinstance(given, Mapping):
        raise UsageError(f"modules: must be a mapping, the Q of {NAVIGATION} and of {GO_TO_HUMAN} (got {shown(given)})")
    for name in given:
        if name not in (NAVIGATION, GO_TO_HUMAN):
            raise UsageError(f"modules: has {name!r}; there are {NAVIGATION} and {GO_TO_HUMAN}")
    for name in (NAVIGATION, GO_TO_HUMAN):
        if name in given:
            tables[name] = q_table("modules", name, given[name], tuple(TASKS[name].size(lab)))
        else:
            exact = navigation_optimal_q(GAMMA, lab) if name == NAVIGATION else None
            tables[name] = go_to_human_mean_q(GAMMA, "facing", distances, lab) if exact is None else exact
    return tables
