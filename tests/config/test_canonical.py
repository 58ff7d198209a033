"""One config, one text, one hash."""

from typing import Any

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from tests.config.lab import LAB, Load, edited
from visitlab_cli.config.building import build, check
from visitlab_cli.config.canonical import canonical, config_hash, dump_yaml
from visitlab_cli.config.document import Place, located
from visitlab_cli.config.loading import load_text
from visitlab_cli.errors import ConfigError

SAME = {
    "defaults written": edited("kind: model_based", "kind: model_based, gamma: 0.9, unvisited: uniform"),
    "a whole section of defaults": LAB + "interaction: {distances: [1, 2, 4, 5]}\nrecord: {steps: every}\n",
    "a default option of the visit": LAB + "    plan_every: 100\n    goal_rooms: all\n",
    "all rooms one by one": LAB + "    goal_rooms: [0, 1, 2, 3, 4, 5, 6, 7, 8]\n",
    "another name": edited("name: lab", "name: other"),
    "more seeds": LAB + "seeds: 7\n",
    "expected values": LAB + "expected: {visit/human_2: {value: 1, tolerance: 2}}\n",
    "numbers written otherwise": edited("p_M: 0.1", "p_M: 1e-1"),
    "by like": edited("human_2: {p_S", "human_2: {like: human_1, p_M: 0, p_S"),
    "another order": edited("  mf: {kind: q_learning}\n", "", LAB).replace(
        "agents:\n", "agents:\n  mf: {kind: q_learning}\n", 1
    ),
    "negative zero": edited("p_S: [1, 0, 0]", "p_S: [1, -0.0, 0]"),
}
OTHER = {
    "another seed": LAB + "seed: 1\n",
    "a changed agent": edited("kind: model_based", "kind: model_based, epsilon: 0.1"),
    "a changed human": edited("p_M: 0.1", "p_M: 0.2"),
    "less recorded": LAB + "record: {steps: none}\n",
    "seven rooms": LAB + "    goal_rooms: [0, 1, 2, 3, 4, 5, 6]\n",
    "a grid": LAB + "vary: {agents.mb.epsilon: [0.1]}\n",
}


@pytest.mark.parametrize("text", SAME.values(), ids=SAME)
def test_what_is_the_same_has_the_same_hash(loaded: Load, text: str) -> None:
    assert text != LAB
    assert config_hash(loaded(text)) == config_hash(loaded(LAB))


@pytest.mark.parametrize("text", OTHER.values(), ids=OTHER)
def test_what_differs_has_another_hash(loaded: Load, text: str) -> None:
    assert config_hash(loaded(text)) != config_hash(loaded(LAB))


def test_the_only_human_of_a_social_module_need_not_be_named(loaded: Load) -> None:
    one = edited("[human_1, human_2]", "[human_2]")
    short = loaded(edited("social/mb/human_2", "social/mb", one))
    assert short == loaded(one)
    assert short.experiments["visit"].modules.social == "social/mb/human_2"


@pytest.mark.parametrize("text", [*SAME.values(), *OTHER.values()], ids=[*SAME, *OTHER])
def test_a_dump_loads_as_it_was(loaded: Load, text: str) -> None:
    config = loaded(text)
    again = loaded(dump_yaml(config))
    assert again == config
    assert config_hash(again) == config_hash(config)
    assert dump_yaml(again) == dump_yaml(config)


def test_a_dump_of_a_visit_that_does_not_plan_loads(loaded: Load) -> None:
    config = loaded(edited("social/mb/human_2", "social/mf/human_2"))
    assert "plan_every" not in canonical(config)["experiments"]["visit"]
    assert loaded(dump_yaml(config)) == config


def test_a_dump_hides_nothing(loaded: Load) -> None:
    text = dump_yaml(loaded(LAB + "seed: 5\nseeds: 4\n"))
    assert {"name": "lab", "seed": 5, "seeds": 4}.items() <= yaml.safe_load(text).items()


probabilities = st.floats(0, 1) | st.sampled_from([0, 1, 1e-300, 0.1 + 0.2, 5e-324])
names = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}", fullmatch=True) | st.sampled_from(
    [
        "1e5",
        "010",
        "0x1F",
        "0o7",
        "null",
        "no",
        "true",
        "5",
        "1.0",
        "9" * 50,
        "NULL",
        "1_0",
        "2020-01-01",
        "like",
    ]
)


@st.composite
def configs(draw: st.DrawFn) -> dict[str, Any]:
    humans = draw(st.dictionaries(names, st.fixed_dictionaries({"p_A": probabilities}), min_size=1, max_size=3))
    for human in humans.values():
        slow = draw(st.floats(0, 1))
        human["p_S"] = [slow, 1 - slow, 0]
    agent = draw(names)
    trial_steps = draw(st.integers(1, 1000))
    social = {
        "task": "social", "agents": [agent], "humans": list(humans), "trial_steps": trial_steps,
        "steps": trial_steps * draw(st.integers(1, 10**6)), "direction_change": draw(probabilities),
    }  # fmt: skip
    return {
        "name": draw(names),
        "seed": draw(st.integers(0, 2**63 - 1)),
        "humans": humans,
        "agents": {agent: {"kind": "model_based", "gamma": draw(st.floats(0, 0.999)), "epsilon": draw(probabilities)}},
        "experiments": {draw(names): social},
        "record": {"steps": draw(st.sampled_from(["every", "none"]) | st.builds(dict, one_trial_in=st.integers(1, 9)))},
    }


@given(configs())
def test_any_config_survives_its_dump(plain: dict[str, Any]) -> None:
    config, issues = check(plain)
    if config is None:  # two humans may differ in case only
        assert all("differs from" in issue.message for issue in issues)
        return
    again = load_text(dump_yaml(config), "dump")
    assert again == config
    assert config_hash(again) == config_hash(config)


def test_plain_values_can_be_built_without_a_file() -> None:
    plain = yaml.safe_load(LAB)
    assert build(located(plain, Place("here")), []) == load_text(LAB, "here")


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("", ["log:1:1: agents: missing", "log:1:1: experiments: missing", "log:1:1: name: missing"]),
        ("[1]", ["log:1:1: must be a mapping"]),
    ],
)
def test_a_text_that_is_no_config(text: str, lines: list[str]) -> None:
    with pytest.raises(ConfigError) as error:
        load_text(text, "log")
    assert sorted(str(error.value).split("\n")) == lines
