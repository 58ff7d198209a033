"""SARSA(lambda), one file, on a chain of five states: as a second computation has it, compiled and not."""

import os
import subprocess
import sys

import numpy as np
import pytest

from tests.agents.sarsa_lambda import SarsaLambdaParameters
from visitlab_cli.agents.base import Setting, choose, learn
from visitlab_cli.agents.exploration import epsilon_greedy
from visitlab_cli.compiled import JIT_DISABLED, kernel
from visitlab_cli.random_numbers import random_state

STATES, ACTIONS, TRIAL, STEPS = 5, 2, 12, 1200
GAMMA, EPSILON, ALPHA, LAMBDA = 0.75, 0.25, 0.125, 0.5
PARAMETERS = {"gamma": GAMMA, "epsilon": EPSILON, "alpha": ALPHA, "lambda": LAMBDA}


@kernel
def after(state, action):
    """Action 1 goes right, 0 left; at the right end is a reward."""
    state = min(state + 1, 4) if action == 1 else max(state - 1, 0)
    return state, 1.0 if state == 4 else 0.0


@kernel
def play(agent, steps, random, chosen):
    state = 0
    for step in range(1, steps + 1):
        action = choose(agent, state, step, random)[0]
        chosen[step - 1] = action
        next_state, reward = after(state, action)
        learn(agent, state, action, reward, next_state, step % TRIAL == 0, step, random)
        state = 0 if step % TRIAL == 0 else next_state


def second(steps, random):
    """The forward view: what each pair is owed is summed over the later errors of its trial, without traces."""
    q, chosen, drawn, state, path = np.zeros((STATES, ACTIONS)), [], None, 0, []
    for step in range(1, steps + 1):
        action = epsilon_greedy(q[state], EPSILON, random)[0] if drawn is None else drawn
        chosen.append(action)
        next_state, reward = after(state, action)
        drawn = epsilon_greedy(q[next_state], EPSILON, random)[0]
        path.append((state, action))
        error = reward + GAMMA * q[next_state, drawn] - q[state, action]
        for age, pair in enumerate(reversed(path)):
            q[pair] += ALPHA * error * (GAMMA * LAMBDA) ** age
        state = next_state
        if step % TRIAL == 0:
            path, drawn, state = [], None, 0
    return q, chosen


def played(steps=STEPS, **settings):
    agent = SarsaLambdaParameters(kind="sarsa_lambda", **PARAMETERS | settings).create(
        Setting("navigation", STATES, ACTIONS, steps)
    )
    chosen = np.zeros(steps, np.int64)
    play(agent, steps, random_state(5, "sarsa"), chosen)
    return agent, chosen


@pytest.mark.slow
def test_it_is_what_a_second_computation_without_traces_has():
    agent, chosen = played()
    q, expected = second(STEPS, random_state(5, "sarsa"))
    assert chosen.tolist() == expected
    assert agent.q == pytest.approx(q, rel=1e-9)
    assert agent.q[3].argmax() == 1
    assert (agent.following[0], agent.traces.any()) == (-1, False)  # it ends with a trial's end


@pytest.mark.slow
def test_without_chance_it_comes_to_the_closed_form_of_the_policy_that_it_settles_on():
    """V = R + gamma P V; not the optimum: with epsilon 0 it may go back and forth at the right end."""
    agent, _ = played(60_000, epsilon=0.0, alpha=0.25)
    moves = [after(state, int(agent.q[state].argmax())) for state in range(STATES)]
    follows = np.eye(STATES)[[state for state, _ in moves]]
    values = np.linalg.solve(np.eye(STATES) - GAMMA * follows, [reward for _, reward in moves])
    assert agent.q.max(axis=1) == pytest.approx(values, rel=1e-6)


@pytest.mark.slow
@pytest.mark.skipif(JIT_DISABLED, reason="this is what is compared with it")
def test_it_is_the_same_uncompiled():
    code = "from tests.agents.test_sarsa_lambda import played; a, c = played(); print(a.q.tobytes().hex(), c.tolist())"
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, check=True)
    agent, chosen = played()
    assert done.stdout.strip() == f"{agent.q.tobytes().hex()} {chosen.tolist()}"
