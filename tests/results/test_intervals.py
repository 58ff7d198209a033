"""Student's t against published tables and a simulation."""

import math

import numpy as np
import pytest

from visitlab_cli.results.intervals import deviation, t_quantile

# two-sided 95% and 99%, from the tables of the NIST handbook (1.3.6.7.2)
TABLE = [
    (1, 12.706, 63.657),
    (2, 4.303, 9.925),
    (3, 3.182, 5.841),
    (4, 2.776, 4.604),
    (9, 2.262, 3.250),
    (10, 2.228, 3.169),
    (29, 2.045, 2.756),
    (100, 1.984, 2.626),
]


@pytest.mark.parametrize(("degrees", "at_95", "at_99"), TABLE)
def test_quantiles_are_those_of_the_tables(degrees, at_95, at_99):
    assert t_quantile(degrees) == pytest.approx(at_95, abs=6e-4)
    assert t_quantile(degrees, 0.99) == pytest.approx(at_99, abs=6e-4)


@pytest.mark.parametrize("degrees", [1.0, 1.3, 2.5, 7.9, 40.25])
def test_degrees_need_not_be_whole(degrees):
    """The density, integrated by the trapezoid rule over the angle, has the confidence within the quantile."""
    angles = np.linspace(0, math.atan(t_quantile(degrees) / math.sqrt(degrees)), 200_001)
    constant = math.exp(math.lgamma((degrees + 1) / 2) - math.lgamma(degrees / 2)) / math.sqrt(math.pi)
    inside = 2 * constant * np.trapezoid(np.cos(angles) ** (degrees - 1), angles)
    assert inside == pytest.approx(0.95, abs=1e-8)


def test_many_degrees_of_freedom_are_the_normal():
    assert t_quantile(9999) == pytest.approx(1.95996, abs=5e-4)


@pytest.mark.parametrize("seeds", [3, 10])
def test_intervals_cover_the_mean_as_often_as_they_say(seeds):
    draws = np.random.default_rng(0).normal(5, 2, (20_000, seeds))
    half = t_quantile(seeds - 1) * draws.std(axis=1, ddof=1) / math.sqrt(seeds)
    assert (abs(draws.mean(axis=1) - 5) <= half).mean() == pytest.approx(0.95, abs=0.006)


def test_one_value_has_no_deviation():
    assert math.isnan(deviation([3.0]))
    assert deviation([1.0, 3.0]) == pytest.approx(math.sqrt(2))
