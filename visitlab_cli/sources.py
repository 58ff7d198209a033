"""Which code made a result: a hash of the package's source files, the same on every machine.

A version says too little: a clone with an edited rule has the version of what it was cloned from.
"""

import hashlib
import re
from collections.abc import Sequence
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parent
DECIDING = (
    "agents",
    "compiled.py",
    "config",
    "execution",
    "humans",
    "kinds.py",
    "log",
    "plan",
    "random_numbers.py",
    "settings.py",
    "simulation",
    "storage",
    "world",
    "yaml",
)
"""The rooms on the way from YAML to a finished cell, whole; pages, pictures and commands decide no result."""
DIGITS, CHECK_DIGITS = 16, 4
_FORM = re.compile(rf"[0-9a-f]{{{DIGITS}}}")


def files_of(rooms: Sequence[str], package: Path = PACKAGE) -> list[Path]:
    """The modules of some rooms, sorted by their paths; what an editor left beside them is none."""
    places = [package / room for room in rooms]
    found = [file for place in places for file in (place.rglob("*.py") if place.is_dir() else [place])]
    modules = [file for file in found if file.stem.isidentifier() and file.is_file()]
    return sorted(modules, key=lambda file: file.relative_to(package).as_posix())


def digest_of(files: Sequence[Path], package: Path = PACKAGE) -> "hashlib._Hash":
    """The sha256, which more may be added to, of the paths below `package` and the bytes of files.

    Line ends count as Python counts them: what git changed on its way to a machine is the same code.
    """
    digest = hashlib.sha256()
    for file in files:
        content = file.read_bytes().replace(b"\r\n", b"\n")
        digest.update(f"{file.relative_to(package).as_posix()}\0{len(content)}\0".encode() + content)
    return digest


@cache
def sources() -> str:
    """16 hex digits for all that decides a result; the last four are a check on the others (`is_sources`)."""
    return _checked(digest_of(files_of(DECIDING)).hexdigest()[: DIGITS - CHECK_DIGITS])


def is_sources(text: object) -> bool:
    """Whether `sources` may have said so, somewhere: a damaged digit is seen."""
    whole = isinstance(text, str) and _FORM.fullmatch(text) is not None
    return whole and text == _checked(str(text)[:-CHECK_DIGITS])


def _checked(digits: str) -> str:
    return digits + hashlib.sha256(digits.encode()).hexdigest()[:CHECK_DIGITS]
