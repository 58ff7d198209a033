"""`include`: other files' sections, merged by key."""

import os
from collections.abc import Sequence
from pathlib import Path

from visitlab_cli.config.document import Node
from visitlab_cli.config.files import read_file
from visitlab_cli.config.problems import Problem, printable
from visitlab_cli.errors import NotFoundError

INCLUDE = "include"
OWN_KEYS = ("name", "seed", "seeds", "record")
"""What a file does not take over from those that it includes."""


def read_with_includes(path: Path) -> tuple[Node, list[Problem]]:
    """A file with everything that it includes, and what was wrong on the way.

    Raises:
        NotFoundError, ConfigError: as `read_file`.
    """
    return _read(path, [_identity(path)])


def _read(path: Path, chain: Sequence[str]) -> tuple[Node, list[Problem]]:
    document, problems = read_file(path)
    entries = dict(document.value)
    included = entries.pop(INCLUDE, None)
    document = document.with_entries(entries)
    for entry in _names(included, problems):
        target = path.parent / str(entry.value)
        if _identity(target) in chain:
            message = f"{printable(entry.value)} includes this file in turn"
            problems.append(Problem(entry.place, (INCLUDE,), message))
            continue
        try:
            other, others_problems = _read(target, [*chain, _identity(target)])
        except NotFoundError as error:
            problems.append(Problem(entry.place, (INCLUDE,), str(error)))
            continue
        problems += others_problems
        document = _merged(document, other, problems)
    return document, problems


def _identity(path: Path) -> str:
    try:
        return os.path.realpath(path)
    except ValueError:  # a NUL in the name
        return str(path)


def _names(included: Node | None, problems: list[Problem]) -> list[Node]:
    if included is None:
        return []
    if not isinstance(included.value, list):
        problems.append(Problem(included.place, (INCLUDE,), "must be a list of files"))
        return []
    for index, entry in enumerate(included.value):
        if not isinstance(entry.value, str):
            problems.append(Problem(entry.place, (INCLUDE, index), "must be the name of a file"))
    return [entry for entry in included.value if isinstance(entry.value, str)]


def _merged(document: Node, other: Node, problems: list[Problem]) -> Node:
    """`document` with the sections of `other`; a key in both must have the same value in both."""
    entries = dict(document.value)
    for section, theirs in other.value.items():
        ours = entries.get(section)
        if section in OWN_KEYS:
            continue
        if ours is None:
            entries[section] = theirs
        elif isinstance(ours.value, dict) and isinstance(theirs.value, dict):
            _report_differences(section, ours, theirs, problems)
            entries[section] = ours.with_entries({**theirs.value, **ours.value})
        elif ours.plain() != theirs.plain():
            problems.append(Problem(ours.key or ours.place, (section,), f"differs from that at {theirs.key}"))
    return document.with_entries(entries)


def _report_differences(section: str, ours: Node, theirs: Node, problems: list[Problem]) -> None:
    for name in ours.value.keys() & theirs.value.keys():
        mine, other = ours.value[name], theirs.value[name]
        if mine.plain() != other.plain():
            message = f"differs from that at {other.key}; give it a name of its own"
            problems.append(Problem(mine.key or mine.place, (section, name), message))
