"""The agents that plan on a learned model in their own ways, each against its rule in plain Python, on random steps."""

from collections import Counter, defaultdict

import numpy as np
import pytest

from visitlab_cli.agents.base import Setting, choose, learn
from visitlab_cli.agents.coordinated import CoordinatedParameters
from visitlab_cli.agents.dyna import DynaParameters
from visitlab_cli.agents.forgetting import ForgettingParameters
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.agents.prioritized_sweeping import PrioritizedSweepingParameters
from visitlab_cli.agents.windowed import WindowedParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import random_below, random_state

STATES, ACTIONS, STEPS, GAMMA = 7, 3, 600, 0.8
SETTING = Setting("social", STATES, ACTIONS, STEPS)
SHARED = {"gamma": GAMMA, "epsilon": 0.1}


def random_steps():
    """Every state has few successors, which change half-way; the last state is only met then, some pairs never."""
    draw = np.random.default_rng(5)
    for step in range(1, STEPS + 1):
        late = step > STEPS // 2
        state = int(draw.integers(0, STATES if late else STATES - 1))
        action = int(draw.integers(0, ACTIONS - (state == 2)))
        following = int((state + action + draw.integers(0, 3) + 2 * late) % STATES)
        yield step, state, action, float(draw.integers(0, 3) * (following == 3)), following


@kernel
def taught(agent, state, action, reward, next_state, step, random):
    learn(agent, state, action, reward, next_state, False, step, random)


def teach(agent, steps, random):
    for step, state, action, reward, following in steps:
        taught(agent, state, action, reward, following, step, random)


class Plain:
    """Outcomes of each pair with their weights, and a sweep."""

    def __init__(self):
        self.q = np.zeros((STATES, ACTIONS))
        self.outcomes = defaultdict(list)  # of a pair: [weight, next state, reward]

    def n(self, state, action):
        return sum(weight for weight, _, _ in self.outcomes[state, action])

    def model(self, state, action):
        n, likely = self.n(state, action), Counter()
        for weight, following, _ in self.outcomes[state, action]:
            likely[following] += weight / n
        return sum(weight * reward for weight, _, reward in self.outcomes[state, action]) / n, likely

    def backed_up(self, state, action, values):
        reward, likely = self.model(state, action)
        return reward + GAMMA * sum(share * values[following] for following, share in likely.items())

    def sweep(self):
        values = self.q.max(axis=1)
        for pair in np.ndindex(self.q.shape):
            self.q[pair] = self.backed_up(*pair, values) if self.n(*pair) > 0 else GAMMA * values.mean()


@pytest.mark.parametrize("k", [1, 4])
def test_windowed_knows_the_last_k_outcomes_of_each_pair(k):
    parameters, plain = WindowedParameters(kind="windowed", k=k, plan_every=50, **SHARED), Plain()
    agent = parameters.create(SETTING)
    teach(agent, random_steps(), random_state(0))
    for step, state, action, reward, following in random_steps():
        plain.outcomes[state, action] = [*plain.outcomes[state, action], (1, following, reward)][-k:]
        if step % 50 == 0:
            plain.sweep()
    np.testing.assert_allclose(agent.q, plain.q)
    saved = parameters.save(agent)
    assert parameters.fault(SETTING, saved) is None
    assert saved["window_states"].tolist() == [
        outcome[1] for pair in np.ndindex(STATES, ACTIONS) for outcome in plain.outcomes[pair]
    ]
    wrong = {**saved, "window_states": np.roll(saved["window_states"], 1)}
    assert "windows" in parameters.fault(SETTING, wrong)
    shorter = parameters.model_copy(update={"k": 2}).restore(SETTING, saved)
    assert shorter.model.visits.max() == min(k, 2)
    for pair in np.ndindex(STATES, ACTIONS):
        last = plain.outcomes[pair][-2:]
        assert shorter.model.reward_sums[pair[0] * ACTIONS + pair[1]] == sum(reward for _, _, reward in last)


@pytest.mark.parametrize("k", [1, 4])
def test_forgetting_scales_what_a_pair_knew_at_each_of_its_outcomes(k):
    parameters, plain = ForgettingParameters(kind="forgetting", k=k, plan_every=50, **SHARED), Plain()
    agent = parameters.create(SETTING)
    teach(agent, random_steps(), random_state(0))
    for step, state, action, reward, following in random_steps():
        old = [((1 - 1 / k) * weight, *rest) for weight, *rest in plain.outcomes[state, action]]
        plain.outcomes[state, action] = [*old, (1, following, reward)]
        if step % 50 == 0:
            plain.sweep()
    np.testing.assert_allclose(agent.q, plain.q)
    saved = parameters.save(agent)
    assert parameters.fault(SETTING, saved) is None
    again = parameters.model_copy(update={"k": 2}).restore(SETTING, saved)
    np.testing.assert_allclose(again.model.visits, np.minimum(saved["visits"].ravel(), 2))
    np.testing.assert_allclose(again.model.mean_rewards, agent.model.mean_rewards)


def test_coordinated_lets_the_cheap_expert_act_where_both_agree_and_sweeps_only_for_the_other():
    parameters, plain = CoordinatedParameters(kind="coordinated", threshold=0.5, plan_every=20, **SHARED), Plain()
    agent = parameters.create(SETTING)
    teach(agent, random_steps(), random_state(0))
    free, agreement, controlled, sweeps = np.zeros((STATES, ACTIONS)), np.zeros(STATES), 0, 0
    for _, state, action, reward, following in random_steps():
        dear = agreement[state] < 0.5
        same = free[state].argmax() == plain.q[state].argmax() and free[state].max() > 0
        agreement[state] += 0.1 * (same - agreement[state])
        free[state, action] += 0.1 * (reward + GAMMA * free[following].max() - free[state, action])
        plain.outcomes[state, action].append((1, following, reward))
        controlled += dear
        if dear and controlled % 20 == 0:
            plain.sweep()
            sweeps += 1
    assert 0 < controlled < STEPS
    saved = parameters.save(agent)
    assert (saved["controlled"][0], saved["sweeps"][0]) == (controlled, sweeps)
    np.testing.assert_allclose(saved["agreement"].ravel(), agreement)
    np.testing.assert_allclose(saved["q_free"], free)
    np.testing.assert_allclose(agent.q, plain.q)


OFTEN, SELDOM = {"gamma": 0.5, "epsilon": 0}, {"gamma": 0.5, "epsilon": 0, "plan_every": 1}
FADED = 1 / 2 + 1 / 4 + 1 / 8 + 1 / 16
"""What four outcomes weigh, of which each fades by a half at each later one."""
KNOWN = 259 / 216
"""What the state is worth after four outcomes, the other state as much as what was never tried: 1 + V / 6 each time."""
CHANGED = [
    (ModelBasedParameters(kind="model_based", unvisited="zero", **SELDOM), 4 / 5 + 1 / 2 * 1 / 5),
    (ModelBasedParameters(kind="model_based", unvisited="zero", prior_strength=2, **SELDOM), 2 / 3 + 1 / 2 * 1 / 3),
    (ModelBasedParameters(kind="model_based", exploration="optimistic", **SELDOM), 4 / 5 + 1 / 2 * 2),
    (
        ModelBasedParameters(kind="model_based", exploration="count_bonus", bonus=0.5, **SELDOM),
        4 / 5 + 0.5 / 5**0.5 + 1 / 2 * (4 / 5 * 1 + 1 / 5 * 1.75),
    ),
    (WindowedParameters(kind="windowed", k=2, unvisited="zero", **SELDOM), 1 / 2 + 1 / 2 * 1 / 2),
    (
        ForgettingParameters(kind="forgetting", k=2, unvisited="zero", **SELDOM),
        (FADED + 1 / 2) / (1 + FADED),
    ),
    (CoordinatedParameters(kind="coordinated", rate=1, unvisited="zero", **SELDOM), 1.0),  # its model is not swept
    (
        PrioritizedSweepingParameters(kind="prioritized_sweeping", backups=1, **OFTEN),
        4 / 5 + 1 / 2 * (4 / 5 * KNOWN / 3 + 1 / 5 * KNOWN),
    ),
    (DynaParameters(kind="dyna", backups=1, **OFTEN), 4 / 5 + 1 / 2 * (4 / 5 * KNOWN / 3 + 1 / 5 * KNOWN)),
]


@pytest.mark.parametrize(("parameters", "worth"), CHANGED, ids=lambda each: getattr(each, "kind", ""))
def test_a_chain_of_two_states_that_changes_after_four_steps_by_hand(parameters, worth):
    """One action: from state 1 to 0 with a reward of 1, four times; then another human comes, and it stays in 1."""
    agent, random = parameters.create(Setting("social", 2, 1, 10)), random_state(0)
    teach(agent, [(step, 1, 0, 1.0, 0) for step in range(1, 5)], random)
    parameters.meet(agent, 1)
    teach(agent, [(5, 1, 0, 0.0, 1)], random)
    assert agent.q[1, 0] == pytest.approx(worth, rel=1e-12)
    if isinstance(parameters, CoordinatedParameters):
        saved = parameters.save(agent)
        assert (saved["controlled"][0], saved["sweeps"][0]) == (2, 2)  # both agree from the third step on
        assert saved["q_free"][1, 0] == pytest.approx((1 - 0.9**4) * 0.95)


@pytest.mark.parametrize("parameters", [each for each, _ in CHANGED], ids=lambda each: each.kind)
def test_no_agent_knows_who_is_there(parameters):
    """Named wrongly, in its cell's path and by its number, another human changes nothing but that one comes."""
    saved = []
    for path, human in (("visit/fast/seed-0000", 1), ("visit/slow/seed-0000", 7)):
        agent, random = parameters.create(SETTING._replace(cell=path)), random_state(0)
        teach(agent, list(random_steps())[:300], random)
        parameters.meet(agent, human)
        teach(agent, list(random_steps())[300:], random)
        saved.append(parameters.save(agent))
    assert all((saved[0][name] == saved[1][name]).all() for name in saved[0])


@kernel
def asked(agent, state, random):
    return choose(agent, state, 1, random)


def test_where_both_agree_the_model_free_expert_acts():
    parameters = CoordinatedParameters(kind="coordinated", threshold=0.5, plan_every=20, gamma=GAMMA, epsilon=0)
    agent, random = parameters.create(SETTING), random_state(0)
    agent.q[:, 0] = agent.q_free[:, 2] = 1.0
    agent.agreement[3] = 0.5
    assert [asked(agent, state, random)[0] for state in range(STATES)] == [0, 0, 0, 2, 0, 0, 0]


class PlainKnown(Plain):
    """Values of single states, and u, what was never tried is worth, by repetition instead of by the formula."""

    def __init__(self):
        super().__init__()
        self.values = {}

    def u(self):
        u = 0.0
        for _ in range(200):
            u = GAMMA * (sum(self.values.values()) + u * (STATES - len(self.values))) / STATES
        return u

    def back_up(self, state, action):
        u = self.u()
        self.q[state, action] = self.backed_up(state, action, [max(self.values.get(s, u), u) for s in range(STATES)])

    def value(self, state, u):
        for action in range(ACTIONS):
            if self.n(state, action) == 0:
                self.q[state, action] = u
        before, self.values[state] = self.values.get(state, 0.0), self.q[state].max()
        return abs(self.values[state] - before)


@pytest.mark.parametrize("backups", [1, 3])
def test_prioritized_sweeping_backs_up_the_states_of_the_largest_priority(backups):
    parameters = PrioritizedSweepingParameters(kind="prioritized_sweeping", backups=backups, theta=0.01, **SHARED)
    agent, plain, priorities = parameters.create(SETTING), PlainKnown(), {}
    teach(agent, random_steps(), random_state(0))
    for _, state, action, reward, following in random_steps():
        plain.outcomes[state, action].append((1, following, reward))
        priorities[state] = np.inf
        for _ in range(min(backups, STATES)):
            if not priorities:
                break
            top = max(priorities, key=priorities.get)
            del priorities[top]
            u = plain.u()
            for each in range(ACTIONS):
                if plain.n(top, each):
                    plain.back_up(top, each)
            change = plain.value(top, u)
            for pair in np.ndindex(STATES, ACTIONS):
                priority = GAMMA * change * plain.model(*pair)[1][top] if plain.n(*pair) else 0.0
                if priority > 0.01:
                    priorities[pair[0]] = max(priority, priorities.get(pair[0], 0.0))
    np.testing.assert_allclose(agent.q, plain.q)
    saved = parameters.save(agent)
    np.testing.assert_allclose(saved["priorities"], [priorities.get(state, 0.0) for state in range(STATES)])
    again = parameters.restore(SETTING, {name: array.copy() for name, array in saved.items()})
    teach(agent, random_steps(), random_state(0))
    teach(again, random_steps(), random_state(0))
    np.testing.assert_allclose(agent.q, again.q)


@pytest.mark.parametrize("updates", ["expected", "sampled"])
def test_dyna_updates_the_pair_just_tried_and_others_that_were(updates):
    parameters = DynaParameters(kind="dyna", backups=3, updates=updates, **SHARED)
    agent, plain, tried, random = parameters.create(SETTING), PlainKnown(), [], random_state(1)
    teach(agent, random_steps(), random_state(1))
    for _, state, action, reward, following in random_steps():
        plain.outcomes[state, action].append((1, following, reward))
        tried += [(state, action)] * ((state, action) not in tried)
        sample = (state, action), reward, following
        for number in range(3):
            if number > 0:
                pair = tried[random_below(random, len(tried))]
                seen = Counter(following for _, following, _ in plain.outcomes[pair])  # in the order of the first
                drawn = random_below(random, plain.n(*pair)) if updates == "sampled" else 0
                sample = pair, plain.model(*pair)[0], list(seen.elements())[drawn]
            pair, paid, there = sample
            u = plain.u()
            if updates == "sampled":
                plain.q[pair] += 0.1 * (paid + GAMMA * max(plain.values.get(there, u), u) - plain.q[pair])
            else:
                plain.back_up(*pair)
            plain.value(pair[0], u)
    np.testing.assert_allclose(agent.q, plain.q)


@pytest.mark.parametrize(
    "parameters",
    [
        WindowedParameters(kind="windowed", k=5, plan_every=50),
        ForgettingParameters(kind="forgetting", k=10**6, plan_every=50),
        CoordinatedParameters(kind="coordinated", threshold=0.5, plan_every=50),
    ],
    ids=lambda parameters: parameters.kind,
)
def test_saved_and_restored_goes_on_as_if_nothing_had_been(parameters):
    steps, half = list(random_steps()), STEPS // 2
    whole, first = parameters.create(SETTING), parameters.create(SETTING)
    teach(whole, steps, random_state(0))
    teach(first, steps[:half], random_state(0))
    second = parameters.restore(SETTING, {name: array.copy() for name, array in parameters.save(first).items()})
    teach(second, steps[half:], random_state(0))
    for name, array in parameters.save(whole).items():
        np.testing.assert_array_equal(parameters.save(second)[name], array, name)
