"""The hash of the sources covers all that a result passes through, and says the same everywhere."""

import subprocess
import sys

import pytest

from tests.program import copy_package
from visitlab_cli import sources

DECIDES_NOTHING = {
    "__init__.py",
    "errors.py",
    "kernel_cache.py",
    "sources.py",
    "stopping.py",
    "terminal.py",
    "origin.py",
    "plugins.py",
    "whole_file.py",
    "wording.py",
}
WAY = "visitlab_cli.config.loading", "visitlab_cli.execution.warm_up", "visitlab_cli.execution.cell_runner"


@pytest.fixture
def package(tmp_path):
    copy = tmp_path / "other" / "visitlab_cli"
    copy_package(copy, "__pycache__")
    return copy


def digest(package):
    return sources.digest_of(sources.files_of(sources.DECIDING, package), package).hexdigest()


def test_every_module_from_yaml_to_a_finished_cell_is_in_it():
    code = (
        f"import sys, {', '.join(WAY)}; print(*(m.__file__ for n, m in sys.modules.items() if n.startswith('visit')))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    hashed = {str(file) for file in sources.files_of(sources.DECIDING)}
    assert {file for file in done.stdout.split() if file not in hashed} == {
        str(sources.PACKAGE / name) for name in DECIDES_NOTHING
    }


def test_it_is_the_same_wherever_the_package_lies_and_whatever_lies_beside_its_modules(package):
    assert digest(package) == digest(sources.PACKAGE)
    for name in (".#loop.py", "loop (copy).py", "loop.py~", "#loop.py#"):
        (package / "simulation" / name).write_text("an editor's")
    for file in package.rglob("*.py"):
        file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
    assert digest(package) == digest(sources.PACKAGE)


def test_any_edit_another_name_or_a_new_module_is_seen(package):
    seen = {digest(package)}
    file = package / "world" / "visit.py"
    file.write_text(file.read_text() + "#")
    seen.add(digest(package))
    file.rename(file.with_name("visits.py"))
    seen.add(digest(package))
    (package / "agents" / "mine.py").touch()
    seen.add(digest(package))
    assert len(seen) == 4


def test_a_damaged_digit_is_seen():
    right = sources.sources()
    assert sources.is_sources(right)
    wrong = [right[:place] + ("0" if right[place] != "0" else "1") + right[place + 1 :] for place in range(len(right))]
    assert not any(map(sources.is_sources, [*wrong, right[:-1], right.upper() + "0", "", None, 7]))
