"""The JSON Schema of a config file, for editors."""

import json
import re
from collections.abc import Sequence
from typing import Any

from visitlab_cli.config.like import LIKE, SECTIONS
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import LOG_ENDING, RESERVED_EXPERIMENTS, RESERVED_RUNS

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def schema_text() -> str:
    """The schema as the text of configs/schema.json."""
    return json.dumps({"$schema": DIALECT, "title": "A config of visitlab", **schema()}, indent=2) + "\n"


def schema() -> dict[str, Any]:
    """Pydantic's schema, with `include` and `like`, which are resolved before validation."""
    result: dict[str, Any] = _without_titles(Config.model_json_schema())
    result["properties"]["include"] = {
        "description": "files, relative to this one, whose sections are merged into it",
        "type": "array",
        "items": {"type": "string"},
    }
    for section in SECTIONS:
        patterns = result["properties"][section]["patternProperties"]
        for pattern, entry in patterns.items():
            other = _starting_from_another(section, entry, result["$defs"])
            patterns[pattern] = {"if": {"required": [LIKE]}, "then": other, "else": entry}
    experiments = result["properties"]["experiments"]
    free = _but(RESERVED_EXPERIMENTS)
    experiments["patternProperties"] = {
        pattern.replace("^", f"^{free}", 1): entry for pattern, entry in experiments["patternProperties"].items()
    }
    name = result["properties"]["name"]
    name["pattern"] = name["pattern"].replace("^", f"^{_but(RESERVED_RUNS)}(?!.*{_any_case(LOG_ENDING)}$)", 1)
    start = result["$defs"]["SocialTraining"]["properties"]["start_from"]
    del start["default"]  # null, which nobody may write
    start |= next(each for each in start.pop("anyOf") if each["type"] == "string")
    for name in ("ModulePhase", "SocialPhase", "VisitPhase"):
        for setting in result["$defs"][name]["properties"].values():
            setting.pop("default", None)  # null, likewise
    for name in ("NavigationTraining", "GoToHumanTraining", "SocialTraining", "Visit"):
        training = result["$defs"][name]
        del training["properties"]["phases"]["default"]  # none, likewise
        if "humans" in training["properties"]:
            del training["properties"]["humans"]["default"]
            training["oneOf"] = [{"required": ["humans"]}, {"required": ["phases"]}]
    for section in ("humans", "labs", "agents", "experiments"):
        result["properties"][section]["additionalProperties"] = False  # what is no name
    result["required"] = ["name"]
    result["anyOf"] = [{"required": ["agents", "experiments"]}, {"required": ["include"]}]
    return result


def _but(words: Sequence[str]) -> str:
    """A pattern's beginning that none of these words fits."""
    return f"(?!(?:{'|'.join(map(_any_case, words))})$)"


def _any_case(word: str) -> str:
    letters = (f"[{each}{each.upper()}]" if each.islower() else re.escape(each) for each in word)
    return "".join(letters)


def _starting_from_another(section: str, entry: dict[str, Any], definitions: dict[str, Any]) -> dict[str, Any]:
    """What an entry with `like` may have: any setting of its section, none of them required."""
    members = [definitions[each["$ref"].rpartition("/")[2]] for each in entry.get("oneOf", [entry])]
    properties: dict[str, Any] = {}
    for member in members:
        for name, setting in member["properties"].items():
            known = properties.setdefault(name, {"anyOf": []})["anyOf"]
            if setting not in known:
                known.append(setting)
    like = {"type": "string", "description": f"the entry of {section} that this one starts from"}
    one_or_any = {name: each["anyOf"][0] if len(each["anyOf"]) == 1 else each for name, each in properties.items()}
    return {"type": "object", "properties": {LIKE: like, **one_or_any}, "additionalProperties": False}


def _without_titles(node: Any) -> Any:
    """Pydantic's titles repeat the keys in other words, which an editor would show first."""
    if isinstance(node, list):
        return [_without_titles(each) for each in node]
    if not isinstance(node, dict):
        return node
    return {key: _without_titles(value) for key, value in node.items() if key != "title" or not isinstance(value, str)}
