"""Means, differences and their intervals, against numbers from elsewhere and by simulation."""

import math

import numpy as np
import pytest

from visitlab_cli.results.estimates import Estimate, difference_of, mean_of, probability_of_improvement


def test_a_mean_by_hand():
    found = mean_of([1.0, 2.0, 6.0])
    assert found.mean == 3.0
    assert found.half == pytest.approx(4.303 * math.sqrt(7.0 / 3), abs=1e-3)
    assert found.as_json()["interval"] == [found.mean - found.half, found.mean + found.half]


def test_one_value_has_no_interval():
    assert math.isnan(mean_of([4.0]).half)
    assert mean_of([4.0]).as_json() == {"mean": 4.0, "interval": None}
    assert difference_of([1.0], [2.0, 4.0]).as_json() == {"mean": 2.0, "interval": None}


def test_unequal_spreads_cost_degrees_of_freedom():
    wide, narrow = [0.0, 10.0, 20.0], [5.0, 5.0, 5.0 + 1e-9]
    spread = math.sqrt(np.var(wide, ddof=1) / 3)
    assert difference_of(narrow, wide).half / spread == pytest.approx(4.303, abs=1e-3)  # 2 degrees, not 4
    assert difference_of([3.0, 3.0], [5.0, 5.0]) == (2.0, 0.0)


def test_a_difference_covers_the_truth_as_often_as_it_says():
    random = np.random.default_rng(1)
    inside = 0
    for _ in range(2000):
        found = difference_of(random.normal(0, 1, 5), random.normal(3, 4, 8))
        inside += abs(found.mean - 3) <= found.half
    assert 0.94 < inside / 2000 < 0.97


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [([1, 2], [3, 4], 1.0), ([3, 4], [1, 2], 0.0), ([1, 1], [1, 1], 0.5), ([1, 3], [2, 3], (1 + 1 + 0 + 0.5) / 4)],
)
def test_probability_of_improvement_counts_pairs(first, second, expected):
    assert probability_of_improvement(first, second) == expected


@pytest.mark.parametrize(
    ("estimate", "sign", "words"),
    [
        (Estimate(2.5, 0.25), "", "2.50 ± 0.25"),
        (Estimate(2.5, 0.25), "+", "+2.50 ± 0.25"),
        (Estimate(0.0006, 0.0009), "", "0.0006 ± 0.0009"),
        (Estimate(-0.001, 0.02), "+", "+0.00 ± 0.02"),
        (Estimate(0.0, 0.0), "", "0.00 ± 0.00"),
        (Estimate(3.0, math.nan), "", "3.00 ± ?"),
    ],
)
def test_words_show_what_two_digits_would_hide(estimate, sign, words):
    assert estimate.in_words(sign) == words
    assert Estimate(3.0, math.nan).in_words(unknown="") == "3.00"
