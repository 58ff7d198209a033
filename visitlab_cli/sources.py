"""Which code made a result: a hash of the package's source files, the same on every machine.

A version says too little: a clone with an edited rule has the version of what it was cloned from.

Code of others may take part: a kind of agent in a package, or in a file of none. What decides is the whole package,
or that file, as it was when it was loaded.
"""

import hashlib
import re
import sys
from collections.abc import Iterable, Sequence
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parent
DECIDING = (
    "agents",
    "callbacks.py",
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


_others: dict[Path, str | None] = {}
"""What each package or file of others held when its code was first met; None where there is no file."""


def is_others(file: str) -> bool:
    """Whether the code of a file is not this package's; it is then noted as it is now."""
    path = Path(file)
    if PACKAGE in path.parents:
        return False
    _note(path)
    return True


def is_kind_of_others(kind: type) -> bool:
    """Whether a class is not this package's."""
    return is_others(_file_of(kind))


def _file_of(kind: type) -> str:
    return getattr(sys.modules[kind.__module__], "__file__", None) or ""


def others() -> str | None:
    """A hash of all code of others that was met; None where some of it has no file, so that nobody knows it again."""
    known = [digest for digest in _others.values() if digest is not None]
    return None if len(known) < len(_others) else hashlib.sha256(" ".join(sorted(known)).encode()).hexdigest()


def _note(path: Path) -> str | None:
    root = path
    while (root.parent / "__init__.py").is_file():
        root = root.parent
    if root not in _others:
        there = path.is_file()
        _others[root] = digest_of(files_of([root.name], root.parent), root.parent).hexdigest() if there else None
    return _others[root]


@cache
def _own() -> str:
    return digest_of(files_of(DECIDING)).hexdigest()


def sources(kinds: Iterable[type] = ()) -> str:
    """16 hex digits for all that decides a result; the last four are a check on the others (`is_sources`).

    Args:
        kinds: the classes of what a config declares, of which some may be others'.
    """
    files = {_file_of(kind) for kind in kinds}
    theirs = sorted({_note(Path(file)) or "" for file in files if is_others(file)})
    whole = hashlib.sha256(" ".join([_own(), *theirs]).encode()).hexdigest() if theirs else _own()
    return _checked(whole[: DIGITS - CHECK_DIGITS])


def is_sources(text: object) -> bool:
    """Whether `sources` may have said so, somewhere: a damaged digit is seen."""
    whole = isinstance(text, str) and _FORM.fullmatch(text) is not None
    return whole and text == _checked(str(text)[:-CHECK_DIGITS])


def _checked(digits: str) -> str:
    return digits + hashlib.sha256(digits.encode()).hexdigest()[:CHECK_DIGITS]
