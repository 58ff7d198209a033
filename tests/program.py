"""Running the real program, as a user would, and comparing what it left."""

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

from tests.forked import can_fork, run_forked
from visitlab_cli.sources import PACKAGE

TINY = Path(__file__).with_name("tiny.yaml")
NO_FORKS = "VISITLAB_TESTS_WITHOUT_FORKS"
"""Set, every call is a process of its own."""
COMMAND = [sys.executable, "-m", "visitlab_cli"]


def copy_package(target, *others):
    """A copy of the package, without files that another process is just compiling, nor those called as `others`."""
    return shutil.copytree(PACKAGE, target, ignore=shutil.ignore_patterns("*.pyc.*", *others))


def visitlab(*arguments, cwd=None, env=None, **options):
    """Run the program to its end; the result has `returncode`, `stdout` and `stderr` as text.

    It has made its imports already, if the call is the same then; see `tests.forked`.
    """
    words = [*map(str, arguments)]
    environment = os.environ | {"NO_COLOR": "1", "COLUMNS": "200"} | (env or {})
    if not options and not os.environ.get(NO_FORKS) and can_fork(environment):
        return run_forked(words, cwd, environment)
    return new_process(*arguments, cwd=cwd, env=env, **options)


def new_process(*arguments, cwd=None, env=None, **options):
    """As `visitlab`, and always a process of its own, as a user's is."""
    environment = os.environ | {"NO_COLOR": "1", "COLUMNS": "200"} | (env or {})
    command = [*COMMAND, *map(str, arguments)]
    return subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, check=False, timeout=1800, **options
    )


def start(*arguments, cwd=None, env=None):
    """Start the program and return it while it runs."""
    return subprocess.Popen(
        [*COMMAND, *map(str, arguments)],
        cwd=cwd,
        env=os.environ | {"NO_COLOR": "1"} | (env or {}),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


class Clone:
    """A copy of the program with files added: it runs in `folder`, uncompiled unless told otherwise."""

    def __init__(self, folder, files):
        self.folder, self.package = folder, folder / "clone" / "visitlab_cli"
        copy_package(self.package)  # with what Python has compiled, which is as old as the copies are
        self.surroundings = {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(self.package.parent)}
        for path, text in files.items():
            (self.package / path).write_text(text)

    def __call__(self, *arguments, **environment):
        """Run it to its end, as `visitlab`."""
        return new_process(*arguments, cwd=self.folder, env=self.surroundings | environment)

    def python(self, code):
        """What a script says that imports it."""
        command, environment = [sys.executable, "-c", code], os.environ | self.surroundings
        done = subprocess.run(command, cwd=self.folder, env=environment, capture_output=True, text=True, check=True)
        return done.stdout.strip()


def the_run(out):
    """The only run folder below `out`."""
    (run,) = (folder for folder in Path(out).iterdir() if not folder.name.startswith("."))
    return run


def hashes(run, below=""):
    """The sha256 of every file of a run by its path, of those that hold results."""
    return {
        file.relative_to(run).as_posix(): hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted((run / below).rglob("*"))
        if file.is_file() and file.name != "timing.json"
    }


def only_cells(found):
    """Those of `hashes` that belong to cells."""
    return {path: digest for path, digest in found.items() if "seed-" in path}
