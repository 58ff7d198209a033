"""The picture of the matrix: its words can be read, whatever its size and the names in it."""

import pytest

from tests.pictures.within import beyond, upon_another, words_of
from visitlab_cli.figures.matrix_picture import draw_matrix
from visitlab_cli.pictures.style import STYLE, styled
from visitlab_cli.results.estimates import Estimate
from visitlab_cli.results.matrix import MODES, Goals, Matrix, Pairing
from visitlab_cli.results.units import Units


def matrix_of(humans, visit="visit", social="social/mb", pool=()):
    goals = Goals(Estimate(10.25, 10.25), Units(10, 10), "")
    return Matrix(
        visit, social, 300, {Pairing(a, b, mode): goals for a in humans for b in humans for mode in MODES}, pool
    )


@pytest.mark.parametrize("size", [1, *(pytest.param(size, marks=pytest.mark.slow) for size in (2, 3)), 8])
@pytest.mark.parametrize("name", ["human_", "slow_and_distractible_", "a_word_" * 8, "W" * 60])
def test_every_word_is_whole_and_free(size, name):
    humans = [f"{name}{place:04}"[-64:] for place in range(size)]
    with styled(STYLE):
        figure = draw_matrix(matrix_of(humans))
        words = words_of(figure)
        assert beyond(figure, words) == []
        assert upon_another(words) == []


def test_names_as_long_as_names_can_be():
    with styled(STYLE):
        module = "W" * 64 + "/" + "M" * 64
        figure = draw_matrix(matrix_of(["W" * 64], "v" * 64, module, (f"{module}/{'W' * 64}",) * 5))
        words = words_of(figure)
        assert beyond(figure, words) == []
        assert upon_another(words) == []
