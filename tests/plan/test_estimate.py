"""What a plan would cost."""

import pytest

from tests.program import TINY
from visitlab_cli.config.loading import load
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.estimate import SWEEP_SECONDS, seconds_of
from visitlab_cli.world.tasks import TASKS

STEPS = 1_000_000


def seconds(path, *overrides):
    (cell,) = [cell for cell in plan(load(TINY, overrides)) if cell.path.startswith(path)]
    return seconds_of(cell)


@pytest.mark.parametrize(("often", "sweeps"), [(10, STEPS / 10), (1000, STEPS / 1000), (5000, STEPS / 1000)])
def test_who_plans_more_often_than_usual_is_told_to_take_longer(often, sweeps):
    steps = f"experiments.social.steps={STEPS}"
    told = [seconds("social/mb/", steps, f"agents.mb.plan_every={n}") for n in (1000, often)]
    assert told[1] - told[0] == pytest.approx(SWEEP_SECONDS * (sweeps - STEPS / 1000))


def test_a_visit_plans_as_it_says_itself():
    trials = "experiments.visit.trials=1000"
    told = [seconds("visit/fast/", trials, f"experiments.visit.plan_every={n}") for n in (100, 1)]
    assert told[1] - told[0] == pytest.approx(SWEEP_SECONDS * (100_000 - 1_000), rel=0.1)


@pytest.mark.parametrize(("steps", "share"), [("every", 1), ("{one_trial_in: 4}", 0.25), ("none", 0)])
def test_what_is_not_recorded_takes_less(steps, share):
    more = f"experiments.social.steps={STEPS}", "agents.mb.plan_every=1000"
    told = [seconds("social/mb/", *more, f"record.steps={each}") for each in ("every", steps)]
    assert told[0] - told[1] == pytest.approx(TASKS["social"].costs.recording * (1 - share) * STEPS / 1e6)
