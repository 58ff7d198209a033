"""Batches and their interval, by hand."""

import math

import numpy as np
import pytest

from visitlab_cli.figures.curves import half_width, learning_curve

T_OF_TWO = 4.302653  # Student's t, 2 degrees of freedom, 97.5%


def test_batches_are_means_of_equal_parts():
    rewards = np.array([[1.0, 3.0, 5.0, 7.0], [3.0, 3.0, 1.0, 1.0]])
    curve = learning_curve(rewards, ["a", "b"], 2, 20)
    assert curve.x.tolist() == [20, 60]
    assert curve.mean.tolist() == [2.5, 3.5]
    assert curve.n == 2


def test_no_more_batches_than_trials():
    curve = learning_curve(np.arange(7.0)[None], ["a"], 100, 1)
    assert curve.x.tolist() == [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5]
    assert curve.mean.tolist() == list(range(7))


def test_a_curve_may_begin_later():
    curve = learning_curve(np.arange(10.0)[None], ["a"], 2, 10, first=4)
    assert curve.x.tolist() == [55, 85]
    assert curve.mean.tolist() == [5, 8]


def test_batches_that_do_not_divide_the_trials_hold_each_trial_once():
    rewards = np.random.default_rng(0).random((1, 103))
    curve = learning_curve(rewards, ["a"], 10, 1)
    edges = [0.0]
    for middle in curve.x:
        edges.append(2 * middle - edges[-1])
    assert edges[-1] == 103
    assert np.dot(np.diff(edges), curve.mean) == pytest.approx(rewards.sum())


def test_the_interval_is_students():
    curve = learning_curve(np.array([[1.0], [2.0], [6.0]]), ["a", "b", "c"], 1, 1)
    assert curve.half[0] == pytest.approx(T_OF_TWO * math.sqrt(7) / math.sqrt(3), rel=1e-6)


def test_one_seed_has_no_interval():
    assert np.isnan(half_width(np.ones((1, 3)))).all()


def test_what_shares_a_model_counts_once():
    rewards = np.array([[1.0], [3.0], [6.0], [8.0], [9.0], [9.0]])
    curve = learning_curve(rewards, list("aabbcc"), 1, 1)
    assert curve.n == 3
    assert curve.mean.tolist() == [6]
    assert curve.half[0] == pytest.approx(T_OF_TWO * np.std([2, 7, 9], ddof=1) / math.sqrt(3), rel=1e-6)
