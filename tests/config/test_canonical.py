"""One config, one text, one hash."""

from collections.abc import Iterator
from contextlib import contextmanager
from enum import Enum
from typing import Annotated, Any, Literal, get_args

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from pydantic import Field, field_serializer

from tests.config.lab import LAB, Load, edited
from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.agents.registry import AnyAgent
from visitlab_cli.config import building
from visitlab_cli.config.building import build, check
from visitlab_cli.config.canonical import canonical, config_hash, dump_yaml
from visitlab_cli.config.loading import load_text
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import Name
from visitlab_cli.errors import ConfigError
from visitlab_cli.settings import Settings, since
from visitlab_cli.yaml.document import Place, located

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


class Shape(Enum):
    ROUND, FLAT = "round", "flat"


class Decay(Settings):
    from_: float = Field(default=1, alias="from")
    words: frozenset[str] = frozenset()


class TracesParameters(AgentParameters):
    """A kind that somebody adds, with what pydantic allows and ours do not use."""

    kind: Literal["traces"]
    lambda_: float = Field(default=0, ge=0, le=1, alias="lambda")
    loops: int | None = Field(default=None, validation_alias="for", serialization_alias="loops")
    rooms: set[int] = Field(default=set(), json_schema_extra=since("0.2.0"))
    decays: tuple[Decay, ...] = ()
    rates: dict[str, float | None] = {}
    shape: Shape = Shape.ROUND
    text: str | int | float | bool | None = None


KINDS: Any = get_args(AnyAgent)[0] | TracesParameters


class Wider(Config):
    agents: dict[Name, Annotated[KINDS, Field(discriminator="kind")]]


@contextmanager
def added_kind() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(building, "Config", Wider)
        yield


any_float = st.floats(allow_nan=False, allow_infinity=False, width=64).map(lambda number: number + 0.0)
numbers = any_float | st.sampled_from([0, 1, 7, 1e-300, 5e-324, 1.7e308, 1e22, 0.1 + 0.2])
texts = names | st.text(st.characters(exclude_categories=["Cs", "Cc"]), max_size=20)
traces = st.fixed_dictionaries(
    {"kind": st.just("traces")},
    optional={
        "lambda": probabilities,
        "for": st.none() | st.integers(-(10**12), 10**12),
        "rooms": st.lists(st.integers(-3, 8), max_size=4),
        "decays": st.lists(st.fixed_dictionaries({"words": st.lists(texts, max_size=3)}, optional={"from": numbers})),
        "rates": st.dictionaries(texts, st.none() | numbers, max_size=3),
        "shape": st.sampled_from(["round", "flat"]),
        "text": st.none() | texts | numbers | st.booleans(),
    },
)


@given(configs(), traces)
def test_whatever_an_added_kind_takes_survives_its_dump(plain: dict[str, Any], agent: dict[str, Any]) -> None:
    plain["agents"] = dict.fromkeys(plain["agents"], agent)
    with added_kind():
        config, _ = check(plain)
        if config is None:  # two humans may differ in case only
            return
        again = load_text(dump_yaml(config), "dump")
    assert again == config
    assert config_hash(again) == config_hash(config)
    assert canonical(again) == canonical(config)


def test_one_setting_of_an_added_kind_has_one_spelling() -> None:
    def hash_of(agent: str) -> str:
        with added_kind():
            return config_hash(load_text(edited("  rmax: {kind: rmax}", f"  rmax: {{kind: traces{agent}}}"), "lab"))

    reordered = hash_of(", decays: [{words: [b, a, c, b]}]"), hash_of(", decays: [{words: [c, b, a], from: 1}]")
    assert reordered[0] == reordered[1]
    assert hash_of("") == hash_of(", lambda: 0, for: null, rooms: [], rates: {}, decays: [], shape: round")
    assert len({hash_of(""), hash_of(", lambda: 1"), hash_of(", rooms: [1]"), *reordered}) == 4


class TwofoldParameters(TracesParameters):
    """Reads percent, tells a fraction."""

    percent: float = 50

    @field_serializer("percent")
    def _told(self, percent: float) -> float:
        return percent / 100


def test_a_kind_that_is_read_otherwise_than_it_is_written_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    class Twofold(Config):
        agents: dict[Name, TwofoldParameters]  # type: ignore[assignment]

    monkeypatch.setattr(building, "Config", Twofold)
    text = LAB[: LAB.index("agents:")] + (
        "agents:\n  good: {kind: traces, percent: 0}\n  mine: {kind: traces}\n"
        "experiments:\n  navigation: {task: navigation, agents: [good, mine], steps: 100}\n"
    )
    with pytest.raises(ConfigError) as error:
        load_text(text, "lab")
    (line,) = str(error.value).splitlines()
    assert line.startswith("lab:7:3: agents.mine: can't be kept: it is read otherwise than it is written")


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
