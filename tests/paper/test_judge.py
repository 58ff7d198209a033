"""The judge is judged: on curves whose difference and noise are known."""

import math

import numpy as np
import pytest

from visitlab_cli.paper.judging.comparison import judge_parts
from visitlab_cli.paper.judging.judge import Verdict, judge, worst
from visitlab_cli.results.curves import Curve

MARGIN, DRAWS, BATCHES = 0.5, 200, 100
AGREES, UNDECIDED, DIFFERS = Verdict.AGREES, Verdict.UNDECIDED, Verdict.DIFFERS


def curve(units):
    """A curve of so many units, each with its visits, all in batches: shape (units, visits, batches)."""
    return Curve(np.arange(BATCHES + 1), {str(place): visits for place, visits in enumerate(units)})


def of_seeds(rewards):
    return curve(rewards[:, None])


def test_a_mean_of_visits_does_not_hide_the_luck_of_a_published_visit():
    random = np.random.default_rng(3)
    models, luck = random.normal(0, 0.3, (400, 1, 1)), random.normal(0, 0.6, (400, 6, 1))
    visits = np.broadcast_to(models + luck, (400, 6, BATCHES))
    whole = judge_parts(curve(visits), np.zeros(BATCHES))["whole"]
    of_one_visit = 0.3**2 + 0.6**2
    expected = 1.966 * math.sqrt((0.3**2 + 0.6**2 / 6) / 400 + of_one_visit / 10)
    assert (whole.high - whole.low) / 2 == pytest.approx(expected, rel=0.08)
    alone = judge_parts(of_seeds(visits.mean(axis=1)), np.zeros(BATCHES))["whole"]
    assert alone.high - alone.low < 0.7 * (whole.high - whole.low)


def verdicts(shift, noise, seeds):
    """What the judge says of whole curves: both runs are drawn, each seed with an offset of its own."""
    random = np.random.default_rng(1)
    shape = np.linspace(0, 10, BATCHES)
    for _ in range(DRAWS):
        published = (shape + random.normal(0, noise * MARGIN, (10, 1))).mean(axis=0)
        ours = shape + shift * MARGIN + random.normal(0, noise * MARGIN, (seeds, 1))
        yield worst([part.verdict for part in judge_parts(of_seeds(ours), published, MARGIN).values()])


def share(found, *wanted):
    return sum(verdict in wanted for verdict in found) / DRAWS


def test_the_same_agrees():
    assert share(verdicts(0, 0.2, 10), AGREES) >= 0.9


@pytest.mark.parametrize("side", [2, -2])
def test_twice_the_margin_differs(side):
    assert share(verdicts(side, 0.2, 10), DIFFERS) >= 0.9


@pytest.mark.parametrize("side", [1, -1])
def test_the_margin_itself_does_not_agree(side):
    assert share(verdicts(side, 0.2, 10), UNDECIDED, DIFFERS) >= 0.9


def test_three_noisy_seeds_accuse_nobody():
    assert share(verdicts(0, 1, 3), DIFFERS) <= 0.05


def test_a_part_that_differs_makes_the_curve_differ():
    published = np.zeros(BATCHES)
    ours = np.random.default_rng(0).normal(0, 0.01, (10, 1)) + published
    ours[:, -10:] += 2
    parts = judge_parts(of_seeds(ours), published, MARGIN)
    assert {name: str(part.verdict) for name, part in parts.items()} == {
        "first_tenth": "agrees",
        "middle_tenth": "agrees",
        "last_tenth": "differs",
        "whole": "agrees",
    }
    assert worst([part.verdict for part in parts.values()]) == DIFFERS
    assert parts["last_tenth"].difference == pytest.approx(2, abs=0.02)


def test_the_published_seeds_count():
    ours = [0.0, 0.2] * 5
    half = judge(ours, 0.1).high - judge(ours, 0.1).difference
    alone = judge(ours, 0.1, published_seeds=10**9)
    assert half == pytest.approx((alone.high - alone.difference) * math.sqrt(2), rel=1e-6)


def test_one_seed_decides_nothing():
    found = judge([3.0], 3.0)
    assert found.verdict == UNDECIDED
    assert found.as_json()["interval"] is None
    assert found.seeds_that_decide is None


@pytest.mark.parametrize("difference", [0.25, 0.8])
def test_the_seeds_that_decide_do_decide(difference):
    def seeds(n):  # mean and deviation exactly as given
        values = np.resize([-1.0, 1.0], n) if n % 2 == 0 else np.concatenate([np.resize([-1.0, 1.0], n - 1), [0.0]])
        return (difference + 0.4 * values / values.std(ddof=1)).tolist()

    found = judge(seeds(4), 0.0)
    assert found.verdict == UNDECIDED
    enough = found.seeds_that_decide
    assert judge(seeds(enough), 0.0).verdict == (AGREES if difference < MARGIN else DIFFERS)
    assert judge(seeds(enough - 1), 0.0).verdict == UNDECIDED


def test_where_the_published_ten_leave_it_open_no_number_decides():
    assert judge([0.49, 0.49 + 1, 0.49 - 1], 0.0).seeds_that_decide is None
