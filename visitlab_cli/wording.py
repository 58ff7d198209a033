"""How a message names things: printable, short, a few of many, and the one that was probably meant."""

import difflib
import itertools
from collections.abc import Iterable, Sequence
from typing import Any

LONGEST_SHOWN = 60
MOST_NAMES = 20
MOST_COMPARED = 5_000
MEANT = "; did you mean "


def cut(text: str) -> str:
    """A text, or its beginning."""
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}..."


def printable(text: str) -> str:
    """A name as it is, or quoted and escaped if it could break the line."""
    return text if text.isprintable() else repr(text)


def shown(value: Any) -> str:
    """A value in a message, on one line and not too long."""
    if isinstance(value, dict | list | tuple):
        return "a mapping" if isinstance(value, dict) else "a list"
    return cut({None: "nothing", True: "true", False: "false"}[value] if _is_word(value) else repr(value))


def _is_word(value: Any) -> bool:
    return value is None or isinstance(value, bool)


def few(things: Sequence[Any], most: int) -> str:
    """The first `most` of some things in words, and how many more there are."""
    more = f" and {len(things) - most} more" if len(things) > most else ""
    return ", ".join(map(str, things[:most])) + more


_compared = itertools.count()


def start_comparing() -> None:
    """Names are compared anew: a config with thousands of wrong ones gets suggestions for the first of them only."""
    global _compared
    _compared = itertools.count()


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """The known name that `name` is probably a slip of."""
    by_lower = {other.lower(): other for other in reversed(list(known))}
    if len(by_lower) > MOST_COMPARED or len(name) > LONGEST_SHOWN or next(_compared) * len(by_lower) > MOST_COMPARED:
        return None
    near = difflib.get_close_matches(name.lower(), by_lower, n=1, cutoff=0.6)
    return by_lower[near[0]] if near else None


def or_else(name: Any, known: Sequence[str]) -> str:
    """How a message about an unknown name ends: the nearest known name, else all of them."""
    near = nearest_name(name, known) if isinstance(name, str) else None
    if near is not None:
        return f"{MEANT}{printable(near)}?"
    names = [printable(cut(other)) for other in known[:MOST_NAMES]] + ["..."] * (len(known) > MOST_NAMES)
    return f"; known: {', '.join(names)}" if names else "; none is declared"
