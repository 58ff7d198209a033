"""The published curves as the package holds them."""

import numpy as np
import pytest

from visitlab_cli.paper.published.counterparts import COUNTERPARTS
from visitlab_cli.paper.published.curves import FIGURES, published_curves
from visitlab_cli.results.curves import in_batches

CURVES = {(curve.figure, curve.condition): curve for curve in published_curves()}


def test_every_figure_has_three_curves():
    assert len(CURVES) == 3 * len(FIGURES) == 18
    assert set(COUNTERPARTS) == set(CURVES)


# first trial, trials in a batch, batches: the README beside the files
BATCHES = [
    ("fig6_navigation", "rmax", 0, 250, 100),
    ("fig6_go_to_human", "epsilon_greedy_mb", 0, 100, 100),
    ("fig6_social", "epsilon_greedy_mf", 0, 1000, 100),
    ("fig6_mb_mf", "mf_bootstrapped", 25_000, 750, 100),
    ("fig6_mb_mf", "epsilon_greedy_mb", 0, 1000, 100),
    ("fig8_humans", "human_3", 0, 250, 100),
    ("fig8_adaptation", "human_2", 0, 20, 50),
]


@pytest.mark.parametrize(("figure", "condition", "first", "in_batch", "batches"), BATCHES)
def test_batches_are_as_published(figure, condition, first, in_batch, batches):
    curve = CURVES[figure, condition]
    assert (curve.first_trial, curve.trials_in_batch, len(curve.x)) == (first, in_batch, batches)
    assert len(curve.mean) == len(curve.band) == batches
    assert curve.trials == first + in_batch * batches


def test_values_are_those_of_the_files():
    rmax = CURVES["fig6_navigation", "rmax"]
    assert (rmax.x[0], rmax.mean[0], rmax.band[0]) == (2500, 2.2028, 3.7465)
    assert CURVES["fig8_adaptation", "human_2"].mean[-1] == 8.8
    with pytest.raises(ValueError, match="read-only"):
        rmax.mean[0] = 0


def test_rewards_are_averaged_in_the_published_batches():
    bootstrapped = CURVES["fig6_mb_mf", "mf_bootstrapped"]
    trials = np.arange(100_000.0)
    batches = in_batches(trials, bootstrapped.edges)
    assert batches.shape == (100,)
    assert batches[0] == pytest.approx(25_000 + 749 / 2)
    assert batches[-1] == pytest.approx(99_999 - 749 / 2)
    # the middle of a batch in steps is where the curve is drawn
    assert (batches + 0.5) * 20 == pytest.approx(bootstrapped.x, abs=20)
