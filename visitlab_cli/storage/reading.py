"""The door through which every file of a run's folder is read: a regular file, no link, bounded in size and depth.

Whoever sent us a run chose its bytes, and the hashes in it: nothing here believes either. What is wrong is told as an
`OSError` with a reason, where there is nothing to read, or as a `ValueError` of one line. What is there and can't be
read *now*, such as a file without the right to read it, is an `UnreadableError`: that is no damage, and nobody may take
it for some.
"""

import errno
import io
import json
import math
import os
import stat
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from visitlab_cli.errors import RunError, reason
from visitlab_cli.wording import printable

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

MOST_JSON = 1 << 20
"""Bytes of a JSON file; ours have fewer than 4,000."""
DEEPEST = 16
LARGEST_NUMBER = 2**63
MOST_DIGITS = 20
MOST_TABLE = 1 << 30
"""Bytes of a file of arrays."""
NOT_NOW = frozenset({errno.EACCES, errno.EPERM, errno.EIO, errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.ESTALE})
"""What the system answers where something may well be there and whole."""


class UnreadableError(RunError):
    """Something that is there can't be read: which says nothing of what it holds."""


def check_damage(path: Path, error: OSError) -> None:
    """Return where an error means that what should lie at `path` is missing or something else.

    Raises:
        UnreadableError: it means that nobody can tell.
    """
    if error.errno in NOT_NOW:
        raise UnreadableError(f"{printable(str(path))}: can't be read: {reason(error)}") from error


class _Content(io.FileIO):
    """An open file; a disk that fails meanwhile is none of its content's faults."""

    path: Path

    def readinto(self, buffer: "WriteableBuffer", /) -> int | None:
        try:
            return super().readinto(buffer)
        except OSError as error:
            check_damage(self.path, error)
            raise


def open_file(file: Path) -> io.BufferedReader:
    """A regular file, opened for reading without following a link or waiting for a pipe.

    Raises:
        OSError: it is not there, or is something else.
        UnreadableError: it is there, and can't be read.
    """
    flags = os.O_RDONLY
    for name in ("O_NOFOLLOW", "O_NONBLOCK", "O_CLOEXEC", "O_BINARY"):
        flags |= getattr(os, name, 0)
    try:
        descriptor = os.open(file, flags)
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise _other(file, errno.ELOOP, "a link, and nothing in a run is read through one") from None
        if error.errno in (errno.ENXIO, errno.ENODEV, errno.EOPNOTSUPP):
            raise _other(file, error.errno, "a pipe, a socket or a device, not a file") from None
        check_damage(file, error)
        raise
    mode = os.fstat(descriptor).st_mode
    if not stat.S_ISREG(mode):
        os.close(descriptor)
        if stat.S_ISDIR(mode):
            raise _other(file, errno.EISDIR, "a folder, not a file")
        raise _other(file, errno.EINVAL, "a pipe, a socket or a device, not a file")
    raw = _Content(descriptor, "rb")
    raw.path = file
    return io.BufferedReader(raw)


def _other(file: Path, number: int, words: str) -> OSError:
    return OSError(number, words, str(file))


def is_file(file: Path) -> bool:
    """Whether there is a regular file; a link is none."""
    try:
        return stat.S_ISREG(os.lstat(file).st_mode)
    except (OSError, ValueError):
        return False


def size_of(file: Path) -> int:
    """The bytes of a regular file.

    Raises:
        OSError, UnreadableError: as `open_file`.
    """
    try:
        state = os.lstat(file)
    except OSError as error:
        check_damage(file, error)
        raise
    if not stat.S_ISREG(state.st_mode):
        raise _other(file, errno.EINVAL, "not a file")
    return state.st_size


def read_bytes(file: Path, most: int = MOST_TABLE) -> bytes:
    """All of a file.

    Raises:
        OSError, UnreadableError: as `open_file`.
        ValueError: it has more than `most` bytes.
    """
    with open_file(file) as stream:
        size = os.fstat(stream.fileno()).st_size
        content = b"" if size > most else stream.read(most + 1)
    if max(size, len(content)) > most:  # it may have grown
        raise ValueError(f"has more than {most:,} bytes")
    return content


def read_text(file: Path, most: int = MOST_JSON) -> str:
    """All of a file of UTF-8.

    Raises:
        OSError, ValueError: as `read_bytes`, or it is not UTF-8.
    """
    return read_bytes(file, most).decode("utf-8")


def read_json(file: Path) -> Any:
    """The document in a JSON file, as `parse_json`."""
    return parse_json(read_text(file))


def parse_json(text: str) -> Any:
    """A JSON document that can be written as one again and shown.

    Raises:
        ValueError: it is none, or has a key twice, half of a character, a number that is not finite or over 2**63,
            or brackets more than `DEEPEST` deep.
    """
    try:
        document = json.loads(
            text, object_pairs_hook=_mapping, parse_constant=_no_number, parse_float=_float, parse_int=_int
        )
    except RecursionError:
        raise ValueError(f"nested more than {DEEPEST} deep") from None
    _check(document, DEEPEST)
    return document


def _mapping(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        raise ValueError("says something twice")
    return found


def _no_number(word: str) -> NoReturn:
    raise ValueError(f"holds {word}, which is no number")


def _float(digits: str) -> float:
    number = float(digits)
    if not math.isfinite(number):
        raise ValueError("holds a number that is too large")
    return number


def _int(digits: str) -> int:
    if len(digits) > MOST_DIGITS or not -LARGEST_NUMBER <= (number := int(digits)) < LARGEST_NUMBER:
        raise ValueError("holds a number that is too large")
    return number


def _check(document: Any, deep: int) -> None:
    if isinstance(document, str):
        document.encode("utf-8")  # half of a character can't be
    elif isinstance(document, dict | list):
        if not deep:
            raise ValueError(f"nested more than {DEEPEST} deep")
        for value in [*document, *document.values()] if isinstance(document, dict) else document:
            _check(value, deep - 1)
