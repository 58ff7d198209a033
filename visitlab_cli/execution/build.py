"""The one place where a config becomes the arrays and numbers that kernels take."""

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from visitlab_cli.agents.base import Player, Saved
from visitlab_cli.config.experiment import Experiment, Site, lab_of
from visitlab_cli.errors import RunError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import setting_of
from visitlab_cli.world.lab import ALL_OPEN, Lab, open_at_first
from visitlab_cli.world.tasks import SOCIAL


class Stretch(NamedTuple):
    """What the loop plays until a step of the cell; the agents of all stretches share their arrays.

    It begins with `open_doors` open, whatever was before.
    """

    task: Any
    agent: Any
    until: int
    open_doors: int = ALL_OPEN
    begin: Callable[[], None] | None = None
    """Tells the agent that another human comes with it."""


class Simulation(NamedTuple):
    """One stretch, or one for each phase, and the parameters that know how to save the agent."""

    stretches: list[Stretch]
    parameters: Player
    trials: int
    experiment: Experiment

    @property
    def agent(self) -> Any:
        """The agent that lives through all of it."""
        return self.stretches[-1].agent

    @property
    def steps(self) -> int:
        """Steps of the whole cell."""
        return self.stretches[-1].until


def build(cell: Cell, models: Mapping[str, Saved]) -> Simulation:
    """The tasks and the agent of a cell, from the arrays of the modules that it needs, by the module's name.

    Raises:
        RunError: a model does not have the shape that its task asks for.
    """
    settings, config = cell.settings.frozen() if cell.frozen else cell.settings, cell.config
    lab = lab_of(settings)
    tables, learned = {}, {}
    for module, start in settings.starts.items():
        of_module, expected = config.agents[start.agent], tuple(config.experiments[start.experiment].plays.size(lab))
        if module in settings.steering:
            tables[module] = np.ascontiguousarray(of_module.values(models[module]), np.float64)
            learned[module] = next(iter(of_module.models(models[module]).values()), {})
        table = tables.get(module, models[module].get("q"))
        shape = expected if table is None else table.shape
        if shape != expected:
            raise RunError(f"{cell.path}: the {module} model has a table of {shape}, not {expected}")
    tasks: dict[tuple[str, Lab], Any] = {}
    for name, place in _scenes(cell):
        declared = config.humans[name] if name else None
        human = declared.create() if declared else None
        kept = models.get(SOCIAL, {})
        task = settings.task_in(Site(place, human, config.interaction.distances, tables, learned, declared, kept))
        tasks[name, place] = settings.going_on(next(iter(tasks.values())), task) if tasks else task
    learner, parameters = cell.learner, cell.player
    setting = setting_of(cell)
    saved = settings.begun_with(learner, setting, models) if cell.modules else {}
    agent: Any
    if cell.frozen:
        agent = parameters.restore(setting, saved)
    elif cell.modules:
        agent = settings.restored(learner, setting, saved)
    else:
        agent = learner.create(setting)
    if not settings.phases:
        (task,) = tasks.values()
        return Simulation([Stretch(task, agent, settings.n_steps)], parameters, settings.n_trials, settings)
    numbers = {human: number for number, human in enumerate(cell.humans)}
    stretches, until, met = [], 0, settings.phases[0].met
    for phase, trials in zip(settings.phases, settings.phase_trials, strict=True):
        until += trials * settings.trial_steps
        replans = phase.plan_every is not None and learner.plans and not cell.frozen
        player = learner.planning_every(agent, phase.plan_every) if replans else agent
        place = settings.lab_in(phase)
        another = phase.met != met and not cell.frozen
        begin = partial(learner.meet, agent, numbers[phase.met]) if another else None
        stretches.append(Stretch(tasks[phase.met, place], player, until, open_at_first(place), begin))
        met = phase.met
    return Simulation(stretches, parameters, settings.n_trials, settings)


def _scenes(cell: Cell) -> Iterable[tuple[str, Lab]]:
    """Whom a cell meets, '' for nobody, and in which lab, each of both once, in their order."""
    settings = cell.settings
    if settings.phases:
        return dict.fromkeys((phase.met, settings.lab_in(phase)) for phase in settings.phases)
    return [(name, lab_of(settings)) for name in cell.humans or ("",)]
