"""One recorded trial with what is needed to draw it: its steps, its lab or arena, the distances that count."""

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import yaml

from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.declared import counts, floats
from visitlab_cli.config.names import PAPER_LAB, changes_of_place, module
from visitlab_cli.errors import RunError, VisitlabError
from visitlab_cli.log.reader import check_values, read_attachment, read_metadata, read_trial
from visitlab_cli.log.schema import CONFIG_NAME
from visitlab_cli.scene.words import Steps
from visitlab_cli.storage.arrays import read_model
from visitlab_cli.storage.cell_folder import MODEL
from visitlab_cli.wording import printable
from visitlab_cli.world.columns import ENGAGEMENT, GOAL, HUMAN
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.lab import COL_STEPS, ROW_STEPS, Lab, paper_lab
from visitlab_cli.world.social import ARENA
from visitlab_cli.world.tasks import SOCIAL, TASKS, Task

Vectors = npt.NDArray[np.float32]
Values = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Trial:
    """A trial of the log `path`: `number`, `task`, its `cell` and `steps` from step 0 on.

    `lab` is where it plays, or where it would without its own `arena`, the side of an open square in cells.
    `distances` are the four thresholds in cells, `q` what the deciding module had learned in the end, shape
    (states, actions), where its model is at hand, and `q_of` the number of that model where the agent has several:
    the one that was active in the end. `phase` says in words which phase it is of; empty without phases.
    """

    path: Path
    cell: str
    task: str
    number: int
    steps: Steps
    lab: Lab
    distances: tuple[int, ...]
    q: Values | None = None
    arena: int | None = None
    phase: str = ""
    q_of: int | None = None

    @property
    def name(self) -> str:
        """Which trial it is, in words: 'visit/phases/seed-0000, trial 3, phase 1 (human_2)'."""
        return ", ".join(filter(None, (self.cell, f"trial {self.number}", self.phase)))

    @property
    def length(self) -> int:
        """Rows of each column: the steps and the state that the trial starts in."""
        return len(self.steps["step"])

    @property
    def last_step(self) -> int:
        """The number of its last step."""
        return int(self.steps["step"][-1])

    @property
    def plays(self) -> Task:
        """The description of its task."""
        return TASKS[self.task]

    @property
    def rows(self) -> int:
        """Cells of its world from north to south."""
        return self.lab.rows if self.arena is None else self.arena

    @property
    def cols(self) -> int:
        """Cells of its world from west to east."""
        return self.lab.cols if self.arena is None else self.arena

    @property
    def has_human(self) -> bool:
        """Whether there is a human."""
        return self.plays.has(HUMAN)

    @property
    def has_engagement(self) -> bool:
        """Whether the human can be engaged, and led in a desired direction."""
        return self.plays.has(ENGAGEMENT)

    @property
    def has_goal(self) -> bool:
        """Whether there are goal rooms."""
        return self.plays.has(GOAL)

    @property
    def has_plan(self) -> bool:
        """Whether a plan said, while it was played, where robot and human should go."""
        return "plan_leads" in self.steps

    @property
    def has_belief(self) -> bool:
        """Whether engagement was hidden and something was believed of it."""
        return "belief_none" in self.steps

    @property
    def has_models(self) -> bool:
        """Whether the robot had several models of humans, and one was active."""
        return "active_model" in self.steps

    @property
    def has_rooms(self) -> bool:
        """Whether it plays in the lab with its rooms."""
        return self.arena is None

    def places(self, who: str) -> Vectors:
        """The middle of the cells of `robot` or `human`, as x and y in cells, y southwards: shape (steps + 1, 2)."""
        return np.stack([self.steps[f"{who}_col"] + 0.5, self.steps[f"{who}_row"] + 0.5], axis=1).astype(np.float32)

    def headings(self, column: str) -> Vectors:
        """The unit vectors of a column of directions, x eastwards and y southwards: shape (steps + 1, 2)."""
        return unit_vectors(self.steps[column])


def unit_vectors(directions: npt.NDArray[Any]) -> Vectors:
    """Directions 0..7 as vectors of length 1, x eastwards and y southwards: shape (..., 2)."""
    vectors = np.stack([COL_STEPS, ROW_STEPS], axis=1).astype(np.float32)
    vectors /= np.linalg.norm(vectors, axis=1, keepdims=True)
    chosen: Vectors = vectors[directions]
    return chosen


def load_trial(path: Path, number: int) -> Trial:
    """Read trial `number` of a log.

    Raises:
        NotFoundError: there is no such file, or the trial is not recorded.
        RunError: it is not a log of visitlab, or damaged.
    """
    steps = read_trial(path, number)
    lab = lab_of_steps(path, steps)
    about = read_metadata(path)
    task, cell = about["task"], about["cell"]
    check_values(path, steps, task, lab)
    config = config_of_log(path)
    experiment = config.get("experiments", {}).get(cell.split("/")[0], {})
    arena = int(experiment.get("arena", ARENA)) if task == SOCIAL else None
    distances = config.get("interaction", {}).get("distances", DISTANCES)
    learned = _learned(path, TASKS[task], lab, cell, config)
    phase = phase_in_words(steps, experiment)
    model = active_in_the_end(path) if "active_model" in steps else None
    return Trial(path, cell, task, number, steps, lab, tuple(distances), learned, arena, phase, model)


def phase_in_words(steps: Steps, experiment: Mapping[str, Any]) -> str:
    """Which phase a trial is of, whom it meets, what is new of lab and doors: 'phase 1 (human_2, lab shut)'.

    Empty where there are no phases.

    `experiment` is as the config of the log has it, as plain values.
    """
    if "phase" not in steps:
        return ""
    number = int(steps["phase"][0])
    with contextlib.suppress(LookupError, TypeError, AttributeError, ValueError):
        phases, lab = experiment["phases"], experiment.get("lab", PAPER_LAB)
        places = changes_of_place(lab, [(phase.get("lab", lab), phase.get("doors", {})) for phase in phases])
        told = ", ".join(filter(None, (phases[number].get("human", ""), places[number])))
        return f"phase {number} ({told})" if told else f"phase {number}"
    return f"phase {number}"


def phase_of_log(path: Path, steps: Steps) -> str:
    """As `phase_in_words`, of a trial of a log."""
    if "phase" not in steps:
        return ""
    cell = read_metadata(path)["cell"]
    return phase_in_words(steps, config_of_log(path).get("experiments", {}).get(cell.split("/")[0], {}))


def phase_trials_of_log(path: Path) -> list[int]:
    """How many trials each phase of a log has, recorded or not, as the config says that the log carries.

    Raises:
        LookupError, TypeError, ValueError, ArithmeticError: it says none.
    """
    experiment = config_of_log(path)["experiments"][read_metadata(path)["cell"].split("/")[0]]
    return [
        int(phase["trials"] if "trials" in phase else phase["steps"] // experiment["trial_steps"])
        for phase in experiment["phases"]
    ]


def lab_of_log(path: Path, phase: int | None = None) -> Lab:
    """The lab in which the steps of a log were played, those of a phase where it has phases.

    Raises:
        RunError: the config that the log carries says no lab.
    """
    cell, config = read_metadata(path)["cell"], config_of_log(path)
    experiment = config.get("experiments", {}).get(cell.split("/")[0], {})
    if all(each.get("lab", PAPER_LAB) == PAPER_LAB for each in (experiment, *experiment.get("phases", ()))):
        return paper_lab()
    from visitlab_cli.config.labs import lab_from_plain  # only now: it takes a moment

    try:
        return lab_from_plain(config, experiment, phase)
    except (ValueError, LookupError, TypeError, AttributeError) as error:
        raise RunError(f"{path}: its config says no lab that there can be: {printable(str(error))}") from error


def lab_of_steps(path: Path, steps: Steps) -> Lab:
    """The lab in which a trial of a log was played."""
    return lab_of_log(path, int(steps["phase"][0]) if "phase" in steps else None)


def _learned(path: Path, task: Task, lab: Lab, cell: str, config: dict[str, Any]) -> Values | None:
    """What the agent of the model beside the log believed of each action, if there is a sound one."""
    file = path.with_name(MODEL)
    with contextlib.suppress(VisitlabError, KeyError):
        return read_model(file, {"q": floats(*task.size(lab))})["q"]
    from visitlab_cli.config.building import agents_of  # only now: it takes a moment, and most models have a q

    with contextlib.suppress(VisitlabError, LookupError, TypeError, AttributeError, ValueError):
        agents = agents_of(config)
        agent = agents[player_of(config, cell)]
        setting = Setting(task.name, *task.size(lab), 1, agents, goals=task.goals(lab))
        return agent.values(read_model(file, agent.arrays(setting)))
    return None


def active_in_the_end(path: Path) -> int | None:
    """Which of several models the agent beside a log acted by in the end, if that is told."""
    with contextlib.suppress(VisitlabError, KeyError):
        return int(read_model(path.with_name(MODEL), {"active": counts(1, dtype="<i8")})["active"][0])
    return None


def player_of(config: dict[str, Any], cell: str) -> str:
    """The name of the agent that decides in a cell, in a visit its social module's.

    Raises:
        LookupError: the config says none.
    """
    experiment, player = cell.split("/")[:2]
    modules = config["experiments"][experiment].get("modules")
    return player if modules is None else module(modules[SOCIAL]).agent


def config_of_log(path: Path) -> dict[str, Any]:
    """The config that the log carries; empty where another program wrote the log."""
    try:
        content = read_attachment(path, CONFIG_NAME)
        return {} if content is None else dict(yaml.safe_load(content))
    except (yaml.YAMLError, ValueError, TypeError, RecursionError) as error:
        raise RunError(f"{path}: its {CONFIG_NAME} is damaged: {str(error).splitlines()[0]}") from error
