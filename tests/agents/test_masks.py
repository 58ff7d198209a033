"""Agents that can be told what each action comes to value it, choose it and tell it as that."""

import numpy as np
import pytest

from visitlab_cli.agents.base import Setting, choose, choose_as
from visitlab_cli.agents.registry import KINDS
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.tasks import SOCIAL, TASKS

SIZE = TASKS[SOCIAL].size(None)
DRAW = np.random.default_rng(4)
MEANT = np.where(np.arange(30) < 24, DRAW.integers(0, 25, 30), np.arange(30))


@kernel
def chosen_as(record, state, meant, step, random):
    """As a controller asks, which is a kernel: one that makes arrays can't be asked so."""
    return choose_as(record, state, meant, step, random)


def agent_of(kind, **settings):
    """One with random values, and these as a table of all states."""
    parameters = KINDS[kind](kind=kind, **settings)
    setting = Setting(SOCIAL, *SIZE, 10)
    saved = parameters.save(parameters.create(setting))
    saved["q"] = DRAW.integers(0, 9, SIZE).astype(float)
    record = parameters.restore(setting, saved)
    return record, parameters.save(record)["q"]


@pytest.mark.parametrize(
    ("kind", "settings"),
    [
        ("q_learning", {"epsilon": 0}),
        ("model_based", {"epsilon": 0}),
        ("rmax", {}),
        ("scripted", {}),
        ("model_based", {"epsilon": 0, "symmetric": True, "unvisited": "zero"}),
    ],
)
def test_the_best_of_what_actions_come_to(kind, settings):
    assert KINDS[kind].takes_masks
    record, q = agent_of(kind, **settings)
    random = random_state(0)
    for state in range(0, 2560, 7):
        action, explored = chosen_as(record, state, MEANT, 1, random)
        assert action in MEANT
        assert q[state, action] == q[state, MEANT].max()
        assert not explored


ALONE = sorted(kind for kind in KINDS if KINDS[kind].takes_masks and kind != "observer")  # who watches others


@pytest.mark.parametrize("kind", ALONE)
def test_each_that_can_be_told_so_can_be_asked_by_a_controller(kind):
    record, _ = agent_of(kind, **{"epsilon": 0} if "epsilon" in KINDS[kind].model_fields else {})
    action, _ = chosen_as(record, 7, MEANT, 1, random_state(0))
    assert action in MEANT


@pytest.mark.parametrize("settings", [{}, {"symmetric": True}])
def test_what_is_explored_is_what_it_comes_to(settings):
    record, _ = agent_of("q_learning", epsilon=1, **settings)
    random = random_state(0)
    counts = np.zeros(30)
    for step in range(9000):
        action, explored = chosen_as(record, step % 2560, MEANT, 1, random)
        counts[action] += 1
        assert explored
    expected = np.bincount(MEANT, minlength=30) * 300
    np.testing.assert_allclose(counts, expected, atol=6 * np.sqrt(expected.max()))
    assert (counts[expected == 0] == 0).all()


def test_where_all_actions_come_to_themselves_nothing_changes():
    record, _ = agent_of("q_learning", epsilon=0.3)
    one, other = random_state(5), random_state(5)
    for state in range(500):
        assert choose(record, state, 1, one) == choose_as(record, state, np.arange(30), 1, other)


@pytest.mark.parametrize("kind", ["random"])
def test_others_say_that_they_can_not(kind):
    assert not KINDS[kind].takes_masks
