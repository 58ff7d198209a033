"""From a config to its cells: every (experiment, agent, human, vary point, model, seed), and what each waits for."""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from visitlab_cli.agents.base import AgentParameters, Player
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.experiment import Experiment
from visitlab_cli.config.grid import Variant, variants
from visitlab_cli.config.groups import group_of, used
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import Module
from visitlab_cli.plan.evaluation import AS_DECLARED, Evaluation
from visitlab_cli.world.columns import MEMORY
from visitlab_cli.world.tasks import SOCIAL


@dataclass(frozen=True)
class Cell:
    """One simulation: a pure function of its config and seeds.

    `path` is where it lies in the run folder and what names its random stream; `modules` are the paths of the
    trained cells that it needs, by the module's name: a visit's three, or the social one that a training starts from.
    `evaluation` is what differs from the config; `point` has the values of the grid that matter to it, by path.
    """

    path: str
    config: Config  # at the cell's point of the grid
    run_hash: str
    experiment: str
    seed: int
    agent: str = ""
    human: str = ""
    modules: dict[str, str] = field(default_factory=dict)
    evaluation: Evaluation = AS_DECLARED
    point: dict[str, Any] = field(default_factory=dict)

    @property
    def frozen(self) -> bool:
        """Whether it neither learns nor explores."""
        return self.evaluation.frozen

    @property
    def learner(self) -> AgentParameters:
        """Its agent's parameters as it plays here."""
        return self.settings.parameters_of(self.config.agents[self.agent])

    @property
    def player(self) -> Player:
        """Whose arrays it saves: its agent's parameters, or the frozen one's."""
        return self.learner.frozen if self.frozen else self.learner

    @property
    def absent(self) -> dict[str, str]:
        """Which of the humans and agents that it is simulated with can't be had here, by their paths, and why."""
        agents = {self.agent, *(start.agent for start in self.settings.starts.values())}
        agents |= {
            getattr(self.config.agents[name], field) for name in agents for field in self.config.agents[name].references
        }
        taking_part = {f"agents.{name}": self.config.agents[name].absent for name in sorted(agents)}
        taking_part |= {f"humans.{name}": self.config.humans[name].absent for name in self.humans}
        return {path: why for path, why in taking_part.items() if why}

    @property
    def humans(self) -> tuple[str, ...]:
        """The names of the humans that it meets: `human`, or those of its phases; none where there is none."""
        return self.settings.humans_met(self.human)

    @property
    def settings(self) -> Experiment:
        """The experiment as the config declares it."""
        return self.config.experiments[self.experiment]

    @property
    def parts(self) -> tuple[str, ...]:
        """What there is in it beside what its task has, of `SOME_CELLS`."""
        remembers = any(self.config.humans[name].remembers for name in self.humans)
        tells = self.learner.parts if self.settings.assembled and not self.frozen else ()
        return (*self.settings.parts, *((MEMORY,) if remembers else ()), *tells)

    @property
    def task(self) -> str:
        """The task's name."""
        return self.settings.task

    @property
    def group(self) -> str:
        """What cells that differ in nothing but their seeds share: the path without model and seed."""
        return self.path.rsplit("/", 2 if self.settings.crossed else 1)[0]

    @property
    def condition(self) -> str:
        """Experiment, agent (a visit's is its module's) and human: the group's path without the point of a grid."""
        agent = "" if self.settings.assembled else self.agent
        return self.evaluation.folder + "/".join(filter(None, (self.experiment, agent, self.human)))

    @property
    def trials(self) -> int:
        """Trials of the whole cell."""
        return self.settings.n_trials

    @property
    def steps(self) -> int:
        """Steps of the whole cell."""
        return self.settings.n_steps


SEED, MODEL = "seed-", "model-"


def plan(config: Config, evaluation: Evaluation | None = None) -> list[Cell]:
    """All cells of a config, each after those that it needs; with `evaluation` only those of assembled modules."""
    cells: dict[str, Cell] = {}
    run_hash = config_hash(config)
    for point in variants(config):
        for name, settings in point.config.experiments.items():
            if evaluation is None or settings.assembled:
                for cell in _cells(point, name, run_hash, evaluation or AS_DECLARED):
                    cells.setdefault(cell.path, cell)
    return sorted(cells.values(), key=_rank)


def _rank(cell: Cell) -> tuple[bool, int]:
    """Trainings before what is assembled of them; of trainings first those that start from no other."""
    return cell.settings.assembled, _depth(cell.config, cell.experiment)


def _depth(config: Config, experiment: str) -> int:
    """How many experiments come one after another until this one can start."""
    starts = config.experiments[experiment].starts.values()
    return 1 + max((_depth(config, start.experiment) for start in starts), default=0)


def _cells(declared: Variant, name: str, run_hash: str, evaluation: Evaluation) -> Iterator[Cell]:
    config = evaluation.applied(declared.config, name)
    settings, point = config.experiments[name], declared._replace(config=config)
    for agent in settings.trained or ("",):
        for human in evaluation.humans or settings.met or ("",):
            place = Module(name, agent, human)
            group, values = group_of(point, place), point.values_of(used(config, place))
            for seed, model_seed in settings.seed_pairs(config.seeds):
                model = f"{MODEL}{model_seed:04d}" if settings.crossed else ""
                path = evaluation.folder + "/".join(filter(None, (group, model, _seed(seed))))
                needed = {
                    task: f"{group_of(declared, start)}/{_seed(model_seed)}" for task, start in settings.starts.items()
                }
                player = agent or settings.starts[SOCIAL].agent
                yield Cell(path, config, run_hash, name, seed, player, human, needed, evaluation, values)


def is_cell(path: str) -> bool:
    """Whether a cell of some run may have this path: names, or points of a grid, and a seed."""
    part = r"[A-Za-z0-9][A-Za-z0-9._,=-]*"
    return re.fullmatch(rf"({part}/)+{SEED}[0-9]{{4,}}", path) is not None


def _seed(seed: int) -> str:
    return f"{SEED}{seed:04d}"
