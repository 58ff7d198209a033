"""What is as published: told by values and not by names, wherever it lies in a grid."""

import pytest

from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load
from visitlab_cli.paper.published.as_published import essence, paper_cells, unlike
from visitlab_cli.paper.published.counterparts import COUNTERPARTS, counterparts
from visitlab_cli.plan.cells import plan

HUMAN_2 = ("fig8_humans", "human_2")
VISIT_2 = ("fig8_adaptation", "human_2")


def found(*overrides, config="paper/fig8_adaptation"):
    return counterparts(plan(load(shipped_configs()[config], ["seeds=1", *overrides])))


def test_every_curve_of_the_paper_config_is_as_published():
    every = found(config="paper")
    assert set(every) == set(COUNTERPARTS)
    assert {key: each.group for key, each in every.items()} == COUNTERPARTS
    assert not any(each.unlike for each in every.values())


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("humans.human_2.p_A=0.15", "human_2.p_A 0.15, published 0.05"),
        ("humans.human_2.p_S=[1, 0, 0]", "human_2.p_S [1, 0, 0], published [0, 0.5, 0.5]"),
        ("agents.mb.gamma=0.8", "mb.gamma 0.8, published 0.9"),
        ("agents.mb={kind: q_learning}", "mb.kind q_learning, published model_based"),
        ("experiments.social_humans.trial_steps=40", "social_humans.trial_steps 40, published 20"),
        ("experiments.social_humans.arena=9", "social_humans.arena 9, published 120"),
        ("interaction.distances=[1, 2, 3, 5]", "interaction.distances [1, 2, 3, 5], published [1, 2, 4, 5]"),
    ],
)
def test_whatever_decides_a_training_must_be_as_published(override, told):
    each = found(override, config="paper/fig8_humans")[HUMAN_2]
    assert (each.unlike, each.reason) == ([told], told)


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("experiments.visit.social_reward=none", "visit.social_reward none, published social"),
        ("experiments.visit.plan_every=50", "visit.plan_every 50, published 100"),
        ("experiments.social_humans.steps=400000", "social_humans.steps 400000, published 500000"),
        ("agents.rmax.r_max=2", "rmax.r_max 2, published 1"),
    ],
)
def test_so_must_what_decides_a_visit_and_its_modules(override, told):
    assert found(override)[VISIT_2].unlike == [told]


@pytest.mark.parametrize(
    "override",
    [
        "seed=7",
        "record.steps=none",
        "experiments.visit.models=first",
        "experiments.visit.trials=500",
        "humans.human_1.p_A=1",
    ],
)
def test_what_decides_nothing_of_it_may_differ(override):
    assert found(override)[VISIT_2].unlike == []


def test_navigation_knows_no_distances():
    every = found("interaction.distances=[1, 2, 3, 5]", config="paper/fig8_adaptation")
    assert every["fig6_navigation", "rmax"].unlike == []


RENAMED = """
name: mine
include: [{configs}/humans/paper.yaml, {configs}/agents/paper.yaml]
humans: {{shy: {{like: human_2}}}}
agents: {{planner: {{like: mb}}}}
experiments: {{social_humans: {{task: social, agents: [planner], humans: [{humans}], steps: 2000}}}}
"""


def renamed(tmp_path, humans, more="", *overrides):
    file = tmp_path / "mine.yaml"
    file.write_text(RENAMED.format(configs=shipped_configs()["paper"].parent, humans=humans) + more)
    return counterparts(plan(load(file, overrides)))


def test_other_names_with_the_published_values_count_as_published(tmp_path):
    every = renamed(tmp_path, "human_1, shy")
    assert (every[HUMAN_2].group, every[HUMAN_2].unlike) == ("social_humans/planner/shy", [])
    assert ("fig8_humans", "human_3") not in every


def test_names_do_not_count_where_values_are_anothers(tmp_path):
    every = renamed(tmp_path, "human_2, shy", "", "humans.human_2.p_A=0.15", "humans.shy.p_A=0.05")
    assert every[HUMAN_2].group == "social_humans/planner/shy"


def test_a_point_of_a_grid_may_be_as_published(tmp_path):
    every = renamed(tmp_path, "shy", "vary: {humans.shy.p_A: [0.01, 0.05, 0.2]}\n")
    assert every[HUMAN_2].group == "social_humans/planner/shy/humans.shy.p_A=0.05"


def test_where_no_point_is_the_nearest_says_what_differs():
    vary = "vary={humans.human_2.p_A: [0.1, 0.2], agents.mb.gamma: [0.9, 0.5]}"
    each = found(vary, config="paper/fig8_humans")[HUMAN_2]
    assert each.points == 4
    assert each.reason == "no point of the grid is as published; the nearest has human_2.p_A 0.1, published 0.05"


def test_a_start_from_another_training_is_not_as_published():
    more = "experiments.social_humans.start_from=social/mb/human_1"
    (cell,) = [
        cell
        for cell in plan(load(shipped_configs()["paper"], ["seeds=1", more]))
        if cell.condition == "social_humans/mb/human_2"
    ]
    told = unlike(cell, paper_cells()["social_humans/mb/human_2"])
    assert told == ["social_humans.start_from social/mb/human_1, published null"]
    assert essence(cell)["start.training.steps"] == 2_000_000
