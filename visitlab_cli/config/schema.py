"""The JSON Schema of a config file, for editors."""

from typing import Any

from visitlab_cli.config.like import LIKE, SECTIONS
from visitlab_cli.config.model import Config


def schema() -> dict[str, Any]:
    """Pydantic's schema, with `include` and `like`, which are resolved before validation."""
    result = Config.model_json_schema()
    result["properties"]["include"] = {
        "description": "files, relative to this one, whose sections are merged into it",
        "type": "array",
        "items": {"type": "string"},
    }
    for section in SECTIONS:
        patterns = result["properties"][section]["patternProperties"]
        for pattern, entry in patterns.items():
            like = {"type": "string", "description": f"the entry of {section} that this one starts from"}
            other = {"type": "object", "properties": {LIKE: like}}
            patterns[pattern] = {"if": {"required": [LIKE]}, "then": other, "else": entry}
    for section in ("humans", "agents", "experiments"):
        result["properties"][section]["additionalProperties"] = False  # what is no name
    result["required"] = ["name"]
    result["anyOf"] = [{"required": ["agents", "experiments"]}, {"required": ["include"]}]
    return result
