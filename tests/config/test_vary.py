"""`vary`: grids."""

import itertools

import pytest

from tests.config.lab import LAB, Complain, Load, edited
from visitlab_cli.config.canonical import config_hash, dump_yaml
from visitlab_cli.config.grid import labels, variants
from visitlab_cli.config.loading import load_text
from visitlab_cli.errors import ConfigError, UsageError
from visitlab_cli.plan.cells import plan

GRID = "name: lab\nvary: {agents.mb.epsilon: [0, 0.5], humans.human_1.p_S: [[1, 0, 0], [0, 1, 0]]}"


def test_a_grid_is_every_combination_the_last_path_fastest(loaded: Load) -> None:
    points = list(variants(loaded(edited("name: lab", GRID))))
    assert [tuple(point.values.values()) for point in points] == list(
        itertools.product([0.0, 0.5], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    )
    for point in points:
        assert point.config.agents["mb"].model_dump()["epsilon"] == point.values["agents.mb.epsilon"]
        assert list(point.config.humans["human_1"].p_S) == point.values["humans.human_1.p_S"]
        assert point.config.vary == {}


def test_without_vary_there_is_one_point(loaded: Load) -> None:
    config = loaded()
    assert list(variants(config)) == [({}, {}, config)]


def test_a_point_is_the_config_with_that_value_written(loaded: Load) -> None:
    config = loaded(overrides=["vary.agents.mb.epsilon=[0.1, 0.2]", "vary.experiments.social.steps=[20, 40]"])
    for point in variants(config):
        written = loaded(overrides=[f"{path}={value}" for path, value in point.values.items()])
        assert (point.config, config_hash(point.config)) == (written, config_hash(written))


def test_points_have_no_expected_values(loaded: Load) -> None:
    text = edited("name: lab", GRID + "\nexpected: {navigation/rmax: {value: 1, tolerance: 1}}")
    config = loaded(text)
    assert config.expected
    assert not any(point.config.expected for point in variants(config))


EXPECTING = "\nexpected: {navigation/mf%s: {value: 1, tolerance: 1}}"
IN_A_GRID = "name: lab\nvary: {agents.mf.alpha: [0.1, 0.2]}"


def test_what_is_expected_in_a_grid_is_expected_at_a_point(loaded: Load) -> None:
    config = loaded(edited("name: lab", IN_A_GRID + EXPECTING % "/agents.mf.alpha=0.2"))
    groups = {cell.group for cell in plan(config)}
    assert set(config.expected) <= groups


@pytest.mark.parametrize(
    ("name", "instead"),
    [
        ("", "known: navigation/mf/agents.mf.alpha=0.1, navigation/mf/agents.mf.alpha=0.2"),
        ("/agents.mf.alpha=0.3", "did you mean navigation/mf/agents.mf.alpha=0.2?"),
    ],
)
def test_what_is_expected_at_no_point_is_told_at_its_place(complaint: Complain, name: str, instead: str) -> None:
    (line,) = complaint(edited("name: lab", IN_A_GRID + EXPECTING % name))
    place = f"lab.yaml:3:12: expected.navigation/mf{name}"
    assert line == f"{place}: no such module or visit; with `vary` the point belongs to the name; {instead}"


def test_values_are_as_their_setting_has_them(loaded: Load) -> None:
    assert loaded(edited("name: lab", GRID)).vary["agents.mb.epsilon"] == (0.0, 0.5)
    same = config_hash(loaded(edited("name: lab", GRID.replace("[0, 0.5]", "[0.0, 5e-1]"))))
    assert same == config_hash(loaded(edited("name: lab", GRID)))


def test_a_social_module_that_plans_and_one_that_does_not(loaded: Load) -> None:
    config = loaded(overrides=["vary.experiments.visit.modules.social=[social/mb/human_1, social/mf/human_1]"])
    config = loaded(dump_yaml(config))
    socials = [point.config.experiments["visit"].modules.social for point in variants(config)]
    assert socials == ["social/mb/human_1", "social/mf/human_1"]


@pytest.mark.parametrize(
    ("vary", "line"),
    [
        ("agents.mb.epsilon: [0, 3]", "31: vary.agents.mb.epsilon.1: must be at most 1 (got 3)"),
        ("agents.mb.epsilon: [0, 0.0]", "31: vary.agents.mb.epsilon.1: the same value a second time"),
        ("agents.mb.epsilon: [.nan]", "28: vary.agents.mb.epsilon.0: must be a finite number (got nan)"),
        ("agents.mb.epsilon: []", "27: vary.agents.mb.epsilon: must have at least 1 entry (got 0)"),
        ("agents.mb.epsilon: 0.1", "27: vary.agents.mb.epsilon: must be a list (got 0.1)"),
        (
            "agents.mb.epsilo: [0]",
            "8: vary.agents.mb.epsilo: there is no agents.mb.epsilo; did you mean agents.mb.epsilon?",
        ),
        (
            "agents.mbb.epsilon: [0]",
            "8: vary.agents.mbb.epsilon: there is no agents.mbb; did you mean agents.mb.epsilon?",
        ),
        ("agents.mb.epsilon.x: [0]", "8: vary.agents.mb.epsilon.x: there is no agents.mb.epsilon.x"),
        ("seeds: [1]", "8: vary.seeds: only humans, labs, agents, experiments, interaction can vary"),
        ("agents: [1]", "8: vary.agents: must lead to a setting inside a section"),
        (
            "experiments.social.trial_steps: [20, 30]",
            "45: vary.experiments.social.trial_steps.1: experiments.social.steps: must be a whole number of "
            "trials of 30 steps, such as 90 or 120 (got 100)",
        ),
        (
            "agents.mf: [{kind: q_learning}], agents.mf.alpha: [0.1]",
            "41: vary.agents.mf.alpha: lies within agents.mf, which varies too",
        ),
        (
            ", ".join(f"humans.human_1.p_{p}: {list(range(1000))}" for p in "HMO"),
            "1: vary: a grid of 1000000000 points; at most 10000",
        ),
    ],
)
def test_bad_grids(complaint: Complain, vary: str, line: str) -> None:
    text = edited("name: lab", f"name: lab\nvary: {{{vary}}}")
    assert complaint(text) == [f"lab.yaml:2:{line}"]


def test_a_kind_that_varies_brings_its_own_defaults(loaded: Load) -> None:
    vary = "name: lab\nvary: {agents.mb.kind: [model_based, q_learning, rmax]}"
    config = loaded(edited("name: lab", vary))
    kinds = [variant.config.agents["mb"] for variant in variants(config)]
    assert [type(agent)(kind=agent.kind) == agent for agent in kinds] == [True, True, True]
    assert [agent.kind for agent in kinds] == ["model_based", "q_learning", "rmax"]
    again = load_text(dump_yaml(config), "config.yaml")
    assert [variant.config.agents["mb"] for variant in variants(again)] == kinds


def test_an_override_of_what_varies_has_no_effect_and_is_refused(loaded: Load) -> None:
    text = edited("name: lab", "name: lab\nvary: {agents.mb.epsilon: [0.1, 0.2]}")
    with pytest.raises(UsageError) as error:
        loaded(text, ["agents.mb.epsilon=0.3"])
    instead = "has no effect, for the config varies it; override vary.agents.mb.epsilon=[0.3] instead"
    assert str(error.value) == f"override 'agents.mb.epsilon': {instead}"
    assert loaded(text, ["vary.agents.mb.epsilon=[0.3]"]).vary == {"agents.mb.epsilon": (0.3,)}


def test_values_that_do_not_go_together(loaded: Load) -> None:
    vary = "{experiments.social.steps: [100, 120], experiments.social.trial_steps: [20, 50]}"
    config = loaded(edited("name: lab", f"name: lab\nvary: {vary}"))
    points = variants(config)
    assert [next(points).config.experiments["social"].steps for _ in range(3)] == [100, 100, 120]
    with pytest.raises(ConfigError) as error:
        next(points)
    assert str(error.value) == (
        "vary: at experiments.social.steps=120, experiments.social.trial_steps=50: experiments.social.steps: "
        "must be a whole number of trials of 50 steps, such as 100 or 150 (got 120)"
    )


def test_too_many_cells_are_counted_not_made(complaint: Complain, loaded: Load) -> None:
    assert loaded(overrides=["seeds=10000"]).seeds == 10_000
    assert complaint(edited("  task: visit", "  task: visit\n    models: crossed", LAB + "seeds: 2000\n")) == [
        "lab.yaml:20:1: seeds: makes up to 4014000 cells; at most 100000"
    ]


@pytest.mark.parametrize(
    ("value", "values", "name"),
    [
        (0.05, [0.05, 1e-05], "0.05"),
        (1e-05, [0.05, 1e-05], "1e-05"),
        (1e16, [1.0, 1e16], "1e16"),
        (1000, [10, 1000], "1000"),
        (None, [None, 1], "null"),
        (True, [True, False], "true"),
        ("zero", ["uniform", "zero"], "zero"),
        ("a/b", ["a/c", "a/b"], "1"),
        ("../x", ["../x"], "0"),
        ([1, 0, 0], [[0, 0, 1], [1, 0, 0]], "1"),
        ("x" * 41, ["x" * 41], "0"),
        ("a", ["A", "a"], "1"),
        (7, [7, [7]], "0"),
    ],
)
def test_labels_are_safe_folder_names(value: object, values: list[object], name: str) -> None:
    found = labels("agents.mb.x", values)
    assert found[values.index(value)] == f"agents.mb.x={name}"
    assert len(set(found)) == len(values)
