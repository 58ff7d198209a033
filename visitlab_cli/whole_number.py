"""What Python's callers give for a whole number: an int, or what numpy has for one, but no truth, text or fraction."""

from operator import index
from typing import Any


def whole_number(given: Any) -> int | None:
    """The number as an int; None for what is no whole number."""
    if isinstance(given, bool):
        return None
    try:
        return index(given)
    except TypeError:
        return None
