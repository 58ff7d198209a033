"""Batches and their interval, by hand."""

import math

import numpy as np
import pytest

from visitlab_cli.results.curves import Curve, equal_edges, in_batches, spread
from visitlab_cli.results.estimates import half_width

T_OF_TWO = 4.302653  # Student's t, 2 degrees of freedom, 97.5%


def curve_of(units, edges, trial=1):
    """A curve of units, each with the rewards of its cells."""
    batches = {name: np.array([in_batches(cell, edges) for cell in cells]) for name, cells in units.items()}
    return Curve(edges, batches, trial)


def test_batches_are_means_of_equal_parts():
    units = {"a": [np.array([1.0, 3.0, 5.0, 7.0])], "b": [np.array([3.0, 3.0, 1.0, 1.0])]}
    curve = curve_of(units, equal_edges(4, 2), 20)
    assert curve.x.tolist() == [20, 60]
    assert curve.mean.tolist() == [2.5, 3.5]
    assert curve.counted.n == 2


def test_no_more_batches_than_trials():
    curve = curve_of({"a": [np.arange(7.0)]}, equal_edges(7, 100))
    assert curve.x.tolist() == [0.5, 1.5, 2.5, 3.5, 4.5, 5.5, 6.5]
    assert curve.mean.tolist() == list(range(7))


def test_a_curve_may_begin_later_and_end_earlier():
    curve = curve_of({"a": [np.arange(10.0)]}, equal_edges(10, 2, first=4), 10)
    assert curve.x.tolist() == [55, 85]
    assert curve.mean.tolist() == [5, 8]
    assert in_batches(np.arange(10.0), np.array([2, 4, 6])).tolist() == [2.5, 4.5]


def test_batches_that_do_not_divide_the_trials_hold_each_trial_once():
    rewards = np.random.default_rng(0).random(103)
    curve = curve_of({"a": [rewards]}, equal_edges(103, 10))
    assert (curve.edges[0], curve.edges[-1], len(curve.mean)) == (0, 103, 10)
    assert np.dot(np.diff(curve.edges), curve.mean) == pytest.approx(rewards.sum())


def test_the_interval_is_students():
    curve = curve_of({name: [np.array([value])] for name, value in zip("abc", (1.0, 2.0, 6.0), strict=True)}, [0, 1])
    assert curve.half[0] == pytest.approx(T_OF_TWO * math.sqrt(7) / math.sqrt(3), rel=1e-6)


def test_one_seed_has_no_interval():
    assert np.isnan(half_width(np.ones((1, 3)))).all()


def test_what_shares_a_model_counts_once():
    visits = {"a": (1.0, 3.0), "b": (6.0, 8.0), "c": (9.0, 9.0)}
    curve = curve_of({name: [np.array([each]) for each in of] for name, of in visits.items()}, [0, 1])
    assert curve.counted == (3, 6)
    assert curve.mean.tolist() == [6]
    assert curve.half[0] == pytest.approx(T_OF_TWO * np.std([2, 7, 9], ddof=1) / math.sqrt(3), rel=1e-6)


def test_spreads_are_components_of_variance():
    models, visits = 200, 30
    random = np.random.default_rng(1)
    values = random.normal(5, 0.6, (models, 1)) + random.normal(0, 0.3, (models, visits))
    between, within = spread(Curve([0, 1], {str(k): of[:, None] for k, of in enumerate(values)}))
    assert between == pytest.approx(0.6, abs=0.1)
    assert within == pytest.approx(0.3, abs=0.02)
