"""Comparing whole runs: verdicts, what counts as a seed, and the cause of a difference."""

import numpy as np
import pytest

from tests.paper.made_runs import make_run
from visitlab_cli.exact.navigation import navigation_optimum, navigation_random
from visitlab_cli.paper.judging.comparison import LAST, WHOLE, compare
from visitlab_cli.paper.judging.variants import open_variant, variants_beside
from visitlab_cli.paper.published.counterparts import curve_of_group
from visitlab_cli.paper.published.curves import published_curves
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage.run_folder import read_config

NAVIGATION, VISIT = "navigation/rmax", "visit/human_1"


def compared(run, variants=()):
    found = compare(run, plan(read_config(run)), variants)
    return {each.ours.group: each for each in found.curves}, {absent.group: absent.reason for _, absent in found.absent}


def test_curves_that_the_run_has_are_judged_and_the_others_named(tmp_path):
    found, absent = compared(make_run(tmp_path, {NAVIGATION: 0.0, VISIT: 2.0}))
    assert {group: str(each.verdict) for group, each in found.items()} == {NAVIGATION: "agrees", VISIT: "differs"}
    assert absent["navigation/mb"] == "not in the config"
    assert found[NAVIGATION].cause is None
    assert found[VISIT].cause == "unexplained"
    for part in found[VISIT].parts.values():
        assert part.difference == pytest.approx(2, abs=0.15)


def test_a_planned_curve_that_was_not_run_is_absent(tmp_path):
    found, absent = compared(make_run(tmp_path, {NAVIGATION: 0.0}))
    assert set(found) == {NAVIGATION}
    assert absent[VISIT] == "not run yet"


def test_a_shorter_run_is_not_compared(tmp_path):
    found, absent = compared(make_run(tmp_path, {NAVIGATION: 0.0}, navigation_steps=400_000))
    assert not found
    assert absent[NAVIGATION] == "has 20,000 trials, fewer than the 25,000 published"


def test_a_curve_says_how_much_of_the_possible_it_is(tmp_path):
    found, _ = compared(make_run(tmp_path, {NAVIGATION: 0.0, VISIT: 0.0}))
    share = found[NAVIGATION].as_json()["share_of_the_possible_last_tenth"]
    chance, best = navigation_random(20), navigation_optimum(20)
    assert share["published"] == pytest.approx((18.02 - chance) / (best - chance), abs=0.01)
    assert share["ours"] == pytest.approx(share["published"], abs=0.01)
    assert found[VISIT].as_json()["share_of_the_possible_last_tenth"] is None


def test_visits_of_the_same_model_are_one_seed(tmp_path):
    curve = next(
        each for each in published_curves() if each.figure == "fig8_adaptation" and each.condition == "human_1"
    )
    for models, units in (("crossed", 3), ("first", 1), ("paired", 3)):
        run = make_run(tmp_path / models, {VISIT: 0.0}, models=models, seeds=3)
        ours = curve_of_group(run, plan(read_config(run)), VISIT, curve)
        assert ours.curve.samples.shape == (units, 50)


def test_the_published_visits_of_one_model_are_also_judged_as_one(tmp_path):
    found, _ = compared(make_run(tmp_path, {NAVIGATION: 0.0, VISIT: 0.3}))
    visit = found[VISIT]
    ten, one = (parts[WHOLE].high - parts[WHOLE].low for parts in (visit.parts, visit.one_model))
    assert one == pytest.approx(ten * np.sqrt(11 / 2))
    assert found[NAVIGATION].as_json()["if_published_is_one_model"] is None


CHANGE = "visit.planner_rewards: restart (not carried)"


def test_a_variant_that_agrees_is_the_cause(tmp_path):
    run = make_run(tmp_path, {NAVIGATION: 0.0, VISIT: 2.0})
    variant = make_run(tmp_path, {NAVIGATION: 0.0, VISIT: 0.0}, name="variant", planner="restart")
    found, _ = compared(run, variants_beside(run))
    assert found[VISIT].cause == f"{variant.name}: {CHANGE}"
    assert found[VISIT].cause_of(LAST) == f"{variant.name}: {CHANGE}"
    assert found[VISIT].as_json()["variants"][0]["verdict"] == "agrees"
    assert found[NAVIGATION].tried == []  # it agrees, and nothing else decides it


def test_a_variant_that_does_not_agree_explains_nothing(tmp_path):
    run = make_run(tmp_path, {VISIT: 2.0})
    make_run(tmp_path, {VISIT: 1.5}, name="variant", planner="restart")
    found, _ = compared(run, variants_beside(run))
    assert found[VISIT].cause == "unexplained"
    assert [each.changes for each in found[VISIT].tried] == [[CHANGE]]


def test_the_simplest_of_several_causes_is_named(tmp_path):
    run = make_run(tmp_path, {VISIT: 2.0})
    make_run(tmp_path, {VISIT: 0.0}, name="both", planner="restart", training=2_000_000)
    longer = make_run(tmp_path, {VISIT: 0.0}, name="longer", training=2_000_000)
    found, _ = compared(run, variants_beside(run))
    assert found[VISIT].cause == f"{longer.name}: social.training.steps: 2000000 (not 500000)"
    assert len(found[VISIT].tried) == 2


def test_a_run_that_decides_nothing_else_is_no_variant(tmp_path):
    run = make_run(tmp_path, {VISIT: 2.0})
    make_run(tmp_path, {VISIT: 0.0}, name="longer_navigation", navigation_steps=500_000, seeds=3)
    found, _ = compared(run, variants_beside(run))
    assert found[VISIT].tried == []


def test_a_longer_training_is_no_variant_of_its_own_curve(tmp_path):
    run = make_run(tmp_path, {NAVIGATION: 2.0})
    longer = make_run(tmp_path / "elsewhere", {NAVIGATION: 0.0}, navigation_steps=500_000, training=2_000_000)
    found, _ = compared(run, [open_variant(longer)])
    assert found[NAVIGATION].tried == []


def test_a_damaged_run_beside_is_left_out(tmp_path):
    run = make_run(tmp_path, {VISIT: 2.0})
    (tmp_path / "broken-12345678").mkdir()
    (tmp_path / "broken-12345678" / "config.yaml").write_text("name: [")
    assert variants_beside(run) == []
