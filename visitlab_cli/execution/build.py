"""The one place where a config becomes the arrays and numbers that kernels take."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from visitlab_cli.agents.base import AgentParameters, Saved, Setting
from visitlab_cli.agents.greedy_table import GreedyTable
from visitlab_cli.agents.model_based import ModelBased
from visitlab_cli.agents.rmax import RMax
from visitlab_cli.config.experiments import GoToHumanTraining, NavigationTraining, SocialTraining, Visit
from visitlab_cli.errors import RunError
from visitlab_cli.execution.cells import Cell
from visitlab_cli.simulation.visit import make_visit
from visitlab_cli.world.go_to_human import make_go_to_human
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.navigation import make_navigation
from visitlab_cli.world.social import make_social
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, TASKS
from visitlab_cli.world.visit import make_visit_world


class Simulation(NamedTuple):
    """What the loop plays, and the parameters that know how to save the agent."""

    task: Any
    agent: Any
    parameters: AgentParameters
    steps: int
    trials: int


def build(cell: Cell, models: Mapping[str, Saved]) -> Simulation:
    """The task and agent of a cell, from the arrays of the modules that it needs, by the module's name.

    Raises:
        RunError: a model does not have the shape that its task asks for.
    """
    settings = cell.settings
    distances = cell.config.interaction.distances
    if isinstance(settings, Visit):
        return _build_visit(cell, settings, models)
    task: Any
    if isinstance(settings, NavigationTraining):
        task = make_navigation(settings.trial_steps)
    elif isinstance(settings, GoToHumanTraining):
        task = make_go_to_human(settings.trial_steps, settings.success, distances)
    else:
        task = _social_task(cell, settings)
    parameters = cell.config.agents[cell.agent]
    setting = _setting(cell, settings.steps)
    if cell.modules:
        _check_tables(cell, models)
        agent: Any = parameters.restore(setting, models[SOCIAL])
    else:
        agent = parameters.create(setting)
    return Simulation(task, agent, parameters, settings.steps, settings.steps // settings.trial_steps)


def _social_task(cell: Cell, settings: SocialTraining) -> Any:
    return make_social(
        _human(cell),
        settings.trial_steps,
        settings.arena,
        settings.direction_change,
        cell.config.interaction.distances,
    )


def _human(cell: Cell) -> Any:
    return cell.config.humans[cell.human].create()


def _setting(cell: Cell, steps: int) -> Setting:
    size = TASKS[cell.task].size(paper_lab())
    return Setting(cell.task, size.n_states, size.n_actions, steps, cell.config.agents)


def _check_tables(cell: Cell, models: Mapping[str, Saved]) -> None:
    for module in cell.modules:
        shape, expected = models[module]["q"].shape, tuple(TASKS[module].size(paper_lab()))
        if shape != expected:
            raise RunError(f"{cell.path}: the {module} model has a table of {shape}, not {expected}")


def _build_visit(cell: Cell, settings: Visit, models: Mapping[str, Saved]) -> Simulation:
    _check_tables(cell, models)
    world = make_visit_world(_human(cell), settings.goal_rooms, cell.config.interaction.distances)
    navigation, go_to_human = models[NAVIGATION]["q"], models[GO_TO_HUMAN]["q"]
    task = make_visit(world, navigation, go_to_human, settings.trial_steps, settings.social_reward)
    parameters = cell.config.agents[cell.agent]
    if cell.frozen:
        agent: Any = GreedyTable(np.ascontiguousarray(models[SOCIAL]["q"]))
    else:
        if parameters.plans:
            parameters = parameters.model_copy(update={"plan_every": settings.plan_every})
        agent = parameters.restore(_setting(cell, cell.steps), models[SOCIAL])
        if settings.planner_rewards == "restart" and isinstance(agent, ModelBased | RMax):
            agent.model.mean_rewards[:] = 0.0
    return Simulation(task, agent, parameters, cell.steps, settings.trials)
