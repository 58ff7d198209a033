"""The planner that believes what it saw last, by hand on two goals of three cells, and as a module that steers."""

import numpy as np

from visitlab_cli.agents.base import Setting, learn
from visitlab_cli.agents.last_seen import NEVER, LastSeenParameters
from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import random_state

SETTING = Setting("navigation", 6, 2, 100, goals=2)
GAMMA = 0.5
PARAMETERS = LastSeenParameters(kind="last_seen", gamma=GAMMA, plan_every=2)


@kernel
def teach(agent, state, action, reward, next_state, step, random):
    learn(agent, state, action, reward, next_state, False, step, random)


def taught(*steps):
    agent = PARAMETERS.create(SETTING)
    for number, (state, action, reward, next_state) in enumerate(steps, 1):
        teach(agent, state, action, reward, next_state, number, random_state(0))
    return agent


def test_what_one_goal_saw_of_moving_holds_for_the_other():
    agent = taught((0, 1, 0.0, 1), (1, 1, 1.0, 2))
    assert agent.ends.tolist() == [[NEVER, 1], [NEVER, 2], [NEVER, NEVER]]
    assert agent.q[:3].tolist() == [[0, 0], [0, 1], [1, 1]], "what was never tried is a stay: in cell 2 one that pays"
    agent = taught((0, 1, 0.0, 1), (1, 1, 1.0, 2), (4, 0, 1.0, 3), (3, 0, 1.0, 3))
    assert agent.ends[1, 0] == 0
    assert agent.q[3:].tolist() == [[1, 0], [1, 0], [0, 0]], "the other goal pays in cell 0, and goes there from 1"


def test_the_last_end_counts_alone():
    agent = taught(*[(0, 1, 0.0, 1)] * 5, (0, 1, 0.0, 0))
    assert agent.ends[0, 1] == 0


def test_it_goes_on_as_it_would_have():
    steps = [(int(s), int(a), float(r), int(n)) for s, a, r, n in np.random.default_rng(4).integers(0, 2, (40, 4))]
    whole, half = taught(*steps), taught(*steps[:20])
    again = PARAMETERS.restore(SETTING, {name: array.copy() for name, array in PARAMETERS.save(half).items()})
    for number, (state, action, reward, next_state) in enumerate(steps[20:], 21):
        teach(again, state, action, reward, next_state, number, random_state(0))
    for first, second in zip(PARAMETERS.save(whole).values(), PARAMETERS.save(again).values(), strict=True):
        np.testing.assert_array_equal(first, second)


def test_its_model_is_one_that_others_read():
    (model,) = PARAMETERS.models(PARAMETERS.save(taught((0, 1, 0.0, 1), (1, 1, 1.0, 2)))).values()
    assert model["visits"].tolist() == [[0, 1], [0, 1], [0, 0], [0, 0], [0, 0], [0, 0]]
    assert model["reward_sums"][1, 1] == 1
    assert model["successor_states"].tolist() == [1, 2]
    assert model["successor_offsets"].tolist() == [0, 0, 1, 1, *[2] * 9]
