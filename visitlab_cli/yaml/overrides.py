"""`key=value` on the command line: edits of the document before `like` is resolved."""

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

from visitlab_cli.errors import UsageError
from visitlab_cli.wording import or_else, shown
from visitlab_cli.yaml.document import Node, Place, split_path
from visitlab_cli.yaml.include import INCLUDE
from visitlab_cli.yaml.problems import Problem
from visitlab_cli.yaml.reader import read_yaml

MOST_OVERRIDES = 200
LONGEST_KEY = 200


class Sections(NamedTuple):
    """What an override has to know of a document.

    `named` says what the entries of a section are, by its name; keys of the `dotted` sections contain dots.
    """

    named: Mapping[str, str]
    dotted: Collection[str]


def apply_overrides(document: Node, overrides: Sequence[str], sections: Sections) -> tuple[Node, list[Problem]]:
    """The document with each `key=value` set in turn, and what was wrong; `key=null` leaves out what is there.

    Raises:
        UsageError: for an override that is not `key=value`.
        ConfigError: for a value that is not YAML.
    """
    problems: list[Problem] = []
    if len(overrides) > MOST_OVERRIDES:
        raise UsageError(f"{len(overrides)} overrides; at most {MOST_OVERRIDES}, write a config instead")
    for override in overrides:
        key, equals, text = override.partition("=")
        if not equals or not all(key.split(".")) or len(key) > LONGEST_KEY:
            raise UsageError(f"override {shown(override)}: must be key=value, such as seeds=10")
        source = source_of(override)
        value, found = read_yaml(text, source, lines=False)
        problems += found
        place = Place(source)
        new = Node(None if value is None else value.value, place, place)
        is_null = value is not None and value.value is None
        document = _override(document, key, new, sections, problems, is_null=is_null)
    return document, problems


def source_of(override: str) -> str:
    """The source of the places that an override makes."""
    return f"override {shown(override)}"


def _override(
    document: Node, key: str, value: Node, sections: Sections, problems: list[Problem], *, is_null: bool
) -> Node:
    """The document with the value under the key; null leaves out what is written there."""
    path = key.split(".", 1) if key.split(".", 1)[0] in sections.dotted else split_path(document, key)
    if path[0] == INCLUDE:
        problems.append(Problem(value.place, (INCLUDE,), "cannot be overridden"))
        return document
    if path[0] in sections.named and len(path) > 2:
        names = list(document.value[path[0]].entries()) if path[0] in document.value else []
        if path[1] not in names:
            message = f"no {sections.named[path[0]]} of this name{or_else(path[1], names)}"
            problems.append(Problem(value.place, (path[0], path[1]), message))
            return document
    node, _ = document.nearest(path[:-1])
    if isinstance(node.value, list):
        whole = key.rpartition(".")[0]
        message = f"{whole} is a list; give it whole, as in {whole}=[{', '.join(map(str, node.plain()))}]"
        problems.append(Problem(value.place, tuple(path), message))
        return document
    is_written = document.nearest(path)[1]
    return _without(document, path) if is_null and is_written else _with(document, path, value)


def _with(node: Node, path: Sequence[str], value: Node) -> Node:
    """A copy in which `path` has `value`; mappings on the way are made where there are none."""
    if not path:
        return value
    inner = node.entries().get(path[0], Node({}, value.place, value.place))
    return node.with_entries({**node.entries(), path[0]: _with(inner, path[1:], value)})


def _without(node: Node, path: Sequence[str]) -> Node:
    """A copy without what is at `path`."""
    entries = dict(node.entries())
    if len(path) == 1:
        del entries[path[0]]
    else:
        entries[path[0]] = _without(entries[path[0]], path[1:])
    return node.with_entries(entries)
