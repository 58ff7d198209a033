"""model_based that looks for what it seldom tried, against its rule in plain Python, on random steps."""

import re

import numpy as np
import pytest
from pydantic import ValidationError

from tests.agents.test_restated import ACTIONS, GAMMA, SETTING, STATES, STEPS, Plain, random_steps, teach
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.agents.symmetry import fold
from visitlab_cli.random_numbers import random_state

EVERY = 50
WAYS = [
    ({"exploration": "optimistic"}, 1.0, 0.0),
    ({"exploration": "count_bonus", "bonus": 0.5}, 0.5, 0.5),
]
"""Settings; what is supposed of a pair never tried, as a reward at each step; the bonus of one tried once."""
of_each = pytest.mark.parametrize(("settings", "supposed", "bonus"), WAYS, ids=["optimistic", "count_bonus"])


def made(**settings):
    return ModelBasedParameters(kind="model_based", gamma=GAMMA, plan_every=EVERY, **settings)


class Curious(Plain):
    """What was never tried keeps its value; R is the mean reward and a bonus."""

    def __init__(self, supposed, bonus):
        super().__init__()
        self.q[:] = supposed / (1 - GAMMA)
        self.bonus = bonus

    def backed_up(self, state, action, values):
        return super().backed_up(state, action, values) + self.bonus / self.n(state, action) ** 0.5

    def sweep(self):
        values = self.q.max(axis=1)
        for pair in np.ndindex(self.q.shape):
            if self.n(*pair) > 0:
                self.q[pair] = self.backed_up(*pair, values)


@of_each
def test_what_was_seldom_tried_is_worth_more(settings, supposed, bonus):
    parameters, plain = made(**settings), Curious(supposed, bonus)
    agent = parameters.create(SETTING)
    assert (agent.q == plain.q).all()
    teach(agent, random_steps(), random_state(0))
    for step, state, action, reward, following in random_steps():
        plain.outcomes[state, action].append((1, following, reward))
        if step % EVERY == 0:
            plain.sweep()
    np.testing.assert_allclose(agent.q, plain.q)
    assert agent.q[2, ACTIONS - 1] == supposed / (1 - GAMMA)
    saved = parameters.save(agent)
    assert parameters.fault(SETTING, saved) is None
    assert saved["reward_sums"].sum() == sum(reward for _, _, _, reward, _ in random_steps())
    assert saved.keys() == made().save(made().create(SETTING)).keys()
    assert parameters.updates_a_step(SETTING, saved) == (STATES * ACTIONS - 1) / EVERY


@of_each
def test_saved_and_restored_goes_on_as_if_nothing_had_been(settings, supposed, bonus):
    parameters, steps = made(**settings), list(random_steps())
    whole, first = parameters.create(SETTING), parameters.create(SETTING)
    teach(whole, steps, random_state(0))
    teach(first, steps[: STEPS // 2], random_state(0))
    second = parameters.restore(SETTING, {name: array.copy() for name, array in parameters.save(first).items()})
    teach(second, steps[STEPS // 2 :], random_state(0))
    for name, array in parameters.save(whole).items():
        np.testing.assert_array_equal(parameters.save(second)[name], array, name)


def bonuses_of(record):
    """What R has beside the mean reward, of pairs that were tried."""
    model, tried = record.model, record.model.visits > 0
    return (model.mean_rewards[tried] - model.reward_sums[tried] / model.visits[tried]), model.visits[tried]


def test_a_bonus_follows_counts_that_become_lighter_and_is_no_reward_to_forget():
    parameters = made(exploration="count_bonus", bonus=0.5, prior_strength=4)
    agent = parameters.create(SETTING)
    teach(agent, random_steps(), random_state(0))
    for most in (STEPS, 4):
        found, visits = bonuses_of(agent)
        assert 4 < visits.max() <= STEPS if most == STEPS else visits.max() == 4
        np.testing.assert_allclose(found, 0.5 / np.sqrt(visits))
        parameters.meet(agent, 1)
    parameters.forget_rewards(agent)
    tried = agent.model.visits > 0
    np.testing.assert_allclose(agent.model.mean_rewards[tried], 0.5 / np.sqrt(agent.model.visits[tried]))


@of_each
def test_who_starts_from_one_that_did_not_explore_so_does(settings, supposed, bonus):
    other = made().create(SETTING)
    teach(other, random_steps(), random_state(0))
    saved = made().save(other)
    agent = made(**settings).restore(SETTING, saved)
    assert agent.q[2, ACTIONS - 1] == supposed / (1 - GAMMA)
    assert (agent.q == saved["q"]).sum() == agent.q.size - 1
    found, visits = bonuses_of(agent)
    np.testing.assert_allclose(found, bonus / np.sqrt(visits), atol=1e-12)


@of_each
def test_a_pool_is_swept_by_the_same_rule(settings, supposed, bonus):
    parameters = made(**settings)
    agent = parameters.create(SETTING)
    teach(agent, random_steps(), random_state(0))
    pooled = parameters.pooled(SETTING, [parameters.save(agent)] * 2, 10)
    plain = Curious(supposed, bonus)
    for _, state, action, reward, following in random_steps():
        plain.outcomes[state, action].append((1, following, reward))
    for pair in np.ndindex(STATES, ACTIONS):
        n = plain.n(*pair)
        plain.outcomes[pair] = [(min(10 / n, 2), *rest) for _, *rest in plain.outcomes[pair]]
    for _ in range(300):
        plain.sweep()
    np.testing.assert_allclose(pooled["q"], plain.q, rtol=0.8**40)


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"exploration": "count_bonus"}, "exploration: count_bonus goes with a bonus, and only that does"),
        ({"exploration": "optimistic", "bonus": 0.1}, "exploration: count_bonus goes with a bonus, and only that does"),
        ({"exploration": "optimistic", "unvisited": "zero"}, "unvisited means nothing with exploration: optimistic"),
        ({"symmetric": True}, "symmetric goes with unvisited: zero only"),
    ],
)
def test_settings_that_mean_nothing_together_are_told(settings, told):
    with pytest.raises(ValidationError, match=re.escape(told)):
        made(**settings)


def test_it_learns_symmetric_states_as_one_without_more_ado():
    record = made(symmetric=True, **WAYS[0][0]).create(SETTING._replace(n_states=2560, n_actions=30))
    assert record.inner.q.shape == (len(fold().kept), 30)
    assert (record.inner.q == 1 / (1 - GAMMA)).all()
    assert not record.inner.fill_unvisited


def test_who_takes_what_was_never_tried_for_worthless_goes_on_from_nobody_who_hopes():
    for settings, *_ in WAYS:
        curious = made(**settings)
        assert made(unvisited="zero").goes_on_from(curious) is not None
        assert made().goes_on_from(curious) is curious.goes_on_from(made(unvisited="zero")) is None
