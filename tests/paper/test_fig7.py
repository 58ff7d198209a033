"""Fig. 7: distances, ratios, and the bars and maps that are drawn."""

import numpy as np
import pytest

from tests.paper_runs import SEEDS
from visitlab_cli.exact.navigation import navigation_optimal_q
from visitlab_cli.paper.figures.fig7 import EXAMPLE_ROOM, LEARNERS, distances, draw_fig7, ratios
from visitlab_cli.paper.figures.source import open_source
from visitlab_cli.storage.arrays import read_model
from visitlab_cli.world.lab import paper_lab


def test_distances():
    north_east = distances(paper_lab())[2].reshape(24, 24)
    assert north_east[0:8, 16:24].tolist() == [[1] * 8] * 8
    assert (north_east[8, 15], north_east[4, 14], north_east[9, 14], north_east[23, 0]) == (1, 2, 2, 16)
    assert distances(paper_lab())[4].max() == 8


def test_optimal_values_fall_every_three_cells():
    values = navigation_optimal_q(0.9).max(axis=1)
    assert values == pytest.approx(10 * 0.9 ** (np.ceil(distances(paper_lab()).ravel() / 3) - 1))


def test_ratios_are_means_over_the_states_of_a_distance():
    optimal = np.ones((9 * 576, 2))
    tables = np.zeros((2, 9 * 576, 2))
    tables[0, :, 1] = distances(paper_lab()).ravel() / 10
    tables[1, :, 0] = 0.5
    found = ratios(tables, optimal, paper_lab())
    assert found.distance.tolist() == list(range(1, 17))
    assert found.mean == pytest.approx((found.distance / 10 + 0.5) / 2)
    half = 12.7062 * np.abs(found.distance / 10 - 0.5) / np.sqrt(2) / np.sqrt(2)
    assert found.half == pytest.approx(half, rel=1e-4)


def test_bars_and_maps_are_the_runs(paper_run):
    drawing = draw_fig7(open_source(paper_run))
    assert drawing.notes == []
    axes = drawing.figure.axes
    for column, agent in enumerate(LEARNERS):
        files = sorted((paper_run / "navigation_observed" / agent).glob("seed-*/model.npz"))
        learned = np.stack([read_model(file)["q"].max(axis=1) for file in files]).reshape(SEEDS, 9, 576)
        (image,) = axes[column].images
        assert (image.get_array() == learned[0, EXAMPLE_ROOM].reshape(24, 24)).all()
        share = learned / navigation_optimal_q(0.9).max(axis=1).reshape(9, 576)
        for distance in range(1, 17):
            gid = f"navigation_observed/{agent}/{distance}"
            (bar,) = [patch for patch in axes[3 + column].patches if patch.get_gid() == gid]
            assert bar.get_height() == pytest.approx(share[:, distances(paper_lab()) == distance].mean())
    assert axes[3].get_ylabel() == "learned / optimal value\n(9 goal rooms, n = 2 runs)"
