"""`include`: other files' sections, merged by key."""

import os
from collections.abc import Sequence
from pathlib import Path

from visitlab_cli.errors import NotFoundError
from visitlab_cli.wording import printable
from visitlab_cli.yaml.document import Node
from visitlab_cli.yaml.files import MOST_BYTES, UnreadableError, read_bytes, read_content
from visitlab_cli.yaml.problems import Problem, failure
from visitlab_cli.yaml.reader import MOST_VALUES

INCLUDE = "include"
MOST_FILES = 32

Identity = tuple[int, int]
"""A file's device and number, which are the same by whatever name it is found."""


def read_with_includes(
    path: Path, own_keys: Sequence[str] = (), elsewhere: Path | None = None
) -> tuple[Node, list[Problem]]:
    """A file with everything that it includes, and what was wrong on the way.

    Args:
        path: of the file.
        own_keys: what a file does not take over from those that it includes.
        elsewhere: the folder of what is included and is not beside the file that includes it.

    Raises:
        NotFoundError, ConfigError: as `read_bytes` and `read_content`.
    """
    reading = _Reading(own_keys, elsewhere)
    return reading.whole(path, ()), reading.problems


class _Reading:
    """All the files of one config; each is read once, however often it is included."""

    def __init__(self, own_keys: Sequence[str], elsewhere: Path | None) -> None:
        self.own_keys = own_keys
        self.elsewhere = elsewhere
        self.problems: list[Problem] = []
        self.files: dict[Identity, Node] = {}
        self.begun = self.bytes = self.values = 0

    def whole(self, path: Path, chain: Sequence[Identity]) -> Node:
        """A file with what it includes; `chain` are those that include it, one the other.

        Raises:
            NotFoundError: it can't be read, or not at this place.
            ConfigError: nothing of it can be used.
        """
        content, identity = read_bytes(path, itself=not chain, most=MOST_BYTES - self.bytes)
        if identity in chain:
            raise NotFoundError(f"{printable(str(path))} includes this file in turn")
        if identity in self.files:
            return self.files[identity]
        if self.begun == MOST_FILES:
            raise NotFoundError(f"{printable(str(path))} is one file too many; a config has at most {MOST_FILES}")
        self.begun += 1
        self.bytes += len(content)
        document, problems = read_content(content, path)
        self.problems += problems
        self.values += document.size()
        if self.values > MOST_VALUES:
            raise failure([Problem(document.place, (), f"with what includes it more than {MOST_VALUES} values")])
        entries = dict(document.value)
        included = entries.pop(INCLUDE, None)
        document = document.with_entries(entries)
        for entry in _names(included, self.problems):
            try:
                other = self.whole(self._target(entry.value, path.parent), (*chain, identity))
            except (NotFoundError, UnreadableError) as error:
                self.problems.append(Problem(entry.place, (INCLUDE,), str(error)))
                continue
            document = _merged(document, other, self.own_keys, self.problems)
        self.files[identity] = document
        return document

    def _target(self, name: str, beside: Path) -> Path:
        near = beside / os.path.expanduser(name)
        if self.elsewhere is None or os.path.lexists(near) or not os.path.lexists(self.elsewhere / name):
            return near
        return self.elsewhere / name


def _names(included: Node | None, problems: list[Problem]) -> list[Node]:
    if included is None:
        return []
    if not isinstance(included.value, list):
        problems.append(Problem(included.place, (INCLUDE,), "must be a list of files"))
        return []
    if len(included.value) > MOST_FILES:
        problems.append(Problem(included.place, (INCLUDE,), f"at most {MOST_FILES} files (got {len(included.value)})"))
        return []
    for index, entry in enumerate(included.value):
        if not isinstance(entry.value, str):
            problems.append(Problem(entry.place, (INCLUDE, index), "must be the name of a file"))
    return [entry for entry in included.value if isinstance(entry.value, str)]


def _merged(document: Node, other: Node, own_keys: Sequence[str], problems: list[Problem]) -> Node:
    """`document` with the sections of `other`; a key in both must have the same value in both."""
    entries = dict(document.value)
    for section, theirs in other.value.items():
        ours = entries.get(section)
        if section in own_keys:
            continue
        if ours is None:
            entries[section] = theirs
        elif isinstance(ours.value, dict) and isinstance(theirs.value, dict):
            _report_differences(section, ours, theirs, problems)
            entries[section] = ours.with_entries({**theirs.value, **ours.value})
        elif ours is not theirs and ours.plain() != theirs.plain():
            problems.append(Problem(ours.key or ours.place, (section,), f"differs from that at {theirs.key}"))
    return document.with_entries(entries)


def _report_differences(section: str, ours: Node, theirs: Node, problems: list[Problem]) -> None:
    for name in ours.value.keys() & theirs.value.keys():
        mine, other = ours.value[name], theirs.value[name]
        if mine is not other and mine.plain() != other.plain():
            message = f"differs from that at {other.key}; give it a name of its own"
            problems.append(Problem(mine.key or mine.place, (section, name), message))
