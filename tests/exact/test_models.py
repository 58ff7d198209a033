"""`P` and `R` are what the simulated tasks do, and what the exact values follow from."""

import numpy as np
import pytest

from visitlab_cli.exact.go_to_human import go_to_human_random
from visitlab_cli.exact.models import go_to_human_mean_q, go_to_human_model, navigation_model
from visitlab_cli.exact.navigation import navigation_optimal_q, navigation_random
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.go_to_human import make_go_to_human
from visitlab_cli.world.lab import make_lab
from visitlab_cli.world.navigation import make_navigation
from visitlab_cli.world.scene import NOWHERE
from visitlab_cli.world.task import begin_trial, observe, step

GAMMA = 0.9
SMALL = make_lab(5, 7, rooms=np.repeat([[0, 0, 0, 1, 1, 1, 1]], 5, axis=0))


def sampled(task, count, n_actions=25):
    """First steps of trials: states, actions, next states, rewards."""
    random, rows = random_state(3, "models"), []
    for number in range(count):
        scene, action = begin_trial(task, NOWHERE, random), number % n_actions
        after, reward, _ = step(task, scene, action, random)
        rows.append((observe(task, scene), action, observe(task, after), reward))
    return [np.array(column) for column in zip(*rows, strict=True)]


def test_navigation_goes_where_the_model_says():
    P, R = navigation_model()
    state, action, after, reward = sampled(make_navigation(), 3000)
    np.testing.assert_array_equal(P[state, action], after)
    np.testing.assert_array_equal(R[state, action], reward)


def test_value_iteration_on_navigations_model_gives_its_exact_values():
    P, R = navigation_model()
    values = np.zeros(len(R))
    for _ in range(300):
        q = R + GAMMA * values[P]
        values = q.max(axis=1)
    np.testing.assert_allclose(q, navigation_optimal_q(GAMMA), atol=1e-9)
    policy_of_chance = np.zeros(len(R))
    for _ in range(20):
        policy_of_chance = (R + policy_of_chance[P]).mean(axis=1)
    assert policy_of_chance.mean() == pytest.approx(navigation_random(20))


def test_go_to_humans_model_is_the_mean_of_what_happens():
    """In a small lab, where each pair is met often: frequencies are near the probabilities."""
    P, R = go_to_human_model(lab=SMALL)
    np.testing.assert_allclose(P.sum(axis=2)[P.any(axis=(1, 2))], 1)
    state, action, after, reward = sampled(make_go_to_human(lab=SMALL), 40_000)
    often = np.zeros((320, 25))
    met, earned = np.zeros_like(P), np.zeros_like(R)
    np.add.at(often, (state, action), 1)
    np.add.at(met, (state, action, after), 1)
    np.add.at(earned, (state, action), reward)
    assert (P[met > 0] > 0).all()
    for model, count, total in ((P, met, often[..., None]), (R, earned, often)):
        error = 6 * np.sqrt(total * model * (1 - model)) + 6
        assert (abs(count - total * model) <= error).all()


def test_go_to_humans_model_has_the_exact_mean_of_a_first_step():
    P, R = go_to_human_model()
    assert P.shape == (320, 25, 320)
    assert starts() @ R.mean(axis=1) == pytest.approx(go_to_human_random(1))


def starts():
    """How probable each state is at a trial's start, from the geometry of TASK.md."""
    cells = np.arange(24)
    row, col, other_row, other_col = np.meshgrid(cells, cells, cells, cells, indexing="ij")
    north, east = row - other_row, other_col - col
    bearing = np.round(np.arctan2(north, east) / (np.pi / 4) % 8, 2) % 8
    angle = np.rint(bearing).astype(int) % 8
    distance = np.searchsorted([1, 2, 4, 5], np.maximum(abs(north), abs(east)))
    counts = np.zeros(320)
    for heading in range(8):
        np.add.at(counts, (angle + 8 * (heading + 8 * distance)).ravel(), 1)
    return counts / counts.sum()


def test_the_mean_q_is_the_fixed_point_of_its_model():
    P, R = go_to_human_model()
    q = go_to_human_mean_q(GAMMA)
    np.testing.assert_allclose(q, R + GAMMA * (P @ q.max(axis=1)), atol=1e-9)
