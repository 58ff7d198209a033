"""The cache of compiled code: an edited rule takes effect at once, and a damaged cache is made anew."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import visitlab_cli
from tests.program import TINY, hashes, the_run, visitlab
from visitlab_cli import compiled, sources
from visitlab_cli.compiled import KERNEL_SOURCES

PACKAGE = Path(visitlab_cli.__file__).parent
NAMES_NUMBA = {"versions.py", "doctor.py", "stopping.py"}  # ask for its version, or whether it is compiling
PLAYER = Path(__file__).parents[1] / "world" / "package_log.py"

EDITS = [
    ("world/human.py", "happens(random, human.p_M)", "False"),
    ("random_numbers.py", "random_unit(state) < probability", "random_unit(state) <= 0.5 * probability"),
]
NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf], steps: 1200}}"


def log_of(package, cache, first):
    """The log's bytes of the package in `package`, compiled into `cache`, with `first` imported before it."""
    out = cache.parent / "log.npz"
    program = (
        f"import {first}, runpy, sys\n"
        f"sys.argv = ['package_log.py', 'social', '2000', {str(out)!r}]\n"
        f"runpy.run_path({str(PLAYER)!r}, run_name='__main__')\n"
    )
    environment = os.environ | {"PYTHONPATH": str(package.parent), "VISITLAB_CACHE": str(cache)}
    out.unlink(missing_ok=True)
    command = [sys.executable, "-c", program]
    subprocess.run(command, env=environment, cwd=package.parent, check=False, capture_output=True)
    return out.read_bytes() if out.exists() else b""


def compiled_files(cache):
    return sorted(file.name for file in cache.rglob("*.nbc"))


def test_an_edited_kernel_file_changes_the_next_result(tmp_path):
    package, cache = tmp_path / "visitlab_cli", tmp_path / "cache"
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
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


@pytest.mark.parametrize("damage", [lambda data: data[: len(data) // 2], lambda data: b"x" * len(data)])
def test_a_damaged_cache_is_made_anew(tmp_path, damage):
    config = ["run", TINY, "--out", tmp_path / "runs", "--workers", 1]
    cache = {"VISITLAB_CACHE": str(tmp_path / "cache")}
    assert visitlab(*config, NAVIGATION, env=cache).returncode == 0
    files = [*(tmp_path / "cache").rglob("*.nbi"), *(tmp_path / "cache").rglob("*.nbc")]
    assert files
    for file in files:
        file.write_bytes(damage(file.read_bytes()))
    done = visitlab(*config, NAVIGATION, "seed=4", env=cache)
    assert done.returncode == 0, done.stderr
    assert "compiling again" in done.stderr
    again = visitlab(*config, NAVIGATION, "seed=5", env=cache)
    assert "compiling" not in again.stderr


def test_no_cache_folder_is_said_and_changes_nothing(tiny_run, tmp_path):
    (tmp_path / "file").touch()
    out = tmp_path / "runs"
    done = visitlab("train", TINY, NAVIGATION, "--out", out, env={"VISITLAB_CACHE": str(tmp_path / "file")})
    assert done.returncode == 0, done.stderr
    assert "no cache folder can be written; set VISITLAB_CACHE" in done.stderr
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
    shutil.copytree(PACKAGE, package, ignore=shutil.ignore_patterns("__pycache__"))
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
