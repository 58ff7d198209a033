r"""The one way to a terminal: no text of a file can command it, and nobody who stopped listening stops a run.

Names of files, other people's logs and configs end up in what is printed. Whatever is no visible character or space
is therefore written as Python writes it in a string (`\x1b`), and a line break too where one line is printed.
"""

import contextlib
import io
import json
import os
import re
import sys
import traceback
from collections.abc import Iterable, Iterator
from typing import Any, NoReturn

from visitlab_cli.errors import RunError, reason

BLANK_LETTERS = "\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\ufe00-\ufe0f\uffa0\U000e0000-\U000e0fff"
"""Characters that Unicode counts among letters, marks and signs and nobody can see."""
_SUSPICIOUS = re.compile(f"[^\\x20-\\x7e\u00a1-\u00ac\u00ae-\u024f]|[{BLANK_LETTERS}]")
_BLANK = re.compile(f"[{BLANK_LETTERS}]")
SPACES = "\u00a0\u1680\u2000-\u200a\u202f\u205f\u3000"
_SPACE = re.compile(f"[{SPACES}]")


def plain(text: str) -> str:
    """One line that says a text: what a terminal would obey, what nobody sees and what turns text round, escaped."""
    return _SUSPICIOUS.sub(lambda found: _escaped(found[0]), text)


def plain_text(text: str) -> str:
    """As `plain`, of several lines that are such in our own words."""
    return "\n".join(map(plain, text.split("\n")))


def _escaped(character: str) -> str:
    visible = (character.isprintable() and not _BLANK.match(character)) or _SPACE.match(character)
    return character if visible else ascii(character)[1:-1]


def tell(*lines: str, err: bool = False, end: str = "\n") -> None:
    """Print lines, each one whatever is in it: a result, or with `err` what is told on the way, and may fail unheard.

    Raises:
        RunError: a result can't be written.
        BrokenPipeError: its reader left.
    """
    _write("\n".join(map(plain, lines)) + end, err)


def tell_all(notes: Iterable[str | None]) -> None:
    """Tell on the way what there is of some notes, a line each."""
    for note in filter(None, notes):
        tell(note, err=True)


def tell_text(text: str, *, err: bool = False) -> None:
    """Print several lines, as `tell`; what comes from files and could break a line has been through `plain`."""
    _write(plain_text(text) + "\n", err)


def tell_json(value: Any, indent: int | None = 2) -> None:
    """Print plain values as JSON, which itself escapes everything but the last character of ASCII."""
    _write(json.dumps(value, indent=indent).replace("\x7f", "\\u007f") + "\n", err=False)


def _write(text: str, err: bool) -> None:
    try:
        print(text, end="", file=sys.stderr if err else sys.stdout, flush=True)
    except BrokenPipeError:
        if not err:
            raise
    except OSError as error:
        if not err:
            lead_nowhere()
            raise RunError(f"the output can't be written: {reason(error)}") from error


class _Unheard(io.RawIOBase):
    """Standard error's file, to which writing never fails."""

    def fileno(self) -> int:
        return 2

    def isatty(self) -> bool:
        return os.isatty(2)

    def writable(self) -> bool:
        return True

    def write(self, content: Any) -> int:
        with contextlib.suppress(OSError):
            return os.write(2, content)
        return len(content)


def open_streams() -> None:
    """Make the standard streams fit for everything: closed ones lead nowhere, and what an encoding lacks is escaped.

    A closed one would give its number to the next file that is opened, and what is printed would end up in there.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free, which is this one
    for name, number in (("stdin", 0), ("stdout", 1)):
        if getattr(sys, name) is None:
            setattr(sys, name, open(number, "w" if number else "r", encoding="utf-8", closefd=False))  # noqa: SIM115
    encoding = getattr(sys.stderr, "encoding", None) or "utf-8"
    sys.stderr = io.TextIOWrapper(_Unheard(), encoding, errors="backslashreplace", write_through=True)
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    sys.excepthook = _tell_bug


def _tell_bug(*error: Any) -> None:
    tell_text("".join(traceback.format_exception(*error)).rstrip("\n"), err=True)


@contextlib.contextmanager
def to_stderr() -> Iterator[None]:
    """What others' code prints in the block is no result: it goes to standard error."""
    sys.stdout.flush()
    kept = os.dup(1)
    try:
        os.dup2(2, 1)  # for what does not print as Python does
        with contextlib.redirect_stdout(sys.stderr):
            yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def lead_nowhere() -> None:
    """What is still to be written to standard output goes nowhere: nobody can read it."""
    with contextlib.suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def end(exit_code: int, *lines: str) -> NoReturn:
    """End the program with an exit code, and say why."""
    tell(*lines, err=True)
    sys.exit(exit_code)
