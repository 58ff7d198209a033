"""Each agent on a chain of two states, worked by hand.

State 0: action 0 stays (reward 0), action 1 goes to state 1 (reward 0). State 1: action 0 goes to state 0 (reward 1),
action 1 stays (reward 0). gamma = 0.5.
"""

import numpy as np
import pytest

from visitlab_cli.agents.base import Setting, choose, learn
from visitlab_cli.agents.greedy_table import GreedyTable
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.agents.observer import ObserverParameters
from visitlab_cli.agents.q_learning import QLearningParameters
from visitlab_cli.agents.rmax import RMaxParameters
from visitlab_cli.agents.uniform_random import RandomParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import random_state

NEXT = {(0, 0): (0, 0.0), (0, 1): (1, 0.0), (1, 0): (0, 1.0), (1, 1): (1, 0.0)}
SETTING = Setting("social", 2, 2, 1000)
OPTIMAL = np.array([[1 / 3, 2 / 3], [4 / 3, 2 / 3]])  # V(0) = V(1) / 2, V(1) = 1 + V(0) / 2


@kernel
def taught(agent, state, action, reward, next_state, step, random):
    learn(agent, state, action, reward, next_state, False, step, random)


def teach(agent, state, action, reward, next_state, step):
    """Nobody here draws while learning: a stream of its own says so."""
    random = random_state(0)
    before = random.copy()
    taught(agent, state, action, reward, next_state, step, random)
    assert (random == before).all()


@kernel
def ask(agent, state, step, random):
    return choose(agent, state, step, random)


def teach_all(agent, rounds=1, first_step=1):
    step = first_step
    for _ in range(rounds):
        for (state, action), (next_state, reward) in NEXT.items():
            teach(agent, state, action, reward, next_state, step)
            step += 1
    return step


def test_q_learning_by_hand():
    agent = QLearningParameters(kind="q_learning", gamma=0.5, alpha=0.5).create(SETTING)
    teach(agent, 1, 0, 1.0, 0, 1)
    assert agent.q.tolist() == [[0, 0], [0.5, 0]]
    teach(agent, 0, 1, 0.0, 1, 2)
    assert agent.q.tolist() == [[0, 0.125], [0.5, 0]]
    teach(agent, 1, 0, 1.0, 0, 3)
    assert agent.q.tolist() == [[0, 0.125], [0.5 + 0.5 * (1 + 0.0625 - 0.5), 0]]
    assert agent.visits.tolist() == [[0, 1], [2, 0]]


def test_q_learning_converges_to_the_optimum():
    agent = QLearningParameters(kind="q_learning", gamma=0.5).create(SETTING)
    teach_all(agent, rounds=100)
    assert agent.q == pytest.approx(OPTIMAL)


def test_a_sweep_is_synchronous_and_comes_every_plan_every_steps():
    agent = ModelBasedParameters(kind="model_based", gamma=0.5, plan_every=4).create(SETTING)
    for step, ((state, action), (next_state, reward)) in enumerate(NEXT.items(), 1):
        assert not agent.q.any()
        teach(agent, state, action, reward, next_state, step)
    assert agent.q.tolist() == [[0, 0], [1, 0]]  # values of before: all zero
    teach_all(agent, first_step=5)
    assert agent.q.tolist() == [[0, 0.5], [1, 0.5]]  # and not 1.25, which an asynchronous sweep would give
    teach_all(agent, rounds=60, first_step=9)
    assert agent.q == pytest.approx(OPTIMAL)


@pytest.mark.parametrize(("unvisited", "value"), [("uniform", 0.5 * (1 + 0) / 2), ("zero", 0.0)])
def test_a_pair_never_tried(unvisited, value):
    agent = ModelBasedParameters(kind="model_based", gamma=0.5, plan_every=1, unvisited=unvisited).create(SETTING)
    teach(agent, 1, 0, 1.0, 0, 1)
    assert agent.q.tolist() == [[0, 0], [1, 0]]
    teach(agent, 1, 0, 1.0, 0, 2)
    assert agent.q.tolist() == [[value, value], [1, value]]


def test_transitions_are_frequencies_and_rewards_are_means():
    agent = ModelBasedParameters(kind="model_based", gamma=0.5, plan_every=5).create(SETTING)
    for step, (reward, next_state) in enumerate([(1.0, 0), (0.0, 1), (0.0, 1), (2.0, 1)], 1):
        teach(agent, 0, 0, reward, next_state, step)
    teach(agent, 1, 1, 0.5, 1, 5)
    assert agent.q[0, 0] == 0.75
    for step, (reward, next_state) in enumerate([(0.0, 0), (0.0, 1), (0.0, 1), (1.0, 1)], 6):
        teach(agent, 0, 0, reward, next_state, step)
    teach(agent, 1, 1, 0.5, 1, 10)
    assert agent.q[0, 0] == 4 / 8 + 0.5 * (2 * 0.75 + 6 * 0.5) / 8


def test_rmax_is_optimistic_until_the_mth_visit_then_frozen():
    agent = RMaxParameters(kind="rmax", gamma=0.5, r_max=1, m=2, plan_every=1).create(SETTING)
    assert (agent.q == 2).all()
    teach(agent, 1, 0, 1.0, 0, 1)
    assert (agent.q == 2).all()
    teach(agent, 1, 0, 0.0, 1, 2)
    assert agent.q.tolist() == [[2, 2], [0.5 + 0.5 * 2, 2]]
    teach(agent, 1, 0, 9.0, 0, 3)  # not learned: the pair is known
    assert agent.model.visits.tolist() == [0, 0, 2, 0]
    assert agent.q[1, 0] == 0.5 + 0.5 * 2


def test_rmax_converges_to_the_optimum():
    agent = RMaxParameters(kind="rmax", gamma=0.5, m=1, plan_every=1).create(SETTING)
    teach_all(agent, rounds=60)
    assert agent.q == pytest.approx(OPTIMAL)


@pytest.mark.parametrize(("task", "m"), [("navigation", 1), ("social", 5), ("go_to_human", 5)])
def test_rmax_has_the_papers_m(task, m):
    assert RMaxParameters(kind="rmax").create(SETTING._replace(task=task)).m == m
    assert RMaxParameters(kind="rmax", m=3).create(SETTING._replace(task=task)).m == 3


AGENTS = {
    "mb": ModelBasedParameters(kind="model_based", gamma=0.5, epsilon=0, plan_every=4),
    "mf": QLearningParameters(kind="q_learning", gamma=0.5, alpha=0.5, epsilon=0),
    "slow": QLearningParameters(kind="q_learning", gamma=0.5, alpha=0.1, epsilon=1),
}


def test_an_observer_learns_as_learner_then_as_actor_and_acts_only_then():
    parameters = ObserverParameters(kind="observer", watches="mb", learner="mf", until=4, acts_as="slow")
    agent = parameters.create(SETTING._replace(agents=AGENTS))
    teach_all(agent)
    assert agent.learner.q.tolist() == [[0, 0], [0.5, 0.125]]
    assert agent.watched.q.tolist() == [[0, 0], [1, 0]]
    random = random_state(0)
    assert {ask(agent, 1, 4, random) for _ in range(20)} == {(0, False)}
    assert {ask(agent, 1, 5, random) for _ in range(200)} == {(0, True), (1, True)}
    teach(agent, 1, 0, 1.0, 1, 5)  # alone: alpha 0.1, and the watched agent learns no more
    assert agent.learner.q[1, 0] == pytest.approx(0.5 + 0.1 * (1 + 0.25 - 0.5))
    assert agent.watched.model.visits.sum() == 4


def test_greedy_is_uniform_among_exact_maximisers():
    random, agent = random_state(1), GreedyTable(np.array([[1.0, 0.0, 1.0, 1.0]]))
    drawn = np.bincount([ask(agent, 0, 1, random)[0] for _ in range(6000)], minlength=4)
    assert drawn[1] == 0
    assert np.abs(drawn[[0, 2, 3]] - 2000).max() < 4.5 * np.sqrt(6000 * 2 / 9)


def test_exploring_is_uniform_over_all_actions():
    random = random_state(2)
    agent = QLearningParameters(kind="q_learning", epsilon=0.5).create(SETTING._replace(n_actions=4))
    agent.q[0, 2] = 1
    drawn = [ask(agent, 0, 1, random) for _ in range(8000)]
    explored = np.bincount([action for action, explored in drawn if explored], minlength=4)
    assert np.abs(explored - 1000).max() < 4.5 * np.sqrt(8000 * 7 / 64)
    assert {action for action, explored in drawn if not explored} == {2}


def test_chance_is_uniform():
    random, agent = random_state(3), RandomParameters(kind="random").create(SETTING._replace(n_actions=5))
    drawn = np.bincount([ask(agent, 0, 1, random)[0] for _ in range(10_000)])
    assert np.abs(drawn - 2000).max() < 4.5 * np.sqrt(10_000 * 4 / 25)


@pytest.mark.parametrize("name", ["mb", "mf"])
def test_saved_and_restored_goes_on_as_if_nothing_had_been(name):
    setting = SETTING._replace(n_states=40, n_actions=3)
    draw = np.random.default_rng(0)
    lessons = [
        (*draw.integers(0, (40, 3)), float(draw.random()), draw.integers(0, 40), step) for step in range(1, 3001)
    ]
    whole, first = (
        AGENTS[name].create(setting._replace(steps=3000)),
        AGENTS[name].create(setting._replace(steps=2000)),
    )
    for lesson in lessons:
        teach(whole, *lesson)
    for lesson in lessons[:2000]:
        teach(first, *lesson)
    second = AGENTS[name].restore(setting._replace(steps=1000), AGENTS[name].save(first))
    for lesson in lessons[2000:]:
        teach(second, *lesson)
    for key, value in AGENTS[name].save(whole).items():
        assert (AGENTS[name].save(second)[key] == value).all(), key
