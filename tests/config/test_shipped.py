"""The configs that visitlab ships, its JSON Schema, and what importing costs."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from visitlab_cli.config.canonical import config_hash, dump_yaml
from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load
from visitlab_cli.config.model import Config
from visitlab_cli.config.schema import schema

REPOSITORY = Path(__file__).parents[2]

TABLE_1 = {
    "human_1": ((1, 0, 0), 0, 0.1, 0.1, 0, 0),
    "human_2": ((0, 0.5, 0.5), 0.05, 0.05, 0.15, 0.05, 0),
    "human_3": ((0.33, 0.33, 0.34), 0.5, 0.2, 0.3, 0.1, 0.5),
    "human_2_pointing": ((0, 0.5, 0.5), 0.05, 0.05, 0.15, 0.05, 1),
}


@pytest.mark.parametrize("name", ["quickstart", "paper"])
def test_a_shipped_config_loads_by_name_and_by_file(name: str) -> None:
    config = load(name)
    assert config.name == name
    assert config == load(REPOSITORY / "configs" / f"{name}.yaml")


@pytest.mark.parametrize("name", shipped_configs())
def test_a_shipped_config_survives_its_dump(name: str, tmp_path: Path) -> None:
    (tmp_path / "config.yaml").write_text(dump_yaml(load(name)))
    again = load(tmp_path / "config.yaml")
    assert again == load(name)
    assert config_hash(again) == config_hash(load(name))


def test_the_humans_are_those_of_table_1() -> None:
    humans = load("paper").humans
    assert {name: tuple(human.model_dump().values()) for name, human in humans.items()} == TABLE_1
    assert tuple(load("quickstart").humans["human_2"].model_dump().values()) == TABLE_1["human_2"]


def test_quickstart_is_1_3_million_steps_at_the_papers_lengths() -> None:
    config = load("quickstart")
    trainings = [e.steps for e in config.experiments.values() if e.task != "visit"]
    visit = config.experiments["visit"]
    assert trainings == [500_000, 200_000, 500_000]
    assert (visit.trials, visit.trial_steps, visit.planner_rewards) == (1000, 100, "carried")
    assert (config.seeds, config.record.one_trial_in) == (1, 1)
    assert set(config.expected) == {"navigation/rmax", "go_to_human/mb", "social/mb/human_2", "visit/human_2"}


def test_the_agents_defaults_are_those_of_section_4_2() -> None:
    assert load("quickstart").agents["mb"] == load("paper").agents["mb"]
    assert load("quickstart").agents["rmax"] == load("paper").agents["rmax"]


def described(node: Any, path: str) -> list[str]:
    """The settings in a JSON Schema that nobody explains."""
    missing = []
    for name, setting in node.get("properties", {}).items():
        if "description" not in setting and name not in ("kind", "task"):
            missing.append(f"{path}.{name}")
    for name, definition in node.get("$defs", {}).items():
        missing += described(definition, name)
    return missing


def test_the_schema_explains_every_setting_and_knows_include_and_like() -> None:
    result = schema()
    assert described(result, "") == []
    assert set(result["properties"]) == {*Config.model_fields, "include"}
    (human,) = result["properties"]["humans"]["patternProperties"].values()
    assert (human["if"], human["else"]) == ({"required": ["like"]}, {"$ref": "#/$defs/SixParameters"})


def test_importing_the_room_imports_nothing_heavy() -> None:
    code = "import sys, visitlab_cli.config; print({'pydantic', 'yaml', 'numba', 'numpy'} & set(sys.modules))"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=REPOSITORY)
    assert found.stdout == "set()\n"
