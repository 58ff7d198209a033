"""The cache of compiled code: an edited rule takes effect at once, and a damaged cache is made anew."""

import errno
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import visitlab_cli
from tests.program import TINY, copy_package, hashes, start, the_run, visitlab
from visitlab_cli import compiled, kernel_cache, sources
from visitlab_cli.compiled import KERNEL_SOURCES
from visitlab_cli.execution.warm_up import COMPILING
from visitlab_cli.storage.locks import lock

PACKAGE = Path(visitlab_cli.__file__).parent
NAMES_NUMBA = {"versions.py", "doctor.py", "stopping.py", "surroundings.py", "warm_up.py"}  # do not compile with it
PLAYER = Path(__file__).parents[1] / "world" / "package_log.py"

EDITS = [
    ("humans/six_parameters.py", "happens(random, human.p_M)", "False"),
    ("random_numbers.py", "random_unit(state) < probability", "random_unit(state) <= 0.5 * probability"),
]
NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf], steps: 1200}}"


def log_of(package, cache, first):
    """The log's bytes of the package in `package`, compiled into `cache`, with `first` imported before it."""
    out = cache.parent / "log.npz"
    program = (
        f"import {first}, runpy, sys\n"
        f"sys.argv = ['package_log.py', 'social', '2000', {str(out)!r}, '']\n"
        f"runpy.run_path({str(PLAYER)!r}, run_name='__main__')\n"
    )
    environment = os.environ | {"PYTHONPATH": str(package.parent), "VISITLAB_CACHE": str(cache), "NUMBA_OPT": "0"}
    subprocess.run([sys.executable, "-c", program], env=environment, cwd=package.parent, check=True)
    return out.read_bytes()


def compiled_files(cache):
    return sorted(file.name for file in cache.rglob("*.nbc"))


@pytest.mark.slow
def test_an_edited_kernel_file_changes_the_next_result(tmp_path):
    package, cache = tmp_path / "visitlab_cli", tmp_path / "cache"
    copy_package(package)
    first = log_of(package, cache, "numba")
    compiled = compiled_files(cache)
    assert first
    assert compiled
    assert log_of(package, cache, "json") == first
    assert compiled_files(cache) == compiled  # nothing was compiled again
    for file, old, new in EDITS:
        text = (package / file).read_text()
        assert text.count(old) == 1
        (package / file).write_text(text.replace(old, new))
        assert log_of(package, cache, "numba") != first, file
        (package / file).write_text(text)
    assert log_of(package, cache, "numba") == first


def flipped(data):
    middle = len(data) // 2
    return data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :]


@pytest.fixture(scope="module")
def filled(tmp_path_factory):
    """A cache that has what trains a navigation."""
    folder = tmp_path_factory.mktemp("filled")
    cache = {"VISITLAB_CACHE": str(folder / "cache")}
    assert visitlab("run", TINY, NAVIGATION, "--out", folder / "runs", "--workers", 1, env=cache).returncode == 0
    return folder / "cache"


@pytest.mark.parametrize("damage", [pytest.param(lambda data: data[: len(data) // 2], marks=pytest.mark.slow), flipped])
def test_a_damaged_cache_is_made_anew(filled, tmp_path, damage):
    config = ["run", TINY, "--out", tmp_path / "runs", "--workers", 1]
    cache = {"VISITLAB_CACHE": str(shutil.copytree(filled, tmp_path / "cache"))}
    assert "compiling" not in visitlab(*config, NAVIGATION, env=cache).stderr
    files = [*(tmp_path / "cache").rglob("*.nbi"), *(tmp_path / "cache").rglob("*.nbc")]
    assert files
    for file in files:
        file.write_bytes(damage(file.read_bytes()))
    done = visitlab(*config, NAVIGATION, "seed=4", env=cache)
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("compiling again") == 1
    again = visitlab(*config, NAVIGATION, "seed=5", env=cache)
    assert "compiling" not in again.stderr


def test_one_runner_compiles_and_others_wait_for_it(filled, tmp_path):
    cache = shutil.copytree(filled, tmp_path / "cache")
    markers = [*cache.rglob("compiled-*")]
    assert markers
    for marker in markers:
        marker.unlink()
    held = lock(markers[0].with_name(COMPILING))
    waiting = start("run", TINY, NAVIGATION, "--out", tmp_path, "--workers", 1, env={"VISITLAB_CACHE": str(cache)})
    told = [next(waiting.stderr)]
    while "waiting for it" not in told[-1]:
        told.append(next(waiting.stderr))
    for marker in markers:
        marker.touch()
    held.release(remove=True)
    _, rest = waiting.communicate(timeout=120)
    assert waiting.returncode == 0, rest
    assert "first run only" not in "".join(told) + rest
    assert not [*cache.rglob(COMPILING)]


def test_no_cache_folder_is_said_and_changes_nothing(tiny_run, tmp_path):
    (tmp_path / "file").touch()
    out = tmp_path / "runs"
    done = visitlab("train", TINY, NAVIGATION, "--out", out, env={"VISITLAB_CACHE": str(tmp_path / "file")})
    assert done.returncode == 0, done.stderr
    assert f"{tmp_path}/file" in done.stderr
    assert "; set VISITLAB_CACHE to a folder of your own" in done.stderr
    cell = "navigation/mf/seed-0000/model.npz"
    assert hashes(the_run(out))[cell] == hashes(tiny_run)[cell]


def test_every_file_with_kernels_is_in_the_hash():
    hashed = set(sources.files_of(KERNEL_SOURCES))
    for file in PACKAGE.rglob("*.py"):
        if file not in hashed:
            assert "numba" not in file.read_text().replace("NUMBA", "") or file.name in NAMES_NUMBA, file
            assert "import kernel" not in file.read_text(), file
    assert {PACKAGE / "compiled.py", PACKAGE / "world" / "human.py", PACKAGE / "simulation" / "loop.py"} <= hashed


def test_the_hash_is_of_every_byte_of_them(tmp_path, monkeypatch):
    package = tmp_path / "visitlab_cli"
    copy_package(package, "__pycache__")
    hashed = sources.files_of(KERNEL_SOURCES, package)
    monkeypatch.setattr(compiled, "files_of", lambda rooms: sources.files_of(rooms, package))
    monkeypatch.setattr(compiled, "digest_of", lambda files: sources.digest_of(files, package))
    seen = {compiled.sources_hash.__wrapped__()}
    assert seen == {compiled.sources_hash()}
    for file in hashed:
        text = file.read_text()
        file.write_text(text + "#")
        seen.add(compiled.sources_hash.__wrapped__())
        file.write_text(text)
    assert len(seen) == 1 + len(hashed)


def test_nothing_is_compiled_while_the_program_is_imported():
    program = (
        "import importlib, pkgutil, visitlab_cli\n"
        "for module in pkgutil.walk_packages(visitlab_cli.__path__, 'visitlab_cli.'):\n"
        "    if not module.name.endswith('__main__') and '.template' not in module.name:\n"
        "        importlib.import_module(module.name)\n"
        "from visitlab_cli.compiled import cache_place\n"
        "print(cache_place.cache_info().currsize)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "0\n"


def make_unsafe(kind, folder, monkeypatch):
    if kind == "of another user":
        monkeypatch.setattr(os, "geteuid", lambda: folder.stat().st_uid + 1)
    elif kind == "a link":
        folder.rename(folder.with_name("real"))
        folder.symlink_to("real")
    else:
        (folder if kind == "open to others" else folder.parent).chmod(0o777)


@pytest.mark.parametrize("kind", ["of another user", "a link", "open to others", "in a folder open to others"])
def test_code_is_only_run_from_a_folder_that_nobody_else_could_have_written_to(tmp_path, monkeypatch, kind):
    monkeypatch.setenv("VISITLAB_CACHE", str(tmp_path / "cache"))
    assert kernel_cache.place("kernels").folder == tmp_path / "cache" / "kernels"
    make_unsafe(kind, tmp_path / "cache" / "kernels", monkeypatch)
    found = kernel_cache.place("kernels")
    assert found.folder is None
    assert str(tmp_path) in found.why


def test_what_is_made_is_private_whatever_the_mask(tmp_path, monkeypatch):
    monkeypatch.setenv("VISITLAB_CACHE", str(tmp_path / "new" / "cache"))
    before = os.umask(0)
    try:
        folder = kernel_cache.place("kernels").folder
    finally:
        os.umask(before)
    assert [place.stat().st_mode & 0o077 for place in (folder, folder.parent, folder.parent.parent)] == [0, 0, 0]


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EDQUOT, errno.EMFILE, errno.EACCES])
def test_a_cache_that_fails_while_it_is_written_is_no_cache(tmp_path, number):
    program = (
        "import os\n"
        f"def refuse(*given): raise OSError({number}, os.strerror({number}))\n"
        "from numba.core.caching import IndexDataCacheFile\n"
        "IndexDataCacheFile._open_for_write = refuse\n"
        "from visitlab_cli.random_numbers import random_state, random_unit\n"
        "print(random_unit(random_state(0, 'a')))\n"
    )
    environment = os.environ | {"VISITLAB_CACHE": str(tmp_path / "cache")}
    done = subprocess.run([sys.executable, "-c", program], env=environment, check=False, capture_output=True)
    assert (done.returncode, done.stderr) == (0, b"")
    assert float(done.stdout) > 0
