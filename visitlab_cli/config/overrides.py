"""`key=value` on the command line: edits of the document before `like` is resolved."""

from collections.abc import Sequence

from visitlab_cli.config.document import Node, Place, split_path
from visitlab_cli.config.include import INCLUDE
from visitlab_cli.config.problems import Problem, or_else, shown
from visitlab_cli.config.yaml_reader import read_yaml
from visitlab_cli.errors import UsageError

EXPECTED = "expected"
MOST_OVERRIDES = 200
LONGEST_KEY = 200
HARMLESS = ("seed", "seeds")
"""What may be overridden without making the expected values meaningless."""
NAMED = {"humans": "human", "agents": "agent", "experiments": "experiment"}
DOTTED_KEYS = ("vary",)


def apply_overrides(document: Node, overrides: Sequence[str]) -> tuple[Node, list[Problem]]:
    """The document with each `key=value` set in turn, and what was wrong.

    The document's `expected` is dropped where anything but `seed`, `seeds` and `expected` itself is overridden.

    Raises:
        UsageError: for an override that is not `key=value`.
        ConfigError: for a value that is not YAML.
    """
    problems: list[Problem] = []
    if len(overrides) > MOST_OVERRIDES:
        raise UsageError(f"{len(overrides)} overrides; at most {MOST_OVERRIDES}, write a config instead")
    keys = [override.partition("=")[0] for override in overrides]
    if any(key not in HARMLESS and key.split(".")[0] != EXPECTED for key in keys):
        document = document.with_entries({key: node for key, node in document.value.items() if key != EXPECTED})
    for override in overrides:
        key, equals, text = override.partition("=")
        if not equals or not all(key.split(".")) or len(key) > LONGEST_KEY:
            raise UsageError(f"override {shown(override)}: must be key=value, such as seeds=10")
        source = f"override {shown(override)}"
        value, found = read_yaml(text, source, lines=False)
        problems += found
        place = Place(source)
        value = value or Node(None, place)
        document = _override(document, key, Node(value.value, place, place), problems)
    return document, problems


def _override(document: Node, key: str, value: Node, problems: list[Problem]) -> Node:
    path = key.split(".", 1) if key.split(".", 1)[0] in DOTTED_KEYS else split_path(document, key)
    if path[0] == INCLUDE:
        problems.append(Problem(value.place, (INCLUDE,), "cannot be overridden"))
        return document
    if path[0] in NAMED and len(path) > 2:
        names = list(document.value[path[0]].entries()) if path[0] in document.value else []
        if path[1] not in names:
            message = f"no {NAMED[path[0]]} of this name{or_else(path[1], names)}"
            problems.append(Problem(value.place, (path[0], path[1]), message))
            return document
    node, _ = document.nearest(path[:-1])
    if isinstance(node.value, list):
        whole = key.rpartition(".")[0]
        message = f"{whole} is a list; give it whole, as in {whole}=[{', '.join(map(str, node.plain()))}]"
        problems.append(Problem(value.place, tuple(path), message))
        return document
    return _with(document, path, value)


def _with(node: Node, path: Sequence[str], value: Node) -> Node:
    """A copy in which `path` has `value`; mappings on the way are made where there are none."""
    if not path:
        return value
    inner = node.entries().get(path[0], Node({}, value.place, value.place))
    return node.with_entries({**node.entries(), path[0]: _with(inner, path[1:], value)})
