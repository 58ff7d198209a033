"""The agent of several models against its rule in plain Python: detection, reassignment, plans, and what it saves."""

import math
from collections import Counter, defaultdict

import numpy as np
import pytest

from visitlab_cli.agents.base import Setting, learn
from visitlab_cli.agents.model_based import ModelBased, ModelBasedParameters
from visitlab_cli.agents.model_switching import CANDIDATE, contexts, gather
from visitlab_cli.agents.multi_model import MultiModelParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import random_state
from visitlab_cli.results.own_models import active_models
from visitlab_cli.world.enums import N_SOCIAL_ACTIONS

N, A = 2560, N_SOCIAL_ACTIONS
TRAINED, STEPS, HUMAN_STAYS = 3000, 6000, 1200
TRAINING = Setting("social", N, A, TRAINED)
VISIT = Setting("visit", N, A, STEPS)
PARAMETERS = MultiModelParameters(kind="multi_model", plan_every=100)
STATES = np.arange(0, N, 137)
LATE, RIGHT = 60, 0.95
"""Of a human's return: the steps within which its own model is active, and the share of steps in which it is."""


@kernel
def taught(agent, state, action, reward, next_state, step, random):
    learn(agent, state, action, reward, next_state, False, step, random)


def world(human, steps, seed):
    """Few states and actions; what follows an action depends on the human."""
    draw = np.random.default_rng(seed)
    for _ in range(steps):
        at, action = int(draw.integers(len(STATES))), int(draw.choice([0, 5, 29]))
        noise = draw.random() < 0.1
        following = int(STATES[draw.integers(len(STATES)) if noise else (at + 3 * human + action) % len(STATES)])
        yield int(STATES[at]), action, float(following == STATES[4]), following


def visit():
    """Human 0, whom it was trained with, then 1, 2, 1 and 0 again."""
    for number, human in enumerate((0, 1, 2, 1, 0)):
        yield from world(human, HUMAN_STAYS, 10 + number)


def trained():
    agent, random = PARAMETERS.create(TRAINING), random_state(0, "test")
    for step, transition in enumerate(world(0, TRAINED, 1), 1):
        taught(agent, *transition, step, random)
    return PARAMETERS.save(agent)


@pytest.fixture(scope="module")
def lived():
    saved = trained()
    agent, random = PARAMETERS.restore(VISIT, saved), random_state(1, "test")
    for step, transition in enumerate(visit(), 1):
        taught(agent, *transition, step, random)
    return saved, agent


class Plain:
    """The rule as its paper has it, with dictionaries and all of the steps kept."""

    def __init__(self, saved):
        rows = zip(saved["successor_offsets"][:-1], saved["successor_offsets"][1:], strict=True)
        self.own = [defaultdict(Counter)]
        self.rewards = [Counter()]
        for pair, (first, last) in enumerate(rows):
            for place in range(first, last):
                self.own[0][pair][int(saved["successor_states"][place])] = float(saved["successor_counts"][place])
            self.rewards[0][pair] = float(saved["reward_sums"].ravel()[pair])
        self.context, self.steps, self.active, self.switches = contexts(N), [], 0, []
        self.restart()

    def restart(self):
        self.evidence, self.begun = Counter(), dict.fromkeys(range(9), len(self.steps))
        self.candidate_begins()

    def candidate_begins(self):
        self.candidate, self.new, self.new_since = defaultdict(Counter), 0.0, len(self.steps)

    def seen(self, model):
        """Counts by context and action, made anew from all that the model counts."""
        found = defaultdict(Counter)
        for pair, followed in self.own[model].items():
            for following, n in followed.items():
                found[self.context[pair // A], pair % A][self.context[following]] += n
        return found

    def step(self, state, action, reward, following):
        if len(self.steps) - self.new_since >= 3000:
            self.candidate_begins()
        x, y = (self.context[state], action), self.context[following]
        detects = action != 29
        if detects:
            weigh = [min(1, 100 / s[x].total()) if s[x].total() else 0 for s in self.cached]
            general = 1 / 320 + sum(w * s[x][y] for w, s in zip(weigh, self.cached, strict=True))
            general /= 1 + sum(w * s[x].total() for w, s in zip(weigh, self.cached, strict=True))

            def log(followed):
                return math.log((followed[y] + 20 * general) / (followed.total() + 20))

            base = log(self.cached[self.active][x])
            gains = [min(3, max(-3, log(s[x]) - base)) for s in self.cached]
            new = min(3, max(-3, log(self.candidate[x]) - base))
        self.steps.append((state, action, reward, following))
        self.own[self.active][state * A + action][following] += 1
        self.rewards[self.active][state * A + action] += reward
        if not detects:
            return
        for model, gain in enumerate(gains):
            if model != self.active:
                self.evidence[model] = max(0, self.evidence[model] + gain)
                if self.evidence[model] == 0:
                    self.begun[model] = len(self.steps)
        self.new += new
        self.candidate[x][y] += 1
        self.cached[self.active][x][y] += 1
        best = max(range(len(self.own)), key=lambda model: self.evidence[model])
        if self.evidence[best] > 30:
            self.switch(best, self.begun[best])
        elif self.new > 80:
            self.switch(len(self.own), self.new_since)
        elif self.new < -15:
            self.candidate_begins()

    def switch(self, to, since):
        self.switches.append([len(self.steps), self.active, to, since])
        if to == len(self.own):
            self.own.append(defaultdict(Counter))
            self.rewards.append(Counter())
        for state, action, reward, following in self.steps[since:]:
            pair = state * A + action
            self.own[self.active][pair][following] -= 1
            self.rewards[self.active][pair] -= reward
            self.own[to][pair][following] += 1
            self.rewards[to][pair] += reward
        self.active = to
        self.cached = [self.seen(model) for model in range(len(self.own))]
        self.restart()

    def live(self, steps):
        self.cached = [self.seen(0)]
        for each in steps:
            self.step(*each)
        return self


def test_it_switches_and_counts_as_the_rule_says(lived):
    saved, agent = lived
    plain = Plain(saved).live(visit())
    kept = PARAMETERS.save(agent)
    assert kept["switches"].tolist() == plain.switches
    assert len(plain.switches) >= 4
    assert kept["active"].tolist() == [plain.active]
    for name, arrays in PARAMETERS.models(kept).items():
        model = int(name.removeprefix("model "))
        offsets = arrays["successor_offsets"]
        for pair in {*plain.own[model], *np.flatnonzero(arrays["visits"])}:
            row = slice(offsets[pair], offsets[pair + 1])
            found = dict(zip(arrays["successor_states"][row].tolist(), arrays["successor_counts"][row], strict=True))
            assert found == {state: n for state, n in plain.own[model][pair].items() if n}
            assert arrays["reward_sums"].ravel()[pair] == plain.rewards[model][pair]


def test_every_step_is_counted_once_and_the_humans_are_told_apart(lived):
    saved, agent = lived
    kept = PARAMETERS.save(agent)
    assert kept["models_visits"].sum() == saved["visits"].sum() + STEPS
    own = np.array([np.bincount(each).argmax() for each in active_models(kept, STEPS).reshape(5, HUMAN_STAYS)])
    assert (own[3:] == own[1::-1]).all()
    assert len(set(own)) == 3
    right = active_models(kept, STEPS).reshape(5, HUMAN_STAYS) == own[:, None]
    assert (right[3:].argmax(axis=1) < LATE).all()
    assert right[3:].mean() > RIGHT


def test_it_plans_by_its_own_counts_and_what_the_others_have_in_common(lived):
    _, agent = lived
    gather(agent)
    kept = PARAMETERS.save(agent)
    models = [PARAMETERS.models(kept)[f"model {model}"] for model in range(3)]
    active = int(kept["active"][0])
    others = [model for number, model in enumerate(models) if number != active]
    for pair in np.flatnonzero(kept["visits"])[::7]:
        n = [float(model["visits"].ravel()[pair]) for model in others]
        total = sum(min(each, 100) for each in n)
        share = [min(total, 20) / total * min(each, 100) / each if each else 0 for each in n]
        wanted = models[active]["visits"].ravel()[pair] + sum(a * b for a, b in zip(share, n, strict=True))
        assert kept["visits"].ravel()[pair] == pytest.approx(wanted)
    assert PARAMETERS.fault(VISIT, kept) is None


@pytest.mark.parametrize(
    ("name", "change", "told"),
    [
        ("active", lambda array: array + 7, "the active model is none of the 4"),
        ("models_q", lambda array: array[1:], "its models are not all of one size"),
        (
            "switches",
            lambda array: array + np.array([0, 0, 7, 0]),
            "a switch is between models of which one is none of the 4",
        ),
        ("switches", lambda array: array[::-1], "its switches do not lie one after the other"),
        ("switches", lambda array: array + np.array([0, 0, 0, 2**40]), "its switches do not lie one after the other"),
        ("models_visits", lambda array: array + 1, "successor_counts do not sum to visits"),
    ],
)
def test_saved_models_that_do_not_fit_are_told(lived, name, change, told):
    kept = PARAMETERS.save(lived[1])
    assert PARAMETERS.fault(VISIT, {**kept, name: change(kept[name])}) == told


HERE, THERE, ELSEWHERE = STATES[:3]


def stays_the_same(agent, following, first, n):
    for step in range(first, first + n):
        taught(agent, HERE, 0, 1.0, following, step, random_state(0))
        yield step


def test_a_chain_that_changes_by_hand():
    """1,000 times from here to there; then to elsewhere, which nobody foresaw: 3 nats a step, until over 80."""
    learned = PARAMETERS.create(TRAINING)
    assert len(list(stays_the_same(learned, THERE, 1, 1000))) == 1000
    agent = PARAMETERS.restore(VISIT, PARAMETERS.save(learned))
    for step in stays_the_same(agent, ELSEWHERE, 1, 26):
        assert agent.detection.evidence[CANDIDATE] == 3 * step
    before = agent.qs[0].copy()
    list(stays_the_same(agent, ELSEWHERE, 27, 1))
    kept = PARAMETERS.save(agent)
    assert kept["switches"].tolist() == [[27, 0, 1, 0]]
    assert [each["visits"][HERE, 0] for each in PARAMETERS.models(kept).values()] == [27, 1000]
    # twenty sweeps at once, from the values of before: of 27 its own and 20 of what the old one knows; R is 1
    q = before
    for _ in range(20):
        values = q.max(axis=1)
        q = np.full_like(q, 0.9 * values.mean())
        q[HERE, 0] = 1 + 0.9 * (27 * values[ELSEWHERE] + 20 * values[THERE]) / 47
    np.testing.assert_allclose(agent.qs[1], q, rtol=1e-12)
    # the old one foretold there with its 1,000, the new one by what both have in common; it learns it, too
    evidence, n = 0.0, 0
    for _ in stays_the_same(agent, THERE, 28, 500):
        general = (1 / 320 + 100 + n * min(1, 100 / (27 + n))) / (1 + 100 + min(27 + n, 100))
        foretold = [(1000 + 20 * general) / 1020, (n + 20 * general) / (47 + n)]
        evidence, n = evidence + math.log(foretold[0] / foretold[1]), n + 1
        if evidence > 30:
            break
        assert agent.detection.evidence[0] == pytest.approx(evidence)
    assert PARAMETERS.save(agent)["switches"][1].tolist() == [27 + n, 1, 0, 27]
    assert [each["visits"][HERE, 0] for each in PARAMETERS.models(PARAMETERS.save(agent)).values()] == [1000 + n, 27]


def test_a_candidate_that_is_no_better_begins_anew_after_3000_steps():
    agent = PARAMETERS.restore(VISIT, PARAMETERS.save(PARAMETERS.create(TRAINING)))
    list(stays_the_same(agent, THERE, 1, 3001))
    assert agent.detection.begun[CANDIDATE] == 3000
    assert agent.detection.model.visits.reshape(9, -1)[[0, CANDIDATE]].sum(axis=1).tolist() == [3001, 1]


def copied(record):
    if isinstance(record, tuple):
        return type(record)(*map(copied, record))
    return record.copy() if isinstance(record, np.ndarray) else record


def test_its_record_is_all_that_it_is_in_the_middle_of_detection(lived):
    """Copied while the evidence rises, it has the same future; whoever it is told is there."""
    steps, stopped = list(visit()), 2 * HUMAN_STAYS + 15
    agent, random = PARAMETERS.restore(VISIT, lived[0]), random_state(1, "test")
    for step, transition in enumerate(steps[:stopped], 1):
        taught(agent, *transition, step, random)
    assert agent.detection.evidence.max() > 0
    again, random_again = copied(agent), random.copy()
    PARAMETERS.meet(again, 7)
    for step, transition in enumerate(steps[stopped:], stopped + 1):
        taught(agent, *transition, step, random)
        taught(again, *transition, step, random_again)
    whole, ours = PARAMETERS.save(agent), PARAMETERS.save(again)
    assert all(np.array_equal(ours[name], whole[name], equal_nan=True) for name in whole)


def test_told_who_comes_it_has_a_model_for_each():
    told = MultiModelParameters(kind="multi_model", plan_every=100, told=True)
    agent, random = told.restore(VISIT, trained()), random_state(1, "test")
    for step, transition in enumerate(visit(), 1):
        if step % HUMAN_STAYS == 1:
            told.meet(agent, (0, 1, 2, 1, 0)[step // HUMAN_STAYS])
        taught(agent, *transition, step, random)
    assert told.save(agent)["switches"].tolist() == [
        [HUMAN_STAYS, 0, 1, HUMAN_STAYS],
        [2 * HUMAN_STAYS, 1, 2, 2 * HUMAN_STAYS],
        [3 * HUMAN_STAYS, 2, 1, 3 * HUMAN_STAYS],
        [4 * HUMAN_STAYS, 1, 0, 4 * HUMAN_STAYS],
    ]


def test_in_training_it_is_model_based_to_the_bit():
    plain = ModelBasedParameters(kind="model_based", plan_every=100)
    agent, random = plain.create(TRAINING), random_state(0, "test")
    assert isinstance(PARAMETERS.create(TRAINING), ModelBased)
    for step, transition in enumerate(world(0, TRAINED, 1), 1):
        taught(agent, *transition, step, random)
    ours, theirs = trained(), plain.save(agent)
    assert ours.keys() == theirs.keys()
    assert all(np.array_equal(ours[name], theirs[name]) for name in ours)
