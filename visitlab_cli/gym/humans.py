"""Whom an environment's robot meets: a shipped human by name, parameters as a config has them, or a record."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from visitlab_cli.config.files import shipped_folder
from visitlab_cli.errors import UsageError
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.wording import or_else
from visitlab_cli.yaml.files import read_content

HUMAN_2 = "human_2"
"""Whom the paper's visit is trained with."""
SHIPPED = "humans/paper.yaml"

Entry = Mapping[str, Any]
"""Parameters as a config has them: `like` may name a shipped human, `kind` one of others."""


def entry_and_record(given: Any) -> tuple[Entry, Any]:
    """A human as a config's entry, or, where it is one already, its record, which then counts; else that is None.

    Args:
        given: an entry, `HumanParameters`, or a record.

    Raises:
        UsageError: it is none of these, or nobody is called so.
    """
    if isinstance(given, HumanParameters):
        return like(HUMAN_2), given.create()
    if isinstance(given, tuple) and hasattr(given, "_fields"):
        return like(HUMAN_2), given
    if isinstance(given, str) and given not in shipped_humans():
        raise UsageError(f"human={given!r}: no shipped human is called so{or_else(given, list(shipped_humans()))}")
    if isinstance(given, str | Mapping):
        return (like(given) if isinstance(given, str) else given), None
    raise UsageError(f"human={given!r}: must be a name, parameters or a record")


def like(name: str) -> Entry:
    """The entry of who is as a shipped human."""
    return {"like": name}


@cache
def shipped_humans() -> dict[str, Any]:
    """The entries of the shipped humans, plain, by their names."""
    file = shipped_folder() / SHIPPED
    document, _ = read_content(file.read_bytes(), file)
    return {name: entry.plain() for name, entry in document.entries()["humans"].entries().items()}
