"""The maps of labs that lie in files of their own: read, relative to the YAML that names them."""

import os
from dataclasses import replace
from pathlib import Path

from visitlab_cli.config.labs import is_map
from visitlab_cli.errors import ConfigError, NotFoundError
from visitlab_cli.wording import printable
from visitlab_cli.yaml.document import Node, Place
from visitlab_cli.yaml.files import read_bytes
from visitlab_cli.yaml.problems import Problem

MOST_BYTES = 1 << 16
MOST_FILES = 256
SECTION, MAP = "labs", "map"
SOUND = "ab"
"""A map without fault, in place of one that can't be read, which is told."""


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


def _with_map(name: str, lab: Node, problems: list[Problem]) -> Node:
    given = lab.entries().get(MAP)
    if given is None or not isinstance(given.value, str) or is_map(given.value):
        return lab
    return lab.with_entries({**lab.value, MAP: _read(name, given, problems)})


def _read(name: str, given: Node, problems: list[Problem]) -> Node:
    """The map's text, whose lines stand in its file."""
    folder = Path(given.place.source).parent if given.place.line else Path()
    file = folder / os.path.expanduser(given.value)
    try:
        content, _ = read_bytes(file, itself=False, most=MOST_BYTES)
        text = content.decode("utf-8-sig")
    except (NotFoundError, ConfigError, UnicodeDecodeError) as error:
        why = f"{printable(str(file))}: not UTF-8" if isinstance(error, UnicodeDecodeError) else str(error)
        problems.append(Problem(given.place, (SECTION, name, MAP), why))
        return replace(given, value=SOUND)
    blank = len(text) - len(text.lstrip("\r\n"))
    return replace(given, value=text + "\n", text=Place(printable(str(file)), text[:blank].count("\n") + 1, 1))
