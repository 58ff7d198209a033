"""What a door that closes costs navigation: the published numbers, and a second way."""

import numpy as np
import pytest

from visitlab_cli.exact.closing import affected_starts, greedy_policy, optimum_from, policy_sums, reward_from
from visitlab_cli.exact.motion import optimal_sums, random_sums
from visitlab_cli.exact.navigation import navigation_motion, navigation_optimal_q
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.enums import N_PHYSICAL_ACTIONS
from visitlab_cli.world.layout import Layout, rooms_in_rows
from visitlab_cli.world.navigation import make_navigation, step
from visitlab_cli.world.scene import NOWHERE

NINE = rooms_in_rows(3, 3, 8, 8, True, 2)


def test_the_middle_door_of_nine_rooms_costs_what_was_found():
    before, after = NINE.lab(), NINE.lab(closed=["BE"])
    starts = affected_starts(before, after, 20)
    assert starts.mean() == pytest.approx(0.177, abs=0.0005)
    assert optimum_from(before, starts, 20) == pytest.approx(16.84, abs=0.005)
    assert optimum_from(after, starts, 20) == pytest.approx(15.23, abs=0.005)
    assert optimum_from(after, np.ones_like(starts), 20) == pytest.approx(17.36, abs=0.005)
    assert reward_from(after, starts, 20, navigation_optimal_q(0.9, after), 0.05) == pytest.approx(14.8, abs=0.1)


def test_a_policy_that_is_all_chance_and_one_that_is_the_best_are_those_that_are_known():
    lab = Layout("AAABB\nAAabB\nAAABB").lab()
    motion = navigation_motion(lab)
    uniform = np.full((lab.n_rooms * 15, N_PHYSICAL_ACTIONS), 1 / N_PHYSICAL_ACTIONS)
    np.testing.assert_allclose(policy_sums(motion, uniform, 7).mean(axis=1), random_sums(motion, 7))
    best = policy_sums(motion, greedy_policy(navigation_optimal_q(0.9, lab), 0.0), 3)
    np.testing.assert_allclose(best, optimal_sums(motion, 3))


def test_what_a_policy_reaches_is_what_playing_it_brings():
    lab = Layout("AAABB\nAAabB\nAAABB").lab()
    q, task, random = navigation_optimal_q(0.9, lab), make_navigation(lab=lab), random_state(1)
    policy, rng = greedy_policy(q, 0.3), np.random.default_rng(2)
    expected = policy_sums(navigation_motion(lab), policy, 5)[0, 1]
    got = []
    for _ in range(3000):
        scene, total = NOWHERE._replace(robot_row=0, robot_col=0, goal_room=1), 0.0
        for _ in range(5):
            state = scene.goal_room * 15 + scene.robot_row * 5 + scene.robot_col
            scene, reward, _ = step(task, scene, int(rng.choice(N_PHYSICAL_ACTIONS, p=policy[state])), random)
            total += reward
        got.append(total)
    assert np.mean(got) == pytest.approx(expected, abs=4 * np.std(got) / 3000**0.5)
