"""What several trainings have learned as one model, and old counts that count for less."""

from collections import Counter, defaultdict

import numpy as np
import pytest

from visitlab_cli.agents.base import Setting, learn
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.agents.sparse_model import pooled_models
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import random_state

STATES, ACTIONS, STEPS = 6, 2, 900
SETTING = Setting("visit", STATES, ACTIONS, STEPS)
MB = ModelBasedParameters(kind="model_based", plan_every=10)
CAPPED = ModelBasedParameters(kind="model_based", plan_every=10, prior_strength=20)


@kernel
def taught(agent, state, action, reward, next_state, step, random):
    learn(agent, state, action, reward, next_state, False, step, random)


def steps(seed):
    """Of each of the states 0 to 4 some: many of 0, few of 3; and of 4 only with one seed."""
    draw = np.random.default_rng(seed)
    for _ in range(STEPS):
        state = int(min(draw.geometric(0.6) - 1, 4 if seed == 1 else 3))
        action = int(draw.integers(ACTIONS))
        following = int((state + action + draw.integers(2) + seed) % STATES)
        yield state, action, float(following == 3), following


def trained(parameters, seed):
    agent, random = parameters.create(SETTING), random_state(seed, "test")
    for step, transition in enumerate(steps(seed), 1):
        taught(agent, *transition, step, random)
    return parameters.save(agent)


def model_of(saved):
    """Reward sums, and how often what followed, by pair."""
    rows = zip(saved["successor_offsets"][:-1], saved["successor_offsets"][1:], strict=True)
    followed = [
        dict(zip(saved["successor_states"][a:b].tolist(), saved["successor_counts"][a:b].tolist(), strict=True))
        for a, b in rows
    ]
    return saved["reward_sums"].ravel(), followed


@pytest.mark.parametrize("strength", [1, 20, 1000])
def test_a_pool_weighs_pairs_by_what_each_knows_and_is_swept_until_it_fits(strength):
    wanted, rewards = defaultdict(Counter), Counter()
    for seed in (1, 2, 3):
        n = Counter((state, action) for state, action, _, _ in steps(seed))
        for state, action, reward, following in steps(seed):
            weight = min(n[state, action], 100) / n[state, action]
            wanted[state * ACTIONS + action][following] += weight
            rewards[state * ACTIONS + action] += weight * reward
    several = [trained(MB, seed) for seed in (1, 2, 3)]
    pooled = MB.pooled(SETTING, several, strength)
    sums, followed = model_of(pooled)
    for pair in range(STATES * ACTIONS):
        total = wanted[pair].total()
        share = min(total, strength) / total if total else 0
        assert pooled["visits"].ravel()[pair] == pytest.approx(min(total, strength))
        assert followed[pair] == pytest.approx({state: share * n for state, n in wanted[pair].items()})
        assert sums[pair] == pytest.approx(share * rewards[pair])
    q = np.mean([each["q"] for each in several], axis=0)
    for _ in range(40):
        values = q.max(axis=1)
        untried = 0.9 * values.mean()
        q = np.array(
            [
                [
                    (
                        rewards[pair] / wanted[pair].total()
                        + 0.9 * sum(n * values[s] for s, n in wanted[pair].items()) / wanted[pair].total()
                    )
                    if wanted[pair]
                    else untried
                    for pair in range(state * ACTIONS, (state + 1) * ACTIONS)
                ]
                for state in range(STATES)
            ]
        )
    np.testing.assert_allclose(pooled["q"], q, rtol=1e-9)
    assert MB.taking_in_a_pool().fault(SETTING, pooled) is None


def test_a_pool_by_hand():
    """300 and 50 visits of a pair: of 100 and 50 that count, twenty are left."""
    often = {"visits": 300, "reward_sums": 60, "followed": {0: 270, 1: 30}}
    seldom = {"visits": 50, "reward_sums": 25, "followed": {1: 40, 2: 10}}
    several = [
        {
            "q": np.full((3, 1), value),
            "visits": np.array([[each["visits"]], [0], [0]]),
            "reward_sums": np.array([[each["reward_sums"]], [0], [0]], float),
            "successor_offsets": np.array([0, 2, 2, 2]),
            "successor_states": np.array(list(each["followed"]), np.int32),
            "successor_counts": np.array(list(each["followed"].values()), np.int32),
        }
        for each, value in ((often, 1.0), (seldom, 3.0))
    ]
    pooled = pooled_models(several, 20)
    assert pooled["visits"].tolist() == [[20], [0], [0]]
    assert pooled["successor_states"].tolist() == [0, 1, 2]
    assert pooled["successor_counts"] == pytest.approx(np.array([90, 10 + 40, 10]) * 20 / 150)
    assert pooled["reward_sums"][0, 0] == pytest.approx((20 + 25) * 20 / 150)


def test_another_human_finds_old_counts_scaled_and_the_same_means():
    saved = trained(CAPPED, 1)
    record = CAPPED.restore(SETTING, saved)
    CAPPED.meet(record, 0)
    met = CAPPED.save(record)
    assert (saved["visits"] > 20).any()
    assert ((saved["visits"] > 0) & (saved["visits"] < 20)).any()
    assert np.array_equal(met["visits"], np.minimum(saved["visits"], 20))
    tried = saved["visits"] > 0
    sums, visits = (saved[name][tried] for name in ("reward_sums", "visits"))
    np.testing.assert_allclose(met["reward_sums"][tried] / met["visits"][tried], sums / visits)
    for before, after, n in zip(model_of(saved)[1], model_of(met)[1], saved["visits"].ravel(), strict=True):
        assert after == pytest.approx({state: times * min(1, 20 / n) for state, times in before.items()})
    assert np.array_equal(met["q"], saved["q"])
    assert CAPPED.fault(SETTING, met) is None


def test_without_prior_strength_nobody_new_changes_anything():
    record = MB.restore(SETTING, trained(MB, 1))
    MB.meet(record, 1)
    assert all(np.array_equal(a, b) for a, b in zip(MB.save(record).values(), trained(MB, 1).values(), strict=True))
