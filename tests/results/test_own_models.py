"""Whose a model is: of humans who share one, whoever had it more often; the other has none of its own."""

import numpy as np
import pytest

from visitlab_cli.results.own_models import _own

ANNA, BERT, CLEO = "anna", "bert", "cleo"


@pytest.mark.parametrize(
    ("phases", "own"),
    [
        ([(ANNA, [0] * 9), (BERT, [0, 0, 1, 1, 1, 1])], {ANNA: 0, BERT: 1}),
        ([(ANNA, [0] * 9), (BERT, [0] * 6)], {ANNA: 0, BERT: -1}),  # nobody noticed
        ([(ANNA, [0] * 9), (BERT, [0] * 6 + [1])], {ANNA: 0, BERT: 1}),
        ([(ANNA, [0] * 3), (BERT, [0] * 2 + [1] * 2), (ANNA, [2] * 4)], {ANNA: 2, BERT: 1}),
        ([(ANNA, [0, 1]), (BERT, [1, 1]), (CLEO, [1, 3, 3])], {ANNA: 0, BERT: 1, CLEO: 3}),
    ],
)
def test_a_model_is_that_humans_who_had_it_most(phases, own):
    assert _own([human for human, _ in phases], [np.array(models) for _, models in phases]) == own
