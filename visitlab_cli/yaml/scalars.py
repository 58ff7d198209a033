"""What an unquoted YAML word means: the core schema of YAML 1.2, in which `no` is text and `010` is ten."""

import re
from typing import Any

LONGEST_NUMBER = 40

_WORDS: dict[str, Any] = {
    "": None,
    **dict.fromkeys(("~", "null", "Null", "NULL"), None),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
    **{sign + word: float(f"{sign}inf") for sign in ("", "+", "-") for word in (".inf", ".Inf", ".INF")},
}
_INTEGER = re.compile(r"[-+]?[0-9]+", re.ASCII)
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", re.ASCII)
_BASES = {"0o": (re.compile("0o[0-7]+"), 8), "0x": (re.compile("0x[0-9a-fA-F]+"), 16)}


def meaning(word: str) -> Any:
    """The value of an unquoted word.

    Raises:
        ValueError: for a number of more than 40 digits.
    """
    if word in _WORDS:
        return _WORDS[word]
    pattern, base = _BASES.get(word[:2], (_INTEGER, 10))
    is_integer = pattern.fullmatch(word)
    if not is_integer and not _FLOAT.fullmatch(word):
        return word
    if len(word) > LONGEST_NUMBER:
        raise ValueError(f"a number of more than {LONGEST_NUMBER} characters")
    if is_integer:
        return int(word.removeprefix("0o").removeprefix("0x"), base)
    return float(word) + 0.0  # no negative zero: it is the same setting and must give the same hash
