"""configs/paper: each figure alone, all of them together, and the variants, which differ in what they say."""

import pytest

from tests.paper_runs import CONFIGS
from visitlab_cli.config.canonical import dump_yaml
from visitlab_cli.config.loading import load, load_text
from visitlab_cli.paper.figures.designs import FIG_6, FIG_8
from visitlab_cli.paper.figures.fig7 import LEARNERS
from visitlab_cli.plan.cells import plan

FIGURES = {
    "fig6_navigation": FIG_6[0].groups(),
    "fig6_go_to_human": FIG_6[1].groups(),
    "fig6_social": FIG_6[2].groups(),
    "fig6_bootstrap": FIG_6[3].groups(),
    "fig7": [f"navigation_observed/{agent}" for agent in LEARNERS],
    "fig8_humans": FIG_8[0].groups(),
    "fig8_adaptation": FIG_8[1].groups(),
    "fig9": ["visit/human_2"],
}
INCLUDED = ("references", "modules")
FILES = [file for file in sorted((CONFIGS / "paper").rglob("*.yaml")) if file.stem not in INCLUDED]
BEST_MATCH = {"goal_rooms": tuple(range(8)), "planner_rewards": "restart"}
VISITS = {
    "fig8_best_match": BEST_MATCH,
    "fig8_best_match_first": BEST_MATCH | {"models": "first"},
    "fig8_best_match_crossed": BEST_MATCH | {"models": "crossed"},
    "fig8_training": {},
    "fig8_planner": {"planner_rewards": "restart"},
    "fig8_rooms": {"goal_rooms": tuple(range(8))},
    "fig8_unrewarded": {"social_reward": "none"},
    "fig8_first": {"models": "first"},
    "fig8_crossed": {"models": "crossed"},
}
LONG = {name for name in VISITS if "best_match" in name} | {"fig8_training"}


def variant(name):
    return load(CONFIGS / "paper" / "variants" / f"{name}.yaml")


@pytest.mark.parametrize("file", FILES, ids=[file.stem for file in FILES])
def test_a_config_is_named_as_its_file_and_survives_its_dump(file):
    config = load(file)
    assert config.name == file.stem
    assert load_text(dump_yaml(config), "again") == config


def test_there_is_a_config_for_each_figure():
    assert {file.stem for file in FILES if file.parent.name == "paper"} == set(FIGURES)


@pytest.mark.parametrize(("name", "groups"), FIGURES.items(), ids=FIGURES)
def test_a_figures_config_makes_what_it_shows(name, groups):
    config, paper = load(CONFIGS / "paper" / f"{name}.yaml"), load("paper")
    assert set(groups) <= {cell.group for cell in plan(config)}
    assert config.seeds == (1 if name == "fig9" else 10)
    for section in ("humans", "agents", "experiments"):
        assert getattr(config, section).items() <= getattr(paper, section).items()


def test_paper_is_all_of_them_and_nothing_else():
    paper = load("paper")
    alone = [load(CONFIGS / "paper" / f"{name}.yaml") for name in FIGURES]
    assert set(paper.experiments) == {name for config in alone for name in config.experiments}
    assert paper.seeds == 10
    assert paper.record.one_trial_in == 1


@pytest.mark.parametrize(("name", "choices"), VISITS.items(), ids=VISITS)
def test_a_variant_of_the_visit_differs_in_its_choices(name, choices):
    config, paper = variant(name), load("paper")
    assert config.experiments["visit"] == paper.experiments["visit"].model_copy(update=choices)
    assert config.experiments["social_humans"].steps == (2_000_000 if name in LONG else 500_000)
    for module in ("navigation", "go_to_human"):
        assert config.experiments[module].steps == paper.experiments[module].steps
    for section in ("humans", "agents"):
        ours, theirs = getattr(config, section), getattr(paper, section)
        assert all(theirs[key] == value for key, value in ours.items())
    assert config.record.one_trial_in == 0
    assert config.seeds == (6 if "crossed" in name else 10)


def test_the_other_variants_differ_in_their_choices():
    paper = load("paper")
    alpha = variant("fig6_bootstrap_alpha")
    learner = alpha.agents["mf_after_mb"]
    assert learner == paper.agents["mf_after_mb"].model_copy(update={"acts_as": "mf_slow"})
    assert alpha.agents["mf_slow"] == paper.agents["mf"].model_copy(update={"alpha": 0.1})
    zero = variant("unvisited_zero")
    assert zero.agents["mb"] == paper.agents["mb"].model_copy(update={"unvisited": "zero"})
    seen = variant("success_seen").experiments["go_to_human"]
    assert seen == paper.experiments["go_to_human"].model_copy(update={"success": "seen"})


def test_every_variant_is_tested_here():
    names = {file.stem for file in FILES if file.parent.name == "variants"}
    assert names == {*VISITS, "fig6_bootstrap_alpha", "unvisited_zero", "success_seen"}
