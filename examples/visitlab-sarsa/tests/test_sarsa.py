"""That SARSA keeps what agents promise, and that one update is what the equations say."""

from types import SimpleNamespace

import numpy as np
import pytest
import visitlab_sarsa

import visitlab_cli


def test_it_keeps_what_agents_promise():
    failed = [answer for answer in visitlab_cli.check_agent("sarsa_plain") if not answer.passed]
    assert not failed, failed


def test_an_error_is_spread_over_what_led_to_it():
    parameters = visitlab_sarsa.SarsaParameters(
        kind="sarsa_plain", alpha=0.5, gamma=0.8, epsilon=0.0, **{"lambda": 0.5}
    )
    agent = parameters.agent(SimpleNamespace(n_states=3, n_actions=2))
    random = np.random.default_rng(0)
    agent.learn(0, 1, 0.0, 1, False, random, 1)
    agent.learn(1, 0, 1.0, 2, False, random, 2)
    assert agent.q == pytest.approx(np.array([[0.0, 0.2], [0.5, 0.0], [0.0, 0.0]]))
    agent.learn(2, 0, 1.0, 0, True, random, 3)  # bootstraps from the greedy action of state 0, worth 0.2
    assert agent.q[2, 0] == pytest.approx(0.5 * (1 + 0.8 * 0.2))
    assert not agent.traces
    assert agent.drawn is None
