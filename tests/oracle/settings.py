"""What the oracle must know of a cell besides its log: the task and its parameters."""

from bisect import bisect_right
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from typing import Any

import numpy as np

from visitlab_cli.world.enums import Action

from .lab import NO_DOORS, Lab
from .rules import DISTANCES, Cell, Grid, Human

TASKS = ("navigation", "go_to_human", "social", "visit")
# (goal_room, cell number) -> the best directions; as an array: bool [rooms, cells, 8]
BestDirections = Callable[[int, int], Collection[int]] | np.ndarray
# go_to_human state -> its greedy actions; as an array: bool [320, 25]
GreedyMoves = Callable[[int], Collection[int]] | np.ndarray

PHYSICAL = (
    "trial",
    "step",
    "state",
    "action",
    "explored",
    "reward",
    "robot_row",
    "robot_col",
    "robot_heading",
)
WITH_HUMAN = ("human_row", "human_col", "human_heading", "interaction_level", "distance", "angle")
LEADING = ("human_action", "desired_direction")
COLUMNS: dict[str, tuple[str, ...]] = {
    "navigation": (*PHYSICAL, "goal_room"),
    "go_to_human": (*PHYSICAL, *WITH_HUMAN),
    "social": (*PHYSICAL, *WITH_HUMAN, *LEADING),
    "visit": (*PHYSICAL, *WITH_HUMAN, *LEADING, "goal_room", "executed_action", "social_reward"),
}


@dataclass(frozen=True, eq=False)
class Place:
    """Where a trial takes place."""

    grid: Grid
    starts: tuple[Cell, ...]  # the cells that it may begin in
    goals: frozenset[int]  # the rooms that goals are drawn from

    @cached_property
    def reachable(self) -> frozenset[Cell]:
        """The starts as a set."""
        return frozenset(self.starts)


@dataclass(frozen=True)
class Settings:
    """The keywords of `check_log` and `check_frequencies`."""

    task: str
    human: Mapping[str, Any] | Human | None = None  # p_S, p_H, p_M, p_O, p_A, p_P: social and visit
    trial_steps: int | None = None  # 20; 100 in a visit
    height: int = 24
    width: int = 24
    arena: int = 120  # the side of the social task's grid
    walls: Iterable[tuple[Cell, Cell]] = ()
    lab: Lab | None = None  # in the place of height, width and walls; social has none
    distances: tuple[int, ...] = DISTANCES
    direction_change: float = 0.2  # social
    success: str = "facing"  # go_to_human: facing | seen
    goal_rooms: Collection[int] | str = "all"  # visit
    social_reward: str = "social"  # visit: social | none
    epsilon: float | None = None  # None: exploration is not checked
    best_directions: BestDirections | None = None  # visit; None: any direction passes
    greedy_moves: GreedyMoves | None = None  # visit: what go_to_human may pick; None: any move passes
    trial_stride: int = 1  # 10 where one trial in ten was recorded
    partial_last_trial: bool = False
    # one phase after the other: its trials, its human in the place of `human`, perhaps its lab in that of `lab`
    phases: Sequence[tuple[Any, ...]] = ()

    def __post_init__(self) -> None:
        if self.task not in TASKS:
            raise ValueError(f"no task {self.task!r}; known: {', '.join(TASKS)}")
        if self.has_reactions and None in self._people:
            raise ValueError(f"{self.task} needs the human's parameters")
        if self.success not in ("facing", "seen") or self.social_reward not in ("social", "none"):
            raise ValueError(f"unknown option: success {self.success!r}, social_reward {self.social_reward!r}")
        if len(self.distances) != 4:
            raise ValueError("distances are four thresholds")
        if self.task == "social" and any(self.labs):
            raise ValueError("the social task is played in the open")

    @property
    def has_human(self) -> bool:
        return self.task != "navigation"

    @property
    def has_reactions(self) -> bool:
        """Whether the human engages, moves and looks around."""
        return self.task in ("social", "visit")

    @property
    def columns(self) -> tuple[str, ...]:
        phase = ("phase",) if self.phases else ()
        return (*COLUMNS[self.task], *phase, *(("open_doors",) if self.n_doors else ()))

    @property
    def n_doors(self) -> int:
        """The most doors that toggle in one phase."""
        return max(len(lab.toggled) if lab else 0 for lab in self.labs)

    @property
    def n_actions(self) -> int:
        return 30 if self.has_reactions else 25

    @property
    def steps_in_trial(self) -> int:
        return self.trial_steps if self.trial_steps is not None else (100 if self.task == "visit" else 20)

    @cached_property
    def labs(self) -> list[Lab | None]:
        """The lab of each phase; one, where there are no phases."""
        return [phase[2] if len(phase) > 2 else self.lab for phase in self.phases] or [self.lab]

    def lab_in(self, trial: int) -> Lab | None:
        return self.labs[min(self.phase_of(trial), len(self.labs) - 1)]

    def place(self, trial: int = 0, open_doors: int = NO_DOORS) -> Place:
        """Where a trial takes place, its doors being as they are."""
        lab = self.lab_in(trial)
        key = (lab, open_doors if lab and lab.toggled else NO_DOORS)
        if key not in self._places:
            self._places[key] = self._make_place(*key)
        return self._places[key]

    @cached_property
    def _places(self) -> dict[tuple[Lab | None, int], Place]:
        return {}

    def _make_place(self, lab: Lab | None, open_doors: int) -> Place:
        if lab:
            grid, starts, goals = lab.grid(open_doors), lab.starts, lab.goals
        else:
            height, width = (self.arena, self.arena) if self.task == "social" else (self.height, self.width)
            grid = Grid.with_walls(height, width, self.walls)
            starts, goals = tuple(grid.cells()), frozenset(range(grid.n_rooms))
        if self.task == "navigation" or self.goal_rooms == "all":
            return Place(grid, starts, goals)
        if isinstance(self.goal_rooms, str):
            raise ValueError(f"goal_rooms is `all` or rooms, not {self.goal_rooms!r}")
        return Place(grid, starts, goals & {int(room) for room in self.goal_rooms})

    def toggles_of(self, trial: int, before: int | None) -> int:
        """How often doors may have toggled up to a trial: since `before`, or else since its phase began."""
        phase = self.phase_of(trial)
        if before is not None and self.phase_of(before) == phase:
            return trial - before
        return trial - sum(each[0] for each in self.phases[:phase]) + 1

    def phase_of(self, trial: int) -> int:
        """The number of the phase that a trial is of; beyond the last one that there is no such phase."""
        return bisect_right(list(accumulate(phase[0] for phase in self.phases)), trial)

    def make_humans(self) -> list[Human]:
        """Whom the robot meets, phase by phase."""
        return [Human.of(human) for human in self._people if human is not None]

    @property
    def _people(self) -> list[Any]:
        return [phase[1] for phase in self.phases] or [self.human]

    def human_in(self, humans: Sequence[Human], trial: int) -> Human | None:
        """Whom of these, phase by phase, it meets in a trial."""
        if not humans:
            return None
        return humans[min(self.phase_of(trial), len(humans) - 1)] if self.phases else humans[0]

    def directions_at(self, goal_room: int, cell: int) -> frozenset[int]:
        """The desired directions that navigation holds best; all where it is not known."""
        return _choices(self.best_directions, (goal_room, cell), 8)

    def moves_at(self, state: int) -> frozenset[int]:
        """What the go_to_human module may pick; every move and stay where it is not known."""
        return _choices(self.greedy_moves, (state,), 25)


def _choices(source: Any, key: tuple[int, ...], n: int) -> frozenset[int]:
    if source is None:
        return frozenset(range(n))
    if callable(source):
        return frozenset(int(choice) for choice in source(*key))
    return frozenset(int(choice) for choice in np.flatnonzero(source[key]))


def best_directions_of(q: np.ndarray, grid: Grid) -> np.ndarray:
    """From navigation's Q [rooms * cells, 25]: the best means over speeds [rooms, cells, 8]."""
    slow, middle, fast = (q[:, 8 * speed : 8 * speed + 8] for speed in range(3))
    mean = (slow + middle + fast) / 3
    best: np.ndarray = mean == mean.max(axis=1, keepdims=True)
    return best.reshape(-1, grid.n_cells, 8)


def greedy_moves_of(q: np.ndarray) -> np.ndarray:
    """From go_to_human's Q [320, 25]: the exact maximisers [320, 25]."""
    return np.asarray(q == q.max(axis=1, keepdims=True))


def ranges(settings: Settings, grid: Grid) -> dict[str, tuple[int, int]]:
    """The lowest and the highest value that each column may hold anywhere."""
    states = {"navigation": grid.n_rooms * grid.n_cells, "go_to_human": 320, "social": 2560, "visit": 2560}
    row, col, eight = (0, grid.height - 1), (0, grid.width - 1), (0, 7)
    action = (0, int(Action.NO_ACTION))
    known = {
        "trial": (0, 2**32 - 1),
        "step": (0, settings.steps_in_trial),
        "state": (0, states[settings.task] - 1),
        "action": action,
        "executed_action": action,
        "human_action": action,
        "explored": (0, 1),
        "reward": (0, 1),
        "social_reward": (0, 1),
        "robot_row": row,
        "robot_col": col,
        "human_row": row,
        "human_col": col,
        "robot_heading": eight,
        "human_heading": eight,
        "interaction_level": eight,
        "distance": (0, 4),
        "angle": eight,
        "desired_direction": eight,
        "goal_room": (0, grid.n_rooms - 1),
        "phase": (0, len(settings.phases) - 1),
        "open_doors": (NO_DOORS, 2**settings.n_doors - 1),
    }
    return {name: known[name] for name in settings.columns}
