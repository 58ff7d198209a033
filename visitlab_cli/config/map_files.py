"""The maps of labs that lie in files of their own: read, relative to the YAML that names them."""

import os
from dataclasses import replace
from pathlib import Path

from visitlab_cli.config.labs import if_folded, is_map
from visitlab_cli.errors import ConfigError, NotFoundError
from visitlab_cli.wording import printable
from visitlab_cli.yaml.document import Node, Place
from visitlab_cli.yaml.files import read_bytes
from visitlab_cli.yaml.problems import Path as Keys
from visitlab_cli.yaml.problems import Problem

MOST_BYTES = 1 << 16
MOST_FILES = 256
SECTION, MAP = "labs", "map"
UNREAD = "\0"
"""In place of a map that can't be read, which is told: no YAML holds it, and it is no map."""


def with_maps(document: Node, problems: list[Problem]) -> Node:
    """The document with the text of each map in place of its file's name; what can't be read is a problem."""
    labs = document.entries().get(SECTION)
    if labs is None:
        return document
    entries = {name: _with_map(name, lab, problems) for name, lab in list(labs.entries().items())[:MOST_FILES]}
    return (
        document.with_entries({**document.value, SECTION: labs.with_entries({**labs.value, **entries})})
        if entries
        else document
    )


def unread_maps(document: Node) -> set[Keys]:
    """Where a map stands that could not be read, which was told: nothing more is said of it."""
    labs = document.value[SECTION].entries() if SECTION in document.value else {}
    maps = ((name, lab.entries().get(MAP)) for name, lab in labs.items())
    return {(SECTION, name, MAP) for name, found in maps if found is not None and found.value == UNREAD}


def _with_map(name: str, lab: Node, problems: list[Problem]) -> Node:
    given = lab.entries().get(MAP)
    if given is None or not isinstance(given.value, str) or is_map(given.value) or not given.value.strip():
        return lab
    return lab.with_entries({**lab.value, MAP: _read(name, given, problems)})


def _read(name: str, given: Node, problems: list[Problem]) -> Node:
    """The map's text, whose lines stand in its file; an override's file is found from the current folder."""
    folder = Path(given.place.source).parent if given.place.line else Path()
    file = folder / os.path.expanduser(given.value)
    try:
        content, _ = read_bytes(file, itself=False, most=MOST_BYTES)
        text = content.decode("utf-8-sig")
    except (NotFoundError, ConfigError, UnicodeDecodeError) as error:
        why = f"{printable(str(file))}: not UTF-8" if isinstance(error, UnicodeDecodeError) else str(error)
        if isinstance(error, NotFoundError):
            why += if_folded(given.value)
        problems.append(Problem(given.place, (SECTION, name, MAP), why))
        return replace(given, value=UNREAD)
    blank = len(text) - len(text.lstrip("\r\n"))
    return replace(given, value=text + "\n", text=Place(printable(str(file)), text[:blank].count("\n") + 1, 1))
