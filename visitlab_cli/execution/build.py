"""The one place where a config becomes the arrays and numbers that kernels take."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from visitlab_cli.agents.base import Player, Saved
from visitlab_cli.config.experiment import Site, lab_of
from visitlab_cli.errors import RunError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import setting_of
from visitlab_cli.world.tasks import SOCIAL, TASKS


class Simulation(NamedTuple):
    """What the loop plays, and the parameters that know how to save the agent."""

    task: Any
    agent: Any
    parameters: Player
    steps: int
    trials: int


def build(cell: Cell, models: Mapping[str, Saved]) -> Simulation:
    """The task and agent of a cell, from the arrays of the modules that it needs, by the module's name.

    Raises:
        RunError: a model does not have the shape that its task asks for.
    """
    settings, config = cell.settings, cell.config
    lab = lab_of(settings)
    tables = {}
    for module in cell.modules:
        of_module, expected = config.agents[settings.starts[module].agent], tuple(TASKS[module].size(lab))
        if module in settings.steering:
            tables[module] = np.ascontiguousarray(of_module.values(models[module]), np.float64)
        table = tables.get(module, models[module].get("q"))
        shape = expected if table is None else table.shape
        if shape != expected:
            raise RunError(f"{cell.path}: the {module} model has a table of {shape}, not {expected}")
    human = config.humans[cell.human].create() if cell.human else None
    task = settings.task_in(Site(lab, human, config.interaction.distances, tables))
    learner = settings.parameters_of(config.agents[cell.agent])
    parameters: Player = cell.player if cell.frozen else learner
    setting = setting_of(cell)
    agent: Any
    if cell.frozen:
        agent = parameters.restore(setting, models[SOCIAL])
    elif cell.modules:
        agent = settings.restored(learner, setting, models[SOCIAL])
    else:
        agent = learner.create(setting)
    return Simulation(task, agent, parameters, settings.n_steps, settings.n_trials)
