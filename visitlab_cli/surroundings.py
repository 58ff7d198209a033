"""What the user's surroundings may say to the libraries below us: nothing, so that all is the same everywhere.

A notebook's, a cluster's or a colleague's variables are meant for other programs. One table says which never reach
in; nor do settings in the current folder, where matplotlib and numba look first.
"""

import contextlib
import importlib.util
import locale
import logging
import os
import re
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

from visitlab_cli.errors import UsageError

IGNORED = (
    "ARROW_",
    "LLVMLITE_",
    "MATPLOTLIB",
    "MPL",
    "NPY_",
    "NUMBA_",
    "OPENBLAS_CORETYPE",
    "PROTOCOL_BUFFERS_",
    "PYDANTIC_",
    "PYTHONWARNINGS",
    "RERUN",
    "RUST_",
    "SOURCE_DATE_EPOCH",
    "TERMINAL_WIDTH",
    "TYPER_",
    "_MPL",
    "_RERUN",
    "_TYPER_FORCE",
    "_TYPER_STANDARD",
)
"""How the names of variables begin that reach nothing below us."""
KEPT = {"NUMBA_DISABLE_JIT": "0|1", "MPLCONFIGDIR": ".*"}
"""What stays of these, and what it must look like: how to debug, and where a list of fonts may be kept."""
ONLY_IF = {"COLUMNS": "[1-9][0-9]{1,3}", "LINES": "[1-9][0-9]{0,3}"}
"""Variables that are ignored unless they look so: a terminal of at least 10 columns."""
TEMPORARY = ("TMPDIR", "TEMP", "TMP")
NUMBA_SETTINGS = Path(".numba_config.yaml")
LONGEST_TEMPORARY = 60  # bytes: the name of a socket has at most 104 on macOS, 108 on Linux, and we add up to 40


def shut_out() -> None:
    """Take out of this process's environment what must not reach in; what it starts inherits that.

    Raises:
        UsageError: a variable that is heeded has no meaning, or numba would find settings in the current folder.
    """
    shut_out_variables()
    for name, form in ONLY_IF.items():
        if name in os.environ and not re.fullmatch(form, os.environ[name]):
            del os.environ[name]
    for name, form in KEPT.items():
        if name in os.environ and not re.fullmatch(form, os.environ[name]):
            words = form.replace("|", " or ")
            raise UsageError(f"the variable {name}={os.environ[name]}: must be {words}; unset {name}")
    if sys.flags.optimize > 1:
        raise UsageError("PYTHONOPTIMIZE=2 and python -OO take away the words of every --help; unset it, or say 1")
    if NUMBA_SETTINGS.exists():
        raise UsageError(f"{NUMBA_SETTINGS} in this folder would reach into the compiler; remove it, or go elsewhere")
    for name in TEMPORARY:
        folder = os.environ.get(name, "")
        if not os.path.isabs(folder) or len(os.fsencode(folder)) > LONGEST_TEMPORARY:
            os.environ.pop(name, None)
    if not _speaks():  # what we start would complain
        for name in [name for name in os.environ if name.startswith(("LANG", "LC_"))]:
            del os.environ[name]
    sys.warnoptions.clear()  # which workers would inherit
    warnings.simplefilter("ignore")  # what concerns the user we say ourselves
    logging.disable(logging.CRITICAL)


def shut_out_variables() -> None:
    """That part of it which decides how the libraries below us work, for a process that is not ours alone."""
    for name, value in list(os.environ.items()):
        if name.startswith(IGNORED) and (name not in KEPT or not value):
            del os.environ[name]


def _speaks() -> bool:
    """Whether the user's language is installed; ours stays as it is."""
    before = locale.setlocale(locale.LC_ALL)
    try:
        locale.setlocale(locale.LC_ALL, "")
    except locale.Error:
        return False
    locale.setlocale(locale.LC_ALL, before)
    return True


@contextlib.contextmanager
def within_package(package: str, inside: str = ".") -> Iterator[None]:
    """To import a package in: the current folder is one of its own, so that it finds no settings of the user's."""
    found = importlib.util.find_spec(package)
    if found is None or found.origin is None or package in sys.modules:
        yield
        return
    try:
        here = os.open(".", os.O_RDONLY)
    except OSError:  # it is gone, or we may not look
        here = -1
    os.chdir(Path(found.origin).parent / inside)
    try:
        yield
    finally:
        if here >= 0:
            os.fchdir(here)
            os.close(here)
