"""What the loop promises an agent: who draws its next action while learning acts on it, and knows a trial's end."""

from typing import NamedTuple

import numpy as np
import pytest

from tests.world.package_log import make_task
from visitlab_cli.agents import registry
from visitlab_cli.agents.base import CHOOSE, LEARN, AgentParameters
from visitlab_cli.agents.exploration import epsilon_greedy
from visitlab_cli.random_numbers import random_state
from visitlab_cli.simulation.loop import START, play
from visitlab_cli.world.columns import empty_columns
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import TASKS

STEPS = 600
NONE = -1


class Sarsa(NamedTuple):
    """On-policy: `kept` (1,) is the action drawn for the next step; `drawn` and `ended` note every step's."""

    q: np.ndarray
    kept: np.ndarray
    drawn: np.ndarray
    ended: np.ndarray


@CHOOSE.of(Sarsa)
def choose(agent, state, step, random):
    action = agent.kept[0]
    if action == -1:
        action, _ = epsilon_greedy(agent.q[state], 0.3, random)
    return action, False


@LEARN.of(Sarsa)
def learn(agent, state, action, reward, next_state, end, step, random):
    following, _ = epsilon_greedy(agent.q[next_state], 0.3, random)
    target = reward + 0.9 * agent.q[next_state, following]
    agent.q[state, action] += 0.5 * (target - agent.q[state, action])
    agent.kept[0] = -1 if end else following
    agent.drawn[step] = following
    agent.ended[step] = end


@pytest.mark.parametrize("task", list(TASKS))
def test_an_action_drawn_while_learning_is_the_next_one_but_for_a_trials_last(task):
    record = make_task(task)
    size = TASKS[task].size(paper_lab())
    agent = Sarsa(np.zeros(size), np.array([NONE]), np.full(STEPS + 1, NONE), np.zeros(STEPS + 1, bool))
    columns = empty_columns(2 * STEPS)
    _, rows = play(record, agent, START, STEPS, random_state(2, task), columns, np.zeros(STEPS))
    chosen = columns.action[:rows][columns.step[:rows] > 0]
    ends = np.arange(1, STEPS + 1) % record.trial_steps == 0
    assert agent.ended[1:].tolist() == ends.tolist()
    kept = ~ends[:-1]
    assert (agent.drawn[1:-1][kept] == chosen[1:][kept]).all()
    assert (agent.drawn[1:-1][~kept] != chosen[1:][~kept]).any()  # the next trial's first state is another matter


def test_every_file_of_the_folder_is_found_and_no_other_kind():
    assert set(registry.KINDS) == {
        "q_learning", "model_based", "rmax", "observer", "random", "scripted", "last_seen", "windowed", "forgetting",
        "coordinated", "prioritized_sweeping", "dyna", "multi_model",
    }  # fmt: skip
    assert all(issubclass(kind, AgentParameters) for kind in registry.KINDS.values())


def test_whose_counts_may_become_fewer_says_so():
    """So that nobody takes the difference of two of its models for what it met in between."""
    forget = {
        kind
        for kind in ("model_based", "windowed", "forgetting", "multi_model")
        if registry.KINDS[kind](kind=kind).forgets
    }
    assert forget == {"windowed", "forgetting", "multi_model"}
    assert registry.KINDS["model_based"](kind="model_based", prior_strength=20).forgets
