"""Marginal means: balanced over the other settings, over seeds that have all of them."""

import pytest

from tests.results.runs_by_hand import open_lab, reach
from visitlab_cli.results.groups import groups_of
from visitlab_cli.results.marginal import marginals

GRID = """
vary:
  interaction.distances: [[1, 2, 4, 5], [1, 2, 3, 4]]
  agents.mb.epsilon: [0, 0.1, 0.2]
record: {steps: none}
"""
T_2 = 4.302653
"""The quantile of Student's t for two degrees of freedom."""


def worth(cell):
    """mb: 10, 20, 30 by epsilon; mf: 50; and 1 for the second distances; the seed makes -1, 0, 1 of each."""
    epsilon = cell.point.get("agents.mb.epsilon")
    base = 50 if epsilon is None else 10 + 100 * epsilon
    return base + (list(cell.point["interaction.distances"]) == [1, 2, 3, 4]) + cell.seed - 1


def lines(tmp_path, keep=lambda path: True):
    run, cells = open_lab(tmp_path, agents_of_social="mb, mf", more=GRID)
    social = {path: cell for path, cell in cells.items() if path.startswith("social/")}
    reach(run, cells, {path: worth(cell) for path, cell in social.items() if keep(path)})
    found = marginals(run, groups_of(list(social.values())))
    return {(line.agent, line.setting, line.value): line for line in found}


def test_the_others_count_alike(tmp_path):
    found = lines(tmp_path)
    assert found["mb", "epsilon", "0.1"].mean.mean == pytest.approx(20.5)
    assert found["mb", "epsilon", "0.1"].conditions == 2
    assert found["mb", "distances", "[1, 2, 4, 5]"].mean.mean == pytest.approx(20)
    assert found["", "agent", "mf"].mean.mean == pytest.approx(50.5)
    assert found["", "distances", "[1, 2, 3, 4]"].mean.mean == pytest.approx((10 + 20 + 30 + 50) / 4 + 1)


def test_its_interval_is_over_seeds_not_over_conditions(tmp_path):
    line = lines(tmp_path)["mb", "distances", "[1, 2, 4, 5]"]
    assert (line.n, line.conditions) == (3, 3)
    assert line.mean.half == pytest.approx(T_2 / 3**0.5, rel=1e-5)  # the means of the seeds are 19, 20, 21


def test_no_line_where_there_is_nothing_to_average_over(tmp_path):
    found = lines(tmp_path)
    assert ("mf", "distances", "[1, 2, 4, 5]") not in found
    assert ("", "epsilon", "0.1") not in found  # only mb has it: its own line tells it


def test_a_seed_without_one_of_the_conditions_does_not_count(tmp_path):
    found = lines(tmp_path, keep=lambda path: not ("epsilon=0.2" in path and path.endswith("seed-0000")))
    assert found["mb", "distances", "[1, 2, 4, 5]"].n == 2
    assert found["mb", "distances", "[1, 2, 4, 5]"].mean.mean == pytest.approx(20.5)
    assert found["mb", "epsilon", "0.1"].n == 3
    nothing = lines(tmp_path / "none", keep=lambda path: "epsilon=0.2" not in path)
    assert nothing["mb", "epsilon", "0.2"].mean is None
    assert nothing["mb", "distances", "[1, 2, 4, 5]"].n == 0


@pytest.mark.parametrize(("models", "n"), [("paired", 3), ("first", 1), ("crossed", 3)])
def test_visits_of_the_same_modules_are_no_more_seeds(tmp_path, models, n):
    more = "vary:\n  humans.fast.p_A: [0, 0.1]\n  humans.slow.p_A: [0, 0.1]\nrecord: {steps: none}\n"
    run, cells = open_lab(tmp_path, models=models, more=more)
    done = reach(run, cells, {path: float(place) for place, path in enumerate(cells)})
    found = marginals(run, groups_of(done))
    visits = [line for line in found if line.experiment == "visit"]
    assert {line.n for line in visits} == {n}
