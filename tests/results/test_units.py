"""What is independent, counted and in words."""

from pathlib import Path

import pytest

from visitlab_cli.config.loading import load
from visitlab_cli.plan.cells import plan
from visitlab_cli.results.units import Units, by_unit, in_words

VARIANTS = Path(__file__).parents[2] / "configs/paper/variants"


@pytest.mark.parametrize(
    ("variant", "told"),
    [("fig8_first", "1 model, 10 visits"), ("fig8_planner", "10 seeds"), ("fig8_crossed", "6 models, 36 visits")],
)
def test_what_is_independent_depends_on_the_models(variant, told):
    visits = [cell for cell in plan(load(VARIANTS / f"{variant}.yaml")) if cell.group == "visit/human_2"]
    assert Units(len(by_unit(visits)), len(visits)).words == told


def test_several_conditions_are_counted_together():
    assert in_words([Units(10, 10), Units(10, 10)]) == "n = 10 seeds"
    assert in_words([Units(1, 1)]) == "n = 1 seed"
    assert in_words([Units(1, 10)]) == "n = 1 model, 10 visits"
    assert in_words([Units(1, 10), Units(2, 12)]) == "n = 1 to 2 models"
    assert in_words([Units(6, 36), Units(6, 30)]) == "n = 6 models"
