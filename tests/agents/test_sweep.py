"""A sweep of a learned model, bit for bit as the rule says it pair by pair."""

import numpy as np
import pytest

from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.sparse_model import AT_ONCE, empty_model, follow, sweep
from visitlab_cli.compiled import kernel

STATES, ACTIONS = 700, 9  # some blocks of pairs, the last one not full
GAMMA = 0.9
UNTRIED, BARELY = 0.4, 0.1
"""Which shares of the pairs were never tried, and less than once."""


@kernel
def followed(model, pair, next_state, n):
    follow(model, pair, next_state, n)


def drawn_model(kind, seed):
    """Pairs with none to seven successors, in weights that are no whole numbers where the kind has these."""
    draw = np.random.default_rng(seed)
    model = empty_model(Setting("social", STATES, ACTIONS, 100_000), kind)
    whole = np.issubdtype(kind, np.integer)
    for pair in np.flatnonzero(draw.random(STATES * ACTIONS) > UNTRIED):
        for state in draw.choice(STATES, size=draw.integers(1, 8), replace=False):
            n = kind(draw.integers(1, 5) if whole else draw.random() * 3)
            followed(model, pair, state, n)
            model.visits[pair] += n
        if not whole and draw.random() < BARELY:
            model.visits[pair] = 0.5
        model.mean_rewards[pair] = draw.random()
    return model


def plain_sweep(model, q, known, fill_unvisited):
    values = [max(row) for row in q]
    total = 0.0
    for value in values:
        total += value
    for pair in range(q.size):
        visits, state, action = model.visits[pair], *divmod(pair, ACTIONS)
        if visits >= known:
            expected, first = 0.0, model.first[pair]
            for place in range(first, first + model.length[pair]):
                expected += model.pool_counts[place] * values[model.pool_states[place]]
            q[state, action] = model.mean_rewards[pair] + GAMMA * expected / visits
        elif fill_unvisited and visits == 0:
            q[state, action] = GAMMA * (total / STATES)


@pytest.mark.parametrize(("kind", "known", "fills"), [(np.int32, 1, True), (np.int32, 5, False), (np.float64, 1, True)])
def test_a_sweep_has_the_bits_of_the_rule_pair_by_pair(kind, known, fills):
    assert STATES * ACTIONS % AT_ONCE
    model = drawn_model(kind, 0)
    q = np.random.default_rng(1).random((STATES, ACTIONS))
    expected, values = q.copy(), np.zeros(STATES)
    for _ in range(3):
        sweep(model, q, values, GAMMA, known, fills)
        plain_sweep(model, expected, known, fills)
        np.testing.assert_array_equal(q, expected)


def test_a_pair_that_was_tried_and_is_not_known_keeps_its_value():
    model, q = drawn_model(np.float64, 2), np.random.default_rng(3).random((STATES, ACTIONS))
    before, barely = q.copy().ravel(), (model.visits > 0) & (model.visits < 1)
    assert barely.any()
    sweep(model, q, np.zeros(STATES), GAMMA, 1, True)
    np.testing.assert_array_equal(q.ravel()[barely], before[barely])
