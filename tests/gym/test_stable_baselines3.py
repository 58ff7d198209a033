"""The example `examples/stable-baselines3`: its lanes are the task, and its table has PPO beside ours.

Skipped where Stable-Baselines3 is not installed, as in CI: it is a dependency of the example alone.
"""

import importlib
import sys

import gymnasium
import numpy as np
import pytest

from tests.packages import EXAMPLES

pytest.importorskip("stable_baselines3")


@pytest.fixture
def example(monkeypatch):
    """A module of the example by name, as a script beside it imports it."""
    monkeypatch.syspath_prepend(EXAMPLES / "stable-baselines3")
    yield importlib.import_module
    for name in ("compare", "lanes"):
        sys.modules.pop(name, None)


def test_a_lane_is_the_environment_of_its_seed_and_its_trials_follow_each_other(example):
    lanes = example("lanes").SocialLanes("human_1", 3, seed=2)
    single = gymnasium.make("visitlab/Social-v0", human="human_1")
    first, (state, _) = lanes.reset(), single.reset(seed=3 * 2 + 1)
    weights = (1, 8, 8 * 5, 8 * 5 * 8)  # as docs/environments/social.md has them
    assert first[1] @ weights == state
    random, total = np.random.default_rng(0), 0.0
    for step in range(1, 2001):
        actions = random.integers(lanes.action_space.n, size=3)
        seen, rewards, over, infos = lanes.step(actions)
        state, reward, _, truncated, _ = single.step(actions[1])
        assert (rewards[1], over[1]) == (reward, truncated)
        total += reward
        assert truncated == (step % 20 == 0)
        if truncated:
            assert infos[1]["TimeLimit.truncated"]
            assert infos[1]["terminal_observation"] @ weights == state
            assert lanes.trials[-1][1] == total
            (state, _), total = single.reset(), 0.0
        assert seen[1] @ weights == state
    assert len(lanes.trials) == 100


def test_seeds_share_no_lane(example):
    lanes = example("lanes").SocialLanes
    first, second = lanes("human_2", 64, seed=0).reset(), lanes("human_2", 64, seed=1).reset()
    assert (first[1:] != second[:-1]).any(axis=1).mean() > 0.9


def test_ppo_stands_beside_ours_with_as_many_trials(example, tmp_path, capsys):
    compare = example("compare")
    compare.main(["--humans", "human_1", "--steps", "6000", "--seeds", "2", "--out", str(tmp_path)])
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [line[:2] for line in lines[1:]] == [
        ["human_1", name] for name in ("model_based", "rmax", "q_learning", "PPO")
    ]
    assert {line[-1] for line in lines[1:]} == {"2"}
    learned = compare.ppo("human_1", 6000, 0)
    again = compare.ppo("human_1", 6000, 0)
    assert len(learned.rewards) == 300
    assert (learned.rewards == again.rewards).all()
