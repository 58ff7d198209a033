"""Affordances as intents: what affords, what is planned and what a sweep costs, a second way on a small model."""

from collections import Counter, defaultdict

import numpy as np
import pytest

from tests.pictures.within import beyond, words_of
from visitlab_cli.affordances.intents import INTENTS, Intent, affording, chances, entries, planned
from visitlab_cli.affordances.intents_picture import draw_intents
from visitlab_cli.affordances.restricted import ALL, PairSet, Restricted, restricted
from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.sparse_model import count, empty_model, saved_model
from visitlab_cli.errors import NotFoundError
from visitlab_cli.pictures.style import STYLE, styled
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.selection import Selection
from visitlab_cli.storage.run_folder import read_config
from visitlab_cli.world.enums import N_SOCIAL_ACTIONS, Action

N_STATES = 2560
SETTING = Setting("social", N_STATES, N_SOCIAL_ACTIONS, 20_000)
GAMMA = 0.9


def state(level, distance, desired, angle):
    return level + 8 * (distance + 5 * (desired + 8 * angle))


def wanted(before, after):
    """The intents that come about, by the words of their definitions; states are (level, distance, desired, angle)."""
    found = set()
    if before[0] in {0, 1, 3} and after[0] in {2, 4, 5, 6, 7}:
        found.add(Intent.FACES)
    if before[1] in {0, 4} and after[1] in {1, 2, 3}:
        found.add(Intent.NEARS)
    if (before[0] < 5 and after[0] >= 5) or (before[0] == 5 and after[0] in {6, 7}) or (before[0], after[0]) == (6, 7):
        found.add(Intent.ADVANCES)
    if before[0] == 7 and after[0] == 7 and after[1] in {1, 2, 3}:
        found.add(Intent.KEEPS)
        if (after[3] + 4) % 8 == before[2]:
            found.add(Intent.LEADS)
    return found


@pytest.fixture(scope="module")
def seen():
    """Transitions among a few states, ((state, action), reward, next state), and the model that counted them."""
    random = np.random.default_rng(1)
    pool = [tuple(map(int, random.integers((8, 5, 2, 8)))) for _ in range(60)]
    pool += [(7, int(random.integers(5)), 0, int(random.choice([4, 3]))) for _ in range(30)]
    model = empty_model(SETTING)
    steps = []
    for _ in range(6_000):
        before, after = (pool[index] for index in random.integers(len(pool), size=2))
        action = int(random.choice([Action.STAY, Action.HELLO, Action.COME]))
        if random.random() < 0.5:  # often the same, so that some affordances are sure
            after = pool[(pool.index(before) + action) % len(pool)]
        reward = float(before[0] == 7 and random.random() < 0.3)
        steps.append((before, action, reward, after))
        count(model, state(*before) * N_SOCIAL_ACTIONS + action, reward, state(*after))
    return steps, saved_model(model, N_SOCIAL_ACTIONS)


@pytest.fixture(scope="module")
def by_hand(seen):
    """For each pair: how often it was tried, what followed how often, its rewards, the chance of each intent."""
    tried, after, rewards, brought = Counter(), defaultdict(Counter), Counter(), defaultdict(Counter)
    for before, action, reward, then in seen[0]:
        pair = state(*before), action
        tried[pair] += 1
        after[pair][state(*then)] += 1
        rewards[pair] += reward
        brought[pair].update(wanted(before, then))
    return tried, after, rewards, {p: {i: brought[p][i] / n for i in INTENTS} for p, n in tried.items()}


def allowed_by_hand(by_hand, threshold):
    tried, _, _, likely = by_hand
    afford = {pair for pair in tried if max(likely[pair].values()) >= threshold}
    with_some = {each for each, _ in afford}
    return {pair for pair in tried if pair in afford or pair[0] not in with_some}


def test_chances_are_the_shares_of_what_followed(seen, by_hand):
    expected = np.zeros((len(INTENTS), N_STATES, N_SOCIAL_ACTIONS))
    for pair, likely in by_hand[3].items():
        expected[:, *pair] = [likely[intent] for intent in INTENTS]
    found = chances(seen[1])
    assert (expected.max(axis=(1, 2)) > 0).all()
    np.testing.assert_allclose(found, expected)


@pytest.mark.parametrize("threshold", [0.1, 0.5, 0.9])
def test_what_is_planned_with_and_what_it_is_worth(seen, by_hand, threshold):
    model = seen[1]
    tried, after, rewards, _ = by_hand
    expected = allowed_by_hand(by_hand, threshold)
    allowed = affording(chances(model), model["visits"] > 0, threshold)
    assert set(zip(*map(np.ndarray.tolist, allowed.nonzero()), strict=True)) == expected != set(tried)
    assert entries(model, allowed) == sum(len(after[pair]) for pair in expected)
    q = dict.fromkeys(expected, 0.0)
    for _ in range(60):
        values = defaultdict(float)
        for (each, _), value in q.items():
            values[each] = max(values[each], value)
        q = {
            pair: (rewards[pair] + GAMMA * sum(n * values[then] for then, n in after[pair].items())) / tried[pair]
            for pair in expected
        }
    found = planned(SETTING, model, allowed, GAMMA, symmetric=False)
    np.testing.assert_allclose([found[pair] for pair in q], list(q.values()))
    with_some = {each for each, _ in expected}
    others = [found[pair] for pair in np.ndindex(found.shape) if pair not in expected and pair[0] in with_some]
    assert set(others) == {-np.inf}
    assert (found[[each for each in range(N_STATES) if each not in with_some]] == 0).all()


def test_all_pairs_of_a_symmetric_agent_are_planned_in_all_states():
    model = empty_model(SETTING)
    here, there = state(7, 2, 0, 0), state(7, 2, 0, 1)  # both stand for others
    count(model, here * N_SOCIAL_ACTIONS + Action.MOVE_2_EAST, 1.0, there)
    saved = saved_model(model, N_SOCIAL_ACTIONS)
    q = planned(SETTING, saved, saved["visits"] > 0, GAMMA, symmetric=True)
    turned = state(7, 2, 2, 2)
    assert q[here, Action.MOVE_2_EAST] == q[turned, Action.MOVE_2_NORTH] == 1
    assert np.isneginf(q[turned]).sum() == N_SOCIAL_ACTIONS - 1


def test_every_set_of_a_run_is_told(tiny_run):
    (module,) = restricted(tiny_run, plan(read_config(tiny_run)), Selection(agent="mb"), (0.5,), 5)
    assert (module.group, module.human, module.seeds) == ("social/mb/fast", "fast", [0])
    whole, often, half = module.sets
    assert [each.threshold for each in module.sets] == [None, None, 0.5]
    assert whole is module.whole
    assert whole.name == ALL
    assert often.pairs < whole.pairs > half.pairs
    assert half.entries < whole.entries
    assert module.difference(whole).mean == 0


def test_of_an_agent_without_a_model_nothing_is_planned(tiny_run):
    with pytest.raises(NotFoundError, match="no such social module"):
        restricted(tiny_run, plan(read_config(tiny_run)), Selection(agent="mf"))


def module(human, reward):
    pairs = np.full(2, 10.0)
    sets = [
        PairSet(ALL, None, np.empty((2, 0)), pairs, pairs, np.array([8.0, 8.0])),
        PairSet("k 0.5", 0.5, np.full((2, len(INTENTS)), 5.0), pairs / 2, pairs / 2, np.array(reward)),
    ]
    return Restricted(f"social/mb/{human}", human, [0, 1], np.array([8.0, 8.0]), sets)


def test_the_picture_has_room_for_long_names():
    modules = [module(human, [8.0, 7.0]) for human in "abcd"]
    with styled(STYLE):
        figure = draw_intents(modules, {"b": "a human who has to be shown the way all of the time"})
        words = words_of(figure)
    assert figure.axes[1].get_title(loc="left").count("\n") > 2
    assert beyond(figure, words) == []


def test_the_picture_has_one_axis_and_the_names_of_the_figure():
    with styled(STYLE):
        figure = draw_intents([module("a", [8.0, 7.0]), module("b_c", [2.0, 2.5])], {"a": "the first one"})
        words = words_of(figure)
    first, second = figure.axes[:2]
    assert [axes.get_title(loc="left").split("\n")[0] for axes in (first, second)] == ["the first one", "b c"]
    assert first.get_ylim() == second.get_ylim()
    lowest = min(np.min(line.get_ydata()) for line in second.lines)
    assert first.get_ylim()[0] < lowest < 30
    assert beyond(figure, words) == []
