"""Navigation's exact values: policy iteration with linear solves, on the oracle's movement, against the learner's."""

import numpy as np
import pytest

from tests.oracle.grid import Grid
from tests.oracle.rules import robot_after
from tests.world.package_log import make_task
from visitlab_cli.agents.base import Setting, learn
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.scene import NOWHERE, Body, acted_scene, with_aims
from visitlab_cli.world.task import observe, step
from visitlab_cli.world.tasks import TASKS

SIDE, ACTIONS, GAMMA = 24, 25, 0.9
CELLS = SIDE * SIDE
GOALS = (0, 4, 5)


def transitions():
    """The cell after each action in each cell, shape (576, 25)."""
    grid = Grid()
    return np.array(
        [
            [
                np.ravel_multi_index(robot_after(grid, divmod(cell, SIDE), 0, action, 0)[0], (SIDE, SIDE))
                for action in range(ACTIONS)
            ]
            for cell in range(CELLS)
        ]
    )


def exact_q(after, goal):
    """Optimal Q for one goal room, shape (576, 25): policies are evaluated by solving (I - gamma P) V = r."""
    rows, cols = np.divmod(np.arange(CELLS), SIDE)
    reward = ((rows // 8) * 3 + cols // 8 == goal).astype(float)[after]
    policy = np.zeros(CELLS, int)
    while True:
        here = np.arange(CELLS)
        transition = np.zeros((CELLS, CELLS))
        transition[here, after[here, policy]] = 1
        values = np.linalg.solve(np.eye(CELLS) - GAMMA * transition, reward[here, policy])
        q = reward + GAMMA * values[after]
        better = q.max(axis=1) > q[here, policy] + 1e-9
        if not better.any():
            return q
        policy = np.where(better, q.argmax(axis=1), policy)


@kernel
def try_everything(task, agent, random):
    """Every action once in every state of navigation, by the package's own step."""
    count = 0
    for goal in range(9):
        for row in range(24):
            for col in range(24):
                for action in range(25):
                    scene = with_aims(acted_scene(NOWHERE, Body(row, col, 0), 24), 0, goal)
                    after, _, lesson = step(task, scene, action, random)
                    count += 1
                    learn(agent, observe(task, scene), action, lesson, observe(task, after), False, count, random)


@kernel
def repeat_one(agent, times, random):
    for _ in range(times):
        learn(agent, 0, 24, 1.0, 0, False, 1, random)


def test_value_iteration_reaches_the_exact_values():
    size = TASKS["navigation"].size(paper_lab())
    parameters = ModelBasedParameters(kind="model_based", gamma=GAMMA, plan_every=1)
    pairs = size.n_states * size.n_actions
    agent = parameters.create(Setting("navigation", *size, pairs + 300))._replace(plan_every=pairs + 1)
    try_everything(make_task("navigation"), agent, random_state(0))
    assert (agent.model.visits == 1).all()
    repeat_one(
        agent._replace(plan_every=1), 300, random_state(0)
    )  # a cell in its goal room that stays there: no new knowledge
    q, after = agent.q.reshape(9, CELLS, ACTIONS), transitions()
    for goal in GOALS:
        assert q[goal] == pytest.approx(exact_q(after, goal), abs=1e-6)


def test_inside_the_goal_room_is_worth_ten():
    q = exact_q(transitions(), 0)
    assert q.max() == pytest.approx(1 / (1 - GAMMA))
    assert q[0, 24] == pytest.approx(10)
