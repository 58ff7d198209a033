"""Compiled lanes are, step for step, single environments with Gymnasium's own way to begin anew."""

import gymnasium
import numba
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.vector import AutoresetMode

from tests.gym.test_environment import IDS, MODULES, SOCIAL, VISIT
from visitlab_cli.compiled import JIT_DISABLED, records_in
from visitlab_cli.errors import UsageError
from visitlab_cli.humans.six_parameters import Human
from visitlab_cli.world.geometry import Geometry
from visitlab_cli.world.social import Social

LANES = 5


def both(name, **settings):
    """Lanes, and the same environments one by one, by Gymnasium's `SyncVectorEnv`."""
    settings |= {"trial_steps": 7} | ({"modules": MODULES} if name == VISIT else {})
    compiled = gymnasium.make_vec(name, num_envs=LANES, **settings)
    return compiled, gymnasium.make_vec(name, num_envs=LANES, vectorization_mode="sync", **settings)


def assert_same(one, two):
    assert type(one) is type(two)
    if isinstance(one, dict):
        assert one.keys() == two.keys()
        for key in one:
            assert_same(one[key], two[key])
    elif isinstance(one, tuple):
        for each, other in zip(one, two, strict=True):
            assert_same(each, other)
    else:
        np.testing.assert_array_equal(one, two)
        assert one.dtype == two.dtype


@pytest.mark.parametrize("observation", ["state", "dict"])
@pytest.mark.parametrize("name", IDS)
def test_lane_by_lane_what_single_environments_tell(name, observation):
    compiled, single = both(name, observation=observation, full_info=True)
    assert type(compiled).__name__.endswith("Lanes")
    assert compiled.metadata["autoreset_mode"] == single.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    assert compiled.observation_space == single.observation_space
    assert compiled.action_space == single.action_space
    actions = np.random.default_rng(0).integers(compiled.single_action_space.n, size=(40, LANES))
    for seed in (3, [9, 8, 7, 6, 5], None):
        assert_same(compiled.reset(seed=seed), single.reset(seed=seed))
        for each in actions:
            told = compiled.step(each)
            assert_same(told, single.step(each))
            assert told[0] in compiled.observation_space


def test_what_is_given_is_not_changed_later():
    lanes, _ = both(SOCIAL, observation="dict", full_info=True)
    seen, info = lanes.reset(seed=0)
    kept = {name: array.copy() for name, array in {**seen, **info}.items()}
    lanes.step(np.zeros(LANES, int))
    assert_same({**seen, **info}, kept)


def test_wrong_calls():
    lanes, _ = both(SOCIAL)
    with pytest.raises(ResetNeeded):
        lanes.step([0] * LANES)
    before = lanes.reset(seed=0)
    with pytest.raises(InvalidAction, match="lane 3: action 30: must be from 0 to 29"):
        lanes.step([0, 0, 0, 30, 0])
    with pytest.raises(InvalidAction, match="actions must be 5 whole numbers"):
        lanes.step([0.5] * LANES)
    with pytest.raises(UsageError, match="2 seeds for 5 lanes"):
        lanes.reset(seed=[1, 2])
    with pytest.raises(UsageError, match="no option 'cell' for lanes"):
        lanes.reset(seed=0, options={"cell": "x"})
    assert_same(lanes.reset(seed=0), before)
    with pytest.raises(UsageError, match="lanes are not rendered"):
        gymnasium.make_vec(SOCIAL, num_envs=2, render_mode="rgb_array")


@pytest.mark.skipif(JIT_DISABLED, reason="it is about compiled code")
def test_whose_code_takes_part_is_known_of_what_is_held_in_memory():
    """So that machine code of other people's humans is kept apart from ours."""
    lanes, _ = both(SOCIAL)
    assert {Social, Human, Geometry} <= set(records_in(numba.typeof(lanes._episodes)))
