"""The bytes of a YAML file, bounded in size and time, and the mapping in them."""

import errno
import io
import os
import select
import stat
import time
from pathlib import Path

from visitlab_cli.errors import ConfigError, NotFoundError, VisitlabError, reason
from visitlab_cli.wording import printable
from visitlab_cli.yaml.document import Node, Place
from visitlab_cli.yaml.problems import Problem, failure
from visitlab_cli.yaml.reader import read_yaml

MOST_BYTES = 1 << 20
"""Of a config with all that it includes."""
PATIENCE = 10
"""Seconds that a pipe has."""


class UnreadableError(ConfigError):
    """A config is there and can't be read."""


def read_bytes(path: Path, *, itself: bool = True, most: int = MOST_BYTES) -> tuple[bytes, tuple[int, int]]:
    """The content of a file, and its device and number, which are the same by whatever name it is found.

    Args:
        path: where it lies.
        itself: whether the user named it, so that it may also be a pipe, as of `<(...)`; nobody waits long for one.
        most: bytes that it may have.

    Raises:
        NotFoundError: it is not there.
        UnreadableError: it is not a file, or cannot be read.
        ConfigError: it is too large.
    """
    shown = printable(str(path))
    try:
        number = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))  # else a pipe without a writer blocks
        with open(number, "rb", buffering=0) as file:
            state = os.fstat(number)
            if not (stat.S_ISREG(state.st_mode) or stat.S_ISDIR(state.st_mode) or itself):
                raise UnreadableError(f"{shown}: a pipe or a device, not a file")
            content = _read(file, most + 1)
    except (OSError, ValueError) as error:
        raise unread(shown, error) from None
    if len(content) > most:
        together = "" if most == MOST_BYTES else "with what includes it "
        raise failure([Problem(Place(shown), (), f"{together}larger than {MOST_BYTES >> 20} MiB; no config is")])
    return content, (state.st_dev, state.st_ino)


def unread(shown: str, error: OSError | ValueError) -> VisitlabError:
    """Why there is no content; a name that can be none (too long, with a NUL) is not there either."""
    words = reason(error)
    nowhere = getattr(error, "errno", None) in (None, errno.ENOENT, errno.ENOTDIR, errno.ENAMETOOLONG)
    return (NotFoundError if nowhere else UnreadableError)(f"{shown}: {words[:1].lower()}{words[1:]}")


def _read(file: io.FileIO, most: int) -> bytes:
    content = b""
    end = time.monotonic() + PATIENCE
    while len(content) < most:
        if not select.select([file], [], [], max(end - time.monotonic(), 0))[0]:
            raise OSError(errno.ETIMEDOUT, f"nothing more came within {PATIENCE} seconds")
        part = file.read(most - len(content))
        if part == b"":
            break
        content += part or b""
    return content


def read_file(path: Path) -> tuple[Node, list[Problem]]:
    """The mapping in a file, which the user named, and what was wrong with its keys.

    Raises:
        NotFoundError, ConfigError: as `read_bytes` and `read_content`.
    """
    return read_content(read_bytes(path)[0], path)


def read_content(content: bytes, path: Path) -> tuple[Node, list[Problem]]:
    """The mapping in a YAML file, and what was wrong with its keys.

    Raises:
        ConfigError: it is not UTF-8, not YAML or not a mapping.
    """
    shown = printable(str(path))
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        column = error.start - content.rfind(b"\n", 0, error.start)
        raise failure([Problem(Place(shown, line, column), (), "not UTF-8")]) from None
    node, problems = read_yaml(text, shown)
    if node is None:
        message = "empty; `visitlab init` writes a config to start from"
        raise failure([Problem(Place(shown, 1, 1), (), message)])
    if not isinstance(node.value, dict):
        kind = "a list" if isinstance(node.value, list) else "one value"
        raise failure([*problems, Problem(node.place, (), f"must be a mapping (got {kind})")])
    return node, problems
