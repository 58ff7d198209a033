"""Ten seeds of the paper against its curves and against two independent simulations (make test-slow, ten minutes).

Runs go to `runs/`, where they can be looked at and are not made twice.
"""

from pathlib import Path

import numpy as np
import pytest

from tests.program import visitlab
from visitlab_cli.paper.published.curves import published_curves
from visitlab_cli.storage.arrays import read_trials

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]

# group, what independent simulations reach (TASK.md), tolerance, published curve, its condition
CURVES = [
    ("navigation/mf", (14.4, 14.4), 0.3, "fig6_navigation", "epsilon_greedy_mf"),
    ("navigation/mb", (16.7, 16.7), 0.3, "fig6_navigation", "epsilon_greedy_mb"),
    ("navigation/rmax", (18.0, 18.0), 0.3, "fig6_navigation", "rmax"),
    ("go_to_human/mf", (12.6, 12.6), 0.3, "fig6_go_to_human", "epsilon_greedy_mf"),
    ("go_to_human/mb", (14.6, 14.9), 0.3, "fig6_go_to_human", "epsilon_greedy_mb"),
    ("go_to_human/rmax", (13.5, 13.7), 0.3, "fig6_go_to_human", "rmax"),
    ("social/mb/human_1", (10.3, 10.3), 0.3, "fig6_social", "epsilon_greedy_mb"),
    ("social/rmax/human_1", (10.0, 10.0), 0.3, "fig6_social", "rmax"),
    ("social_humans/mb/human_1", (9.2, 9.2), 0.4, "fig8_humans", "human_1"),
    ("social_humans/mb/human_2", (6.6, 6.6), 0.4, "fig8_humans", "human_2"),
]
VISITS = [("carried", 5.9, 6.5), ("restart", 2.9, 6.2)]
VISIT_TOLERANCE = 0.6


def run(config, *overrides):
    done = visitlab("run", config, *overrides, "--out", ROOT / "runs", "--quiet", cwd=ROOT)
    assert done.returncode == 0, done.stderr
    return Path(done.stdout.splitlines()[-1])


def rewards(run, group, cells="seed-*"):
    """Reward of each trial, shape (cells, trials)."""
    files = sorted((run / group).glob(f"{cells}/trials.parquet"))
    return np.stack([read_trials(file)["reward"] for file in files])


def published(figure, condition):
    """The curve's steps and means."""
    (curve,) = (each for each in published_curves() if (each.figure, each.condition) == (figure, condition))
    return curve.x, curve.mean


@pytest.fixture(scope="module")
def paper():
    # three hours at most for the authors' scripts a seed; minutes here
    return run(ROOT / "configs" / "paper.yaml", "record.steps=none")


@pytest.mark.parametrize(("group", "reached", "tolerance", "figure", "condition"), CURVES)
def test_learning_lands_on_the_published_curve(paper, group, reached, tolerance, figure, condition):
    ours = rewards(paper, group)
    assert len(ours) == 10
    trials = ours.shape[1]
    last = ours[:, -(trials // 100) :].mean()
    steps, means = published(figure, condition)
    early = ours[:, : trials // 3].mean()
    published_early = means[steps < trials * 20 / 3].mean()
    print(f"{group}: last 1% {last:.2f} ({reached}, {means[-1]:.2f}), first third {early:.2f} ({published_early:.2f})")
    assert reached[0] - tolerance <= last <= reached[1] + tolerance
    assert abs(last - means[-1]) <= 0.6
    assert abs(early - published_early) <= max(0.15 * published_early, 0.3)


def test_q_learning_rises_late_and_seldom_in_the_social_task(paper):
    last = rewards(paper, "social/mf/human_1")[:, -1000:].mean(axis=1)
    print("social/mf/human_1:", last.round(2))
    assert 0.1 <= last.mean() <= 0.8
    assert (last > 0.1).sum() >= 3


@pytest.fixture(scope="module")
def visits():
    return run(Path(__file__).with_name("visits.yaml"))


@pytest.mark.parametrize(("group", "first", "later"), VISITS)
def test_goals_of_a_visit_over_eight_models(visits, group, first, later):
    ours = rewards(visits, f"{group}/human_2", "model-*/seed-*")
    assert len(ours) == 64
    models = ours.reshape(8, 8, -1)
    for name, part, expected in (("1-10", models[:, :, :10], first), ("201-300", models[:, :, 200:300], later)):
        of_model = part.mean(axis=(1, 2))
        print(f"{group} {name}: {of_model.mean():.2f} (between models {of_model.std():.2f}), expected {expected}")
        assert abs(of_model.mean() - expected) <= VISIT_TOLERANCE
