"""A package to begin with: an agent in plain Python that works when installed, its test and a config."""

import builtins
import keyword
import re
import sys
from importlib.util import find_spec
from pathlib import Path

from visitlab_cli.agents.registry import KINDS
from visitlab_cli.errors import RunError, UsageError, reason
from visitlab_cli.wording import printable

TEMPLATE = Path(__file__).parent / "template"
CODE = ".txt"
"""How the name of a template ends that is code: it is none of ours."""


def new_package(name: str, folder: Path) -> list[Path]:
    """Write the package of an agent of the kind `name` into `folder`/`name`; the files, in their order.

    Raises:
        UsageError: the name can't be a kind's and a module's, or the folder is there.
        RunError: it can't be written.
    """
    if not re.fullmatch(r"[a-z][a-z0-9_]{1,40}", name) or keyword.iskeyword(name):
        raise UsageError(f"{printable(name)}: must be a name for a kind and a module: a-z, 0-9, _, as in my_agent")
    if name in KINDS:
        raise UsageError(f"{name}: is a kind of visitlab's own; choose another name")
    target = folder / name
    if target.exists():
        raise UsageError(f"{target}: exists; choose another name or --folder")
    if _is_taken(name):
        raise UsageError(f"{name}: Python has a module or a function of this name; choose another")
    written = []
    try:
        for file in sorted(path for path in TEMPLATE.rglob("*") if path.is_file()):
            place = target / _named(file.relative_to(TEMPLATE).as_posix().removesuffix(CODE), name)
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(_named(file.read_text(encoding="utf-8"), name), encoding="utf-8")
            written.append(place)
    except OSError as error:
        raise RunError(f"{target}: can't be written: {reason(error)}") from error
    return written


def _is_taken(name: str) -> bool:
    """Whether a module of this name would hide another, or a function of Python's, or be hidden."""
    beside = (TEMPLATE / name).exists()  # a folder of the package that is no module
    return beside or name in {*dir(builtins), *sys.stdlib_module_names} or find_spec(name) is not None


def _named(text: str, name: str) -> str:
    return text.replace("DISTRIBUTION", f"visitlab-{name.replace('_', '-')}").replace("NAME", name)
