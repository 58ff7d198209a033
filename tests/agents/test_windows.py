"""What a window's oldest outcome leaves behind, against taking it away and counting the new one, to the bit."""

import numpy as np
import pytest

from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.sparse_model import count, empty_model, saved_model, uncount
from visitlab_cli.agents.windowed import Windows, count_in_window
from visitlab_cli.compiled import kernel

SETTING = Setting("social", 6, 2, 4000)
PAIRS = SETTING.n_states * SETTING.n_actions


@kernel
def windowed(model, windows, pairs, rewards, states):
    for i in range(len(pairs)):
        count_in_window(model, windows, pairs[i], rewards[i], states[i])


@kernel
def one_after_the_other(model, gone, pairs, rewards, states):
    for i in range(len(pairs)):
        if gone[i] >= 0:
            uncount(model, pairs[i], rewards[gone[i]], states[gone[i]])
        count(model, pairs[i], rewards[i], states[i])


@pytest.mark.parametrize("k", [1, 2, 7])
def test_an_outcome_for_the_oldest_is_to_the_bit_one_taken_away_and_one_counted(k):
    random = np.random.default_rng(k)
    pairs = random.integers(PAIRS, size=SETTING.steps)
    states = np.minimum(random.geometric(0.4, SETTING.steps) - 1, SETTING.n_states - 1)
    rewards = random.normal(size=SETTING.steps)
    held, gone = {pair: [] for pair in range(PAIRS)}, np.full(SETTING.steps, -1)
    for i, pair in enumerate(pairs):
        gone[i] = held[pair].pop(0) if len(held[pair]) == k else -1
        held[pair].append(i)
    expected, found = empty_model(SETTING), empty_model(SETTING)
    windows = Windows(np.zeros((PAIRS, k), np.int32), np.zeros((PAIRS, k)), np.zeros(PAIRS, np.int32))
    one_after_the_other(expected, gone, pairs, rewards, states)
    windowed(found, windows, pairs, rewards, states)
    kept = saved_model(expected, SETTING.n_actions) | {"mean_rewards": expected.mean_rewards}
    for name, array in (saved_model(found, SETTING.n_actions) | {"mean_rewards": found.mean_rewards}).items():
        assert array.tobytes() == kept[name].tobytes(), name
    for pair, last in held.items():
        rows = np.roll(windows.states[pair], -windows.oldest[pair])[: len(last)]
        assert np.array_equal(rows, states[last])
