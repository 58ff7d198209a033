"""From a config to its cells: every (experiment, agent, human, vary point, model, seed), and what each waits for."""

import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.experiments import Experiment, SocialTraining, Training, Visit
from visitlab_cli.config.grid import variants
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import Module, module
from visitlab_cli.execution.evaluation import AS_DECLARED, Evaluation
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL


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
    def settings(self) -> Experiment:
        """The experiment as the config declares it."""
        return self.config.experiments[self.experiment]

    @property
    def task(self) -> str:
        """The task's name."""
        return self.settings.task

    @property
    def group(self) -> str:
        """What cells that differ in nothing but their seeds share: the path without model and seed."""
        settings = self.settings
        crossed = isinstance(settings, Visit) and settings.models == "crossed"
        return self.path.rsplit("/", 2 if crossed else 1)[0]

    @property
    def trials(self) -> int:
        """Trials of the whole cell."""
        return self.steps // self.settings.trial_steps

    @property
    def steps(self) -> int:
        """Steps of the whole cell."""
        settings = self.settings
        return settings.trials * settings.trial_steps if isinstance(settings, Visit) else settings.steps


SEED, MODEL = "seed-", "model-"
LONGEST_FOLDER_NAME = 200


@dataclass(frozen=True)
class _Point:
    """One point of the grid: the values that it sets, and their names in folders, by path."""

    config: Config
    values: dict[str, Any]
    labels: dict[str, str]
    run_hash: str

    def values_of(self, used: set[str]) -> dict[str, Any]:
        """Those values that lie in a `used` part of the config, by path."""
        return {
            path: value
            for path, value in self.values.items()
            if any(path == part or path.startswith(part + ".") for part in used)
        }

    def labels_of(self, used: set[str]) -> str:
        """Their names."""
        joined = ",".join(self.labels[path] for path in self.values_of(used))
        if len(joined) <= LONGEST_FOLDER_NAME:
            return joined
        return f"vary-{hashlib.sha256(joined.encode()).hexdigest()[:8]}"


def plan(config: Config, evaluation: Evaluation | None = None) -> list[Cell]:
    """All cells of a config, each after those that it needs; with `evaluation` only those visits."""
    cells: dict[str, Cell] = {}
    run_hash = config_hash(config)
    for variant in variants(config):
        point = _Point(variant.config, variant.values, variant.labels, run_hash)
        for name, settings in variant.config.experiments.items():
            if isinstance(settings, Visit):
                made = _visits(point, name, evaluation or AS_DECLARED)
            else:
                made = _trainings(point, name, settings) if evaluation is None else iter(())
            for cell in made:
                cells.setdefault(cell.path, cell)
    return sorted(cells.values(), key=_rank)


def _rank(cell: Cell) -> tuple[bool, int]:
    """Trainings before visits; of trainings first those that start from no other."""
    if isinstance(cell.settings, Visit):
        return True, 0
    return False, len(_chain(cell.config, Module(cell.experiment, cell.agent, cell.human)))


def _seed(seed: int) -> str:
    return f"{SEED}{seed:04d}"


def _trainings(point: _Point, name: str, settings: Training) -> Iterator[Cell]:
    for agent in settings.agents:
        for human in settings.humans if isinstance(settings, SocialTraining) else ("",):
            for seed in range(point.config.seeds):
                training, *starts = _chain(point.config, Module(name, agent, human))
                path = _training_path(point, training, seed)
                needed = {SOCIAL: _training_path(point, starts[0], seed)} if starts else {}
                values = point.values_of(_used_by_training(point.config, training))
                yield Cell(path, point.config, point.run_hash, name, seed, agent, human, needed, point=values)


def _chain(config: Config, training: Module) -> list[Module]:
    """A training, the one that it starts from, and so on."""
    chain = [training]
    while (start := getattr(config.experiments[chain[-1].experiment], "start_from", None)) is not None:
        chain.append(module(start))
    return chain


def _training_path(point: _Point, training: Module, seed: int) -> str:
    labels = point.labels_of(_used_by_training(point.config, training))
    return "/".join(filter(None, (*training, labels, _seed(seed))))


def _visits(point: _Point, name: str, evaluation: Evaluation) -> Iterator[Cell]:
    config = point.config
    settings = config.experiments[name]
    assert isinstance(settings, Visit)
    if evaluation.trials is not None or evaluation.social:
        trials = settings.trials if evaluation.trials is None else evaluation.trials
        played = settings.modules.model_copy(update={"social": evaluation.social or settings.modules.social})
        settings = settings.model_copy(update={"trials": trials, "modules": played})
        config = config.model_copy(update={"experiments": {**config.experiments, name: settings}})
    modules = {task: module(getattr(settings.modules, task)) for task in (NAVIGATION, GO_TO_HUMAN, SOCIAL)}
    for human in evaluation.humans or settings.humans:
        used = {f"experiments.{name}", f"humans.{human}", *EVERY_CELL, INTERACTION}
        used = used.union(*(_used_by_training(config, where) for where in modules.values()))
        labels = point.labels_of(used)
        for seed, model_seed in _seed_pairs(settings.models, config.seeds):
            model = f"{MODEL}{model_seed:04d}" if settings.models == "crossed" else ""
            path = evaluation.folder + "/".join(filter(None, (name, human, labels, model, _seed(seed))))
            needed = {task: _training_path(point, where, model_seed) for task, where in modules.items()}
            agent = modules[SOCIAL].agent
            values = point.values_of(used)
            yield Cell(path, config, point.run_hash, name, seed, agent, human, needed, evaluation, values)


def _seed_pairs(models: str, seeds: int) -> list[tuple[int, int]]:
    """The (visit seed, training seed) pairs of `models: paired | first | crossed`."""
    if models == "crossed":
        return [(seed, model) for model in range(seeds) for seed in range(seeds)]
    return [(seed, 0 if models == "first" else seed) for seed in range(seeds)]


EVERY_CELL = ("seed", "record")
INTERACTION = "interaction"


def _used_by_training(config: Config, training: Module) -> set[str]:
    """The parts of the config that a training's result depends on, as dotted paths."""
    return set().union(*(_used_alone(config, each) for each in _chain(config, training)))


def _used_alone(config: Config, training: Module) -> set[str]:
    """Those without the training that it starts from."""
    parameters = config.agents[training.agent]
    agents = {training.agent, *(getattr(parameters, reference) for reference in parameters.references)}
    used = {f"experiments.{training.experiment}", *(f"agents.{each}" for each in agents), *EVERY_CELL}
    if training.human:
        used.add(f"humans.{training.human}")
    return used if config.experiments[training.experiment].task == NAVIGATION else used | {INTERACTION}
