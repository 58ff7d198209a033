"""`schema`: what it prints is the shipped file, and the shipped configs name it."""

import json

import pytest

from tests.program import visitlab
from visitlab_cli.config.files import shipped_configs, shipped_folder

FILE = shipped_folder() / "schema.json"
SECTIONS = {"name", "seed", "seeds", "humans", "agents", "experiments", "vary", "include", "record"}


def test_the_shipped_schema_is_current():
    done = visitlab("schema")
    assert done.returncode == 0
    assert done.stdout == FILE.read_text(), "run `visitlab schema > configs/schema.json`"


def test_it_is_a_schema_of_the_sections():
    schema = json.loads(FILE.read_text())
    assert set(schema["properties"]) >= SECTIONS
    assert schema["additionalProperties"] is False


def definitions(node):
    if isinstance(node, dict):
        yield from (value for key, value in node.items() if key == "$ref")
        for value in node.values():
            yield from definitions(value)
    if isinstance(node, list):
        for value in node:
            yield from definitions(value)


def test_every_reference_leads_somewhere():
    schema = json.loads(FILE.read_text())
    found = set(definitions(schema))
    assert len(found) > 10
    assert found <= {f"#/$defs/{name}" for name in schema["$defs"]}


def test_an_entry_with_like_may_have_any_setting_of_its_section_and_no_other():
    schema = json.loads(FILE.read_text())
    (agent,) = schema["properties"]["agents"]["patternProperties"].values()
    assert {"like", "kind", "epsilon", "alpha", "r_max", "watches"} <= set(agent["then"]["properties"])
    assert agent["then"]["additionalProperties"] is False
    assert "required" not in agent["then"]


@pytest.mark.parametrize("name", ["quickstart", "my-human"])
def test_a_config_to_start_from_names_its_schema(name):
    assert shipped_configs()[name].read_text().startswith("# yaml-language-server: $schema=schema.json\n")
