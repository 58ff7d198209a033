"""What differs between two plain documents, such as two configs, by dotted path."""

import json
from collections.abc import Mapping, Sequence
from enum import Enum
from typing import Any, NamedTuple

from visitlab_cli.wording import few

MOST_DIFFERENCES = 5


class Nothing(Enum):
    """What stands at a path that one of the documents lacks (None is a value)."""

    MISSING = "missing"


MISSING = Nothing.MISSING


class Difference(NamedTuple):
    """A path at which two documents have different values."""

    path: str
    first: Any
    second: Any

    def __str__(self) -> str:
        return f"{self.path} is {shown(self.second)}, not {shown(self.first)}"

    def as_json(self, first: str, second: str) -> dict[str, Any]:
        """Plain values under the keys `first` and `second`; what is missing has no key."""
        values = {first: self.first, second: self.second}
        return {"path": self.path} | {name: value for name, value in values.items() if value is not MISSING}


def shown(value: Any) -> str:
    """A value on one line."""
    return MISSING.value if value is MISSING else json.dumps(value, ensure_ascii=False)


def flat(document: Mapping[str, Any], path: str = "") -> dict[str, Any]:
    """The values of nested mappings by dotted path; a list is one value, an empty mapping none."""
    found: dict[str, Any] = {}
    for key, value in document.items():
        where = f"{path}.{key}" if path else key
        found |= flat(value, where) if isinstance(value, Mapping) else {where: value}
    return found


def differences(first: Mapping[str, Any], second: Mapping[str, Any]) -> list[Difference]:
    """Every path at which two nested mappings differ, sorted."""
    ours, theirs = flat(first), flat(second)
    pairs = [(path, ours.get(path, MISSING), theirs.get(path, MISSING)) for path in sorted(ours | theirs)]
    return [Difference(*pair) for pair in pairs if pair[1] != pair[2]]


def in_words(found: Sequence[Difference]) -> str:
    """The first few differences, and how many more there are."""
    return few(found, MOST_DIFFERENCES)
