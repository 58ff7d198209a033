"""docs/config.md: every section and key of a config, from the models that check it."""

from pathlib import Path

from tests.program import visitlab
from visitlab_cli.config.schema import schema

EXAMPLE = """name: example
humans:
  slow: {p_S: [1, 0, 0], p_A: 0.1}
agents:
  mb: {kind: model_based}
  careless: {like: mb, epsilon: 0.2}
experiments:
  social: {task: social, agents: [mb, careless], humans: [slow], steps: 20000}
vary: {agents.careless.epsilon: [0.1, 0.2, 0.4]}
"""
BROKEN = (("p_A: 0.1", "p_a: 0.1"), ("epsilon: 0.2", "epsilon: 2"), ("humans: [slow]", "humans: [slwo]"))

TEMPLATE = Path(__file__).with_name("config.template.md").read_text(encoding="utf-8")
SECTIONS = {
    "": ("The whole", ""),
    "humans": ("humans", "A human, by any name: {key: value, ...}."),
    "labs": ("labs", "A lab, by any name: a map, or rooms in rows and columns: [what each setting does](labs.md)."),
    "agents": ("agents", "An agent, by any name; its `kind` decides what else it has."),
    "experiments": ("experiments", "A training or a visit, by any name; its `task` decides what else it has."),
    "modules": ("modules of a visit", ""),
    "phases": (
        "phases",
        "A list of these, in place of `humans`, `trials` and `steps`: [what they are for](phases.md).",
    ),
    "interaction": ("interaction", ""),
    "record": ("record", ""),
    "expected": (
        "expected",
        "By `experiment/agent`, `experiment/agent/human` or `visit/human`; where `vary` changes it, its point follows: "
        "`navigation/rmax/agents.rmax.gamma=0.9`.",
    ),
    "figure": ("figure", ""),
}
PARTS = {
    "modules": [{"$ref": "#/$defs/Modules"}],
    "phases": [{"$ref": f"#/$defs/{name}"} for name in ("ModulePhase", "SocialPhase", "VisitPhase")],
}
"""What the models have that is no section of its own."""
TAGS = ("kind", "task")
LARGE = 10_000


def config_page(folder: Path) -> str:
    """The page; what `validate` says of a broken config is tried in `folder`."""
    whole = schema()
    parts = [TEMPLATE.format(example=EXAMPLE, errors=errors(folder))]
    for section, (title, told) in SECTIONS.items():
        node = whole["properties"].get(section, {"oneOf": PARTS.get(section)}) if section else whole
        parts.append(f"## {title}\n")
        parts += [f"{told}\n"] if told else []
        for entry in entries(node, whole["$defs"]):
            tag = next((f"{name}: {entry['properties'][name]['const']}" for name in TAGS if is_tag(entry, name)), "")
            parts += [f"### {tag}\n"] if tag else []
            parts += [f"{entry['description']}\n"] if section else []
            parts.append(table(entry, whole["$defs"]))
    return "\n".join(parts)


def errors(folder: Path) -> str:
    text = EXAMPLE
    for right, wrong in BROKEN:
        assert right in text
        text = text.replace(right, wrong)
    (folder / "broken.yaml").write_text(text)
    return "$ visitlab validate broken.yaml\n" + visitlab("validate", "broken.yaml", cwd=folder).stderr


def is_tag(entry, name):
    return "const" in entry["properties"].get(name, {})


def entries(node, definitions):
    """The objects that a section's node stands for."""
    if "properties" in node:
        return [node]
    if "$ref" in node:
        return [definitions[node["$ref"].rpartition("/")[2]]]
    if "anyOf" in node:
        return [found for each in node["anyOf"] if each.get("type") != "null" for found in entries(each, definitions)]
    if "oneOf" in node:
        return [found for each in node["oneOf"] for found in entries(each, definitions)]
    if "patternProperties" in node:
        (entry,) = node["patternProperties"].values()
        return entries(entry.get("else", entry), definitions)
    return entries(node["additionalProperties"], definitions)


def table(entry, definitions):
    lines = ["| key | value | default | meaning |", "|---|---|---|---|"]
    for key, node in entry["properties"].items():
        if not is_tag(entry, key):
            meaning = node.get("description", "").replace("|", "\\|").replace("<", "&lt;")
            meaning += f" (since {node['since']})" if "since" in node else ""
            lines.append(f"| `{key}` | {value(node, definitions)} | {default(entry, key, node)} | {meaning} |")
    return "\n".join(lines) + "\n" if len(lines) > 2 else "Nothing else.\n"


def default(entry, key, node):
    if key in entry.get("required", ()):
        return "must be given"
    if key == "goal_rooms":
        return "all"
    return in_yaml(node["default"]) if node.get("default") not in (None, {}, []) else ""


def in_yaml(found):
    if isinstance(found, dict):
        return ", ".join(f"{key}: {in_yaml(inner)}" for key, inner in found.items())
    if isinstance(found, list):
        return f"[{', '.join(map(in_yaml, found))}]"
    if isinstance(found, bool):
        return str(found).lower()
    return f"{found:g}" if isinstance(found, float) else str(found)


def value(node, definitions):
    """What may stand there, in words."""
    if "$ref" in node:
        return "below"
    if "enum" in node or "const" in node:
        return " or ".join(f"`{each}`" for each in node.get("enum", [node.get("const")]))
    if "anyOf" in node or "oneOf" in node:
        inner = [each for each in node.get("anyOf", node.get("oneOf")) if each.get("type") != "null"]
        return " or ".join(dict.fromkeys(value(each, definitions) for each in inner))
    kind = node.get("type")
    if kind == "array":
        return f"list of {count(node)}{value(node.get('items', {}), definitions)}"
    if kind in ("integer", "number"):
        return {"integer": "whole number", "number": "number"}[kind] + bounds(node)
    words = {"string": "name" if "pattern" in node else "text", "object": "mapping", "boolean": "true or false"}
    return words[kind] if kind else "any"


def count(node):
    least, most = node.get("minItems"), node.get("maxItems")
    if least is None:
        return ""
    return f"{least}: " if least == most else f"{least} or more: "


def bounds(node):
    """The range in words; a bound so large that it only keeps nonsense out is left away."""
    low, high = (node.get(f"{end}imum", node.get(f"exclusive{end.title()}imum")) for end in ("min", "max"))
    more, less = (
        f", not {bound:g}" if f"exclusive{end}imum" in node else "" for end, bound in (("Min", low), ("Max", high))
    )
    if abs(low) >= LARGE:
        return ""
    return f" from {low:g}{more}" if high >= LARGE else f", {low:g} to {high:g}{more}{less}"
