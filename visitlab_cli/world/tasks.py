"""The four tasks as configs, logs and plans know them: what there is in each, and the sizes of its tables.

Their rules are in a file each: `navigation.py`, `go_to_human.py`, `social.py`, `visit.py` (with
`simulation/visit.py`). Whoever wants to know something of a task asks its description here.
"""

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from visitlab_cli.world.columns import ALWAYS, COLUMNS, ENGAGEMENT, GOAL, HUMAN, MODULES, Column
from visitlab_cli.world.enums import N_DIRECTIONS, N_DISTANCES, N_LEVELS, N_PHYSICAL_ACTIONS, N_SOCIAL_ACTIONS

NAVIGATION, GO_TO_HUMAN, SOCIAL, VISIT = TASK_NAMES = ("navigation", "go_to_human", "social", "visit")


class TaskSize(NamedTuple):
    """How many states and actions the deciding module has."""

    n_states: int
    n_actions: int


class Rooms(Protocol):
    """What the size of a task may depend on: a lab."""

    @property
    def rows(self) -> int:
        """Cells from north to south."""

    @property
    def cols(self) -> int:
        """Cells from west to east."""

    @property
    def n_rooms(self) -> int:
        """How many rooms it has."""


class Costs(NamedTuple):
    """What a cell of a task costs beside its agent's steps: of version 0.1 on a core of an ordinary server in 2026.

    `seconds` of a cell of a few steps, whose tables are made and files written; `recording`, the microseconds of a step
    that recording takes, which are in what agents tell of one; bytes of a recorded step in `steps.mcap`; bytes of a
    `model.npz` with counts when hardly anything new is met.
    """

    seconds: float
    recording: float
    log_bytes_a_step: float
    model_bytes: float


@dataclass(frozen=True)
class Task:
    """A task: what it is `about`, the `parts` that there are in it (`columns.py`), its tables' sizes, its costs.

    `n_states` is the number of states in any lab, or None where a state is a goal room and a cell. `counts_goals`
    says that its reward counts goals reached, each of which gives way to another.
    """

    name: str
    about: str
    parts: tuple[str, ...]
    n_states: int | None
    n_actions: int
    costs: Costs
    counts_goals: bool = False

    def has(self, part: str) -> bool:
        """Whether there is such a part in it."""
        return part in self.parts

    @property
    def measure(self) -> str:
        """What the reward of a trial is."""
        return "goals a trial" if self.counts_goals else "reward a trial"

    @property
    def columns(self) -> tuple[Column, ...]:
        """The columns that its log always has, in their order."""
        return tuple(column for column in COLUMNS if column.part in self.parts)

    def goals(self, lab: Rooms) -> int:
        """Of how many blocks of equal size the states are made up, one for each goal: rooms, or one for all."""
        return lab.n_rooms if self.n_states is None else 1

    def size(self, lab: Rooms) -> TaskSize:
        """The deciding module's states and actions in a lab."""
        n_states = lab.n_rooms * lab.rows * lab.cols if self.n_states is None else self.n_states
        return TaskSize(n_states, self.n_actions)


_TOWARDS_HUMAN = N_DIRECTIONS * N_DIRECTIONS * N_DISTANCES
_SOCIAL = N_LEVELS * N_DISTANCES * N_DIRECTIONS * N_DIRECTIONS

TASKS = {
    task.name: task
    for task in (
        Task(
            NAVIGATION,
            "reach the goal room and stay there",
            (ALWAYS, GOAL),
            None,
            N_PHYSICAL_ACTIONS,
            Costs(seconds=0.02, recording=0.2, log_bytes_a_step=38, model_bytes=360_000),
        ),
        Task(
            GO_TO_HUMAN,
            "get in front of a human who stands still",
            (ALWAYS, HUMAN),
            _TOWARDS_HUMAN,
            N_PHYSICAL_ACTIONS,
            Costs(seconds=0.01, recording=0.22, log_bytes_a_step=38, model_bytes=75_000),
        ),
        Task(
            SOCIAL,
            "win a human's attention and lead it in a direction",
            (ALWAYS, HUMAN, ENGAGEMENT),
            _SOCIAL,
            N_SOCIAL_ACTIONS,
            Costs(seconds=0.015, recording=0.28, log_bytes_a_step=43, model_bytes=650_000),
        ),
        Task(
            VISIT,
            "lead a human from goal room to goal room with the trained modules",
            (ALWAYS, HUMAN, ENGAGEMENT, GOAL, MODULES),
            _SOCIAL,
            N_SOCIAL_ACTIONS,
            Costs(seconds=0.12, recording=0.3, log_bytes_a_step=42, model_bytes=700_000),
            counts_goals=True,
        ),
    )
}
"""By name, in the order of the paper."""


def columns_of(task: str) -> tuple[Column, ...]:
    """The columns that a task has, by its name."""
    return TASKS[task].columns


def tasks_with(part: str) -> tuple[str, ...]:
    """The names of the tasks that have a part."""
    return tuple(name for name, task in TASKS.items() if part in task.parts)
