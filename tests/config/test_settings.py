"""What a config may say stays what it was: fields, defaults, hashes; what comes later says since when."""

from functools import partial
from typing import Any, Literal

import pytest
from pydantic import BaseModel, Field
from pydantic.fields import FieldInfo
from pydantic_core import to_jsonable_python

from tests.program import TINY
from visitlab_cli.config.canonical import canonical, config_hash, hashed
from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load
from visitlab_cli.config.messages import _models
from visitlab_cli.config.model import Config, Interaction
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.settings import Settings, as_yaml, at_default, keys_of, since, since_of

MUST = "must be given"
TRAINING = {"task": MUST, "agents": MUST, "trial_steps": 20, "steps": 500_000}
FIRST: dict[str, dict[str, Any]] = {
    "Config": {
        "name": MUST, "seed": 0, "seeds": 1, "humans": {}, "agents": MUST, "experiments": MUST,
        "interaction": {"distances": [1, 2, 4, 5]}, "record": {"steps": "every"}, "vary": {}, "expected": {},
    },
    "SixParameters": {"p_S": MUST, "p_H": 0.0, "p_M": 0.0, "p_O": 0.0, "p_A": 0.0, "p_P": 0.0},
    "QLearningParameters": {"kind": MUST, "gamma": 0.9, "epsilon": 0.05, "alpha": 0.5},
    "ModelBasedParameters": {
        "kind": MUST, "gamma": 0.9, "epsilon": 0.05, "plan_every": 1000, "unvisited": "uniform",
    },
    "RMaxParameters": {"kind": MUST, "gamma": 0.9, "r_max": 1.0, "m": None, "plan_every": 1000},
    "ObserverParameters": {"kind": MUST, "watches": MUST, "learner": MUST, "until": MUST, "acts_as": MUST},
    "RandomParameters": {"kind": MUST},
    "ScriptedParameters": {"kind": MUST},
    "NavigationTraining": TRAINING,
    "GoToHumanTraining": {**TRAINING, "success": "facing"},
    "SocialTraining": {**TRAINING, "humans": [], "arena": 120, "direction_change": 0.2, "start_from": None},
    "Visit": {
        "task": MUST, "modules": MUST, "humans": [], "trials": 1000, "trial_steps": 100, "plan_every": 100,
        "models": "paired", "goal_rooms": "all", "planner_rewards": "carried",
        "social_reward": "social",
    },
    "Modules": {"navigation": MUST, "go_to_human": MUST, "social": MUST},
    "Interaction": {"distances": [1, 2, 4, 5]},
    "Record": {"steps": "every"},
    "OneTrialIn": {"one_trial_in": MUST},
    "Expected": {"value": MUST, "tolerance": MUST, "trials": None},
}  # fmt: skip
"""The fields of version 0.1.0 and their defaults: nothing comes to these, goes, or changes. They are in every hash.

(`all` is read as the numbers of the paper's nine rooms, as it was. `humans` had to be given then; who leaves them out
now says phases, and has another hash for these.)
"""

SYMMETRIC = {"symmetric": ("0.2.0", False)}
PHASES = {"phases": ("0.2.0", [])}
HIDDEN = {"observe": ("0.2.0", "levels"), "belief": ("0.2.0", None)}
LAB = {"lab": ("0.2.0", "paper")}
LATER: dict[str, dict[str, tuple[str, Any]]] = {
    **{name: SYMMETRIC for name in ("QLearningParameters", "RMaxParameters")},
    **{name: PHASES | LAB for name in ("NavigationTraining", "GoToHumanTraining")},
    "SocialTraining": PHASES | HIDDEN,
    "ModelBasedParameters": SYMMETRIC
    | {"prior_strength": ("0.2.0", None), "exploration": ("0.2.0", "epsilon"), "bonus": ("0.2.0", None)},
    "Config": {"labs": ("0.2.0", {}), "figure": ("0.2.0", None)},
    "Visit": PHASES
    | LAB
    | HIDDEN
    | {
        "controller": ("0.2.0", "paper"),
        "told": ("0.2.0", False),
        "learns": ("0.2.0", ["social"]),
        "navigation_model": ("0.2.0", "last_seen"),
    },
}
"""The version that a field came with, and its default, by the model: what comes to a model of `FIRST` is told here."""

HASHES = {
    "beyond/doors": "f08c50a4", "beyond/hidden": "3511f468", "beyond/labs": "3fe4e1ef", "beyond/leading": "5610060a",
    "beyond/adaptation": "22663ee4", "beyond/friends": "e3e3b40b", "beyond/strangers": "b777d315",
    "beyond/symmetry": "45768628", "beyond/coordination": "63a190ab", "beyond/planners": "2e3e4366",
    "beyond/exploration": "cbe10a6d",
    "generalisation": "0a09fb53", "my-human": "3ed1abad", "paper": "c7c38838", "quickstart": "621f9df4",
    "paper/fig6_bootstrap": "824627de", "paper/fig6_go_to_human": "e03a6c1e", "paper/fig6_navigation": "fdd34bd0",
    "paper/fig6_social": "824627de", "paper/fig7": "35c89a7c", "paper/fig8_adaptation": "c161c773",
    "paper/fig8_humans": "0c00ff20", "paper/fig9": "cfe9ec5b", "paper/variants/fig6_bootstrap_alpha": "ce163e19",
    "paper/variants/fig8_best_match": "5a90f600", "paper/variants/fig8_best_match_crossed": "69d74e34",
    "paper/variants/fig8_best_match_first": "42fc451c", "paper/variants/fig8_crossed": "4c4a96c1",
    "paper/variants/fig8_first": "2b93ee52", "paper/variants/fig8_planner": "39815868",
    "paper/variants/fig8_rooms": "56c44d0d", "paper/variants/fig8_training": "5ae3a88d",
    "paper/variants/fig8_unrewarded": "49299700", "paper/variants/success_seen": "dfc22f71",
    "paper/variants/unvisited_zero": "b5668775",
}  # fmt: skip
"""A run of each of these is somebody's finished work: another hash makes it all anew."""


def models_of(model: type[BaseModel]) -> dict[str, type[BaseModel]]:
    """A model and all that its fields may hold, by name."""
    found = {model.__name__: model}
    for field in model.model_fields.values():
        for inner in _models(field.annotation):
            found |= {} if inner.__name__ in found else models_of(inner)
    return found


def default_of(field: FieldInfo) -> Any:
    return MUST if field.is_required() else to_jsonable_python(field.get_default(call_default_factory=True))


def complaints(model: type[BaseModel]) -> list[str]:
    """What is wrong with the fields of a model, as somebody who changed one should know it."""
    name = model.__name__
    first, later = FIRST.get(name), LATER.get(name, {})
    found = []
    for key, field in model.model_fields.items():
        version, default = since_of(field), default_of(field)
        if first is not None and key not in first and (version, default) != later.get(key):
            found.append(f"{name}.{key}: say since(version), and its version and default in LATER")
        if first is not None and key in first and (version, default) != (None, first[key]):
            found.append(f"{name}.{key}: was there from the first, with the default {first[key]}, which stays")
        if version is not None and field.is_required():
            found.append(f"{name}.{key}: came later, so it needs a default that changes nothing")
    return found + [f"{name}.{key}: is gone" for key in [*(first or ()), *later] if key not in model.model_fields]


def test_no_field_and_no_default_changes_and_what_comes_later_says_so() -> None:
    models = models_of(Config)
    assert models.keys() >= FIRST.keys()
    assert [line for model in models.values() for line in complaints(model)] == []


@pytest.mark.parametrize(
    ("fields", "line"),
    [
        ({"distances": FIRST["Interaction"]["distances"]}, None),
        ({"distances": [1, 2, 4, 6]}, "was there from the first"),
        ({"distances": Field(default=[1, 2, 4, 5], json_schema_extra=since("0.2.0"))}, "was there from the first"),
        ({}, "is gone"),
        ({"distances": [1, 2, 4, 5], "noise": 0.0}, "say since"),
        ({"distances": [1, 2, 4, 5], "noise": Field(default=0.0, json_schema_extra=since("0.2.0"))}, "say since"),
        ({"distances": [1, 2, 4, 5], "noise": Field(json_schema_extra=since("0.2.0"))}, "needs a default"),
    ],
)
def test_the_guard_sees_what_it_is_to_see(fields: dict[str, Any], line: str | None) -> None:
    body = {"__annotations__": dict.fromkeys(fields, Any), **fields}
    found = complaints(type("Interaction", (BaseModel,), body))
    assert [line] * bool(line) == [line for each in found[-1:] if line in each]
    assert bool(found) == bool(line)


@pytest.mark.parametrize("name", HASHES)
def test_a_shipped_config_keeps_its_hash(name: str) -> None:
    assert config_hash(load(name)) == HASHES[name]


def test_every_shipped_config_is_pinned_and_so_is_one_with_every_kind_of_agent() -> None:
    assert HASHES.keys() == shipped_configs().keys()
    assert config_hash(load(TINY)) == "54e75efa"


class NewHuman(SixParameters):
    """What a later version may add: a number, a list, a set, a nested part."""

    p_N: float = Field(default=0, json_schema_extra=since("0.2.0"))
    rooms: tuple[int, ...] = Field(default=(), json_schema_extra=since("0.2.0"))
    words: frozenset[str] = Field(default=frozenset({"a", "b"}), json_schema_extra=since("0.2.0"))
    near: Interaction = Field(default=Interaction(), json_schema_extra=since("0.2.0"))


NEW = {"p_N": 0.5, "rooms": [1], "words": ["a"], "near": {"distances": [1, 2, 4, 6]}}


def lab_with(human: dict[str, Any], model: type[SixParameters]) -> Config:
    config = load(TINY)
    humans = {**config.humans, "slow": model(p_S=(1, 0, 0), p_M=0.1, p_O=0.1, **human)}
    return config.model_copy(update={"humans": humans})


def test_a_setting_that_came_later_is_in_the_hash_only_where_it_is_not_at_its_default() -> None:
    before, with_new = lab_with({}, SixParameters), partial(lab_with, model=NewHuman)
    at_defaults = {"p_N": 0.0, "rooms": [], "words": {"b", "a"}, "near": {}}
    assert config_hash(with_new({})) == config_hash(with_new(at_defaults)) == config_hash(before)
    assert len({config_hash(before), *(config_hash(with_new({key: value})) for key, value in NEW.items())}) == 5
    told = canonical(with_new({}))["humans"]["slow"]
    assert (told["p_N"], told["rooms"], told["words"]) == (0.0, [], ["a", "b"])
    assert "near" not in hashed(with_new({}))["humans"]["slow"]


class Aliased(Settings):
    """Names that Python does not allow."""

    kind: Literal["aliased"] = "aliased"
    lambda_: float = Field(default=0, alias="lambda")
    loop: int = Field(default=1, serialization_alias="Loop", validation_alias="for")


def test_settings_are_told_by_the_keys_that_they_are_read_by() -> None:
    assert keys_of(Aliased) == ["kind", "lambda", "for"]
    assert as_yaml(Aliased()) == {"kind": "aliased", "lambda": 0.0, "for": 1}
    assert str(as_yaml(Aliased())["lambda"]) == "0.0"
    assert as_yaml(Aliased(**{"lambda": 0.25, "for": 3})) == {"kind": "aliased", "lambda": 0.25, "for": 3}
    assert at_default(Aliased(**{"lambda": 0.25})) == {"kind", "for"}
