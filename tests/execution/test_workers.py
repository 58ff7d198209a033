"""Workers run the program's own code, whatever the folder that it is started in."""

import json
import os
import resource
import shutil
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

import visitlab_cli
from tests.program import TINY, copy_package, hashes, new_process, the_run
from visitlab_cli.config.loading import load
from visitlab_cli.execution import workers
from visitlab_cli.execution.progress import Progress
from visitlab_cli.execution.runner import run_cells
from visitlab_cli.plan.cells import plan

PACKAGE = Path(visitlab_cli.__file__).parent
RULE = "world/navigation.py", "reward = 1.0 if", "reward = 2.0 if"
NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf, chance], steps: 200}}"
SHADOWS = ("random", "socket", "numpy", "typing", "multiprocessing", "pydantic", "visitlab_cli")
INSTALLED = "import sys\nfrom visitlab_cli.__main__ import main\nif __name__ == '__main__':\n    sys.exit(main())\n"


@pytest.fixture
def clone(tmp_path):
    """A folder with a copy of the package in which a rule was edited."""
    package = tmp_path / "clone" / "visitlab_cli"
    copy_package(package)
    shutil.copytree(PACKAGE.parent / "configs", package / "shipped_configs")
    file, old, new = RULE
    text = (package / file).read_text()
    assert text.count(old) == 1
    (package / file).write_text(text.replace(old, new))
    return package.parent


@pytest.fixture
def played(tmp_path):
    """Runs a script as `bin/visitlab`, or a module, in a folder: what it left, by path, and its cells' sources."""
    script = tmp_path / "bin" / "visitlab"
    script.parent.mkdir()
    script.write_text(INSTALLED)

    def run(folder, count, *python, pythonpath=None):
        out = tmp_path / f"runs-{len(list(tmp_path.iterdir()))}"
        environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
        environment |= {"NUMBA_DISABLE_JIT": "1"} | ({"PYTHONPATH": str(pythonpath)} if pythonpath else {})
        command = [sys.executable, *(python or [script]), "run", TINY, NAVIGATION, "--workers", count, "--out", out]
        done = subprocess.run(
            [*map(str, command)], cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        return hashes(the_run(out))

    return run


@pytest.mark.slow
def test_what_lies_in_the_current_folder_is_not_imported(clone, played, tmp_path):
    own = played(tmp_path, 1)
    assert played(clone, 1) == own
    assert played(clone, 2) == own
    shadowed = tmp_path / "shadowed"
    shadowed.mkdir()
    for name in SHADOWS:
        (shadowed / f"{name}.py").write_text("raise SystemExit('the wrong module')\n")
    assert played(shadowed, 2) == own


def test_workers_have_the_code_that_the_program_has(clone, played, tmp_path):
    edited = played(tmp_path, 1, pythonpath=clone)
    assert edited != played(tmp_path, 1)
    assert played(tmp_path, 2, pythonpath=clone) == edited
    assert played(clone, 2, "-m", "visitlab_cli") == edited


def test_the_script_that_runs_is_not_run_once_more(played, tmp_path):
    script = tmp_path / "user.py"
    script.write_text(
        "open('times', 'a').write('once ')\nimport sys\nfrom visitlab_cli.__main__ import main\nsys.exit(main())\n"
    )
    assert played(tmp_path, 2, script) == played(tmp_path, 1)
    assert (tmp_path / "times").read_text() == "once "


@pytest.mark.parametrize("other", [("elsewhere", workers.code().sources), (workers.code().package, "0" * 16)])
def test_a_worker_with_other_code_refuses(other, tmp_path, monkeypatch, capfd):
    cells = plan(load(TINY, [NAVIGATION, "seeds=3"]))
    monkeypatch.setattr(workers, "code", lambda kinds: workers.Code(*other))
    with pytest.raises(workers.OtherCodeError) as refused:
        run_cells(tmp_path, cells, 2, Progress())
    assert refused.value.exit_code == 4
    assert len(str(refused.value).splitlines()) == 1
    assert not list(tmp_path.rglob("cell.json"))
    assert "Traceback" not in capfd.readouterr().err


def test_python_that_ignores_the_environment_is_told_what_to_do(tmp_path):
    command = [sys.executable, "-E", "-m", "visitlab_cli", "run", TINY, NAVIGATION, "--out", tmp_path, "--workers"]
    done = subprocess.run([*map(str, command), "2"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1].startswith("python -E: ")


def test_the_surroundings_are_left_as_they_were(tmp_path, monkeypatch):
    monkeypatch.setenv(workers.SAFE_PATH, "")
    before = dict(os.environ)
    assert run_cells(tmp_path, plan(load(TINY, [NAVIGATION])), 2, Progress(quiet=True)) == {}
    assert dict(os.environ) == before
    assert json.loads(next(tmp_path.rglob("cell.json")).read_text())["cell"]


def takes_a_while(run, cell, slot):
    time.sleep(0.5)


def test_at_the_end_no_pool_that_was_given_up_is_still_closing(tmp_path, monkeypatch):
    monkeypatch.setattr(workers, "_run_in_slot", takes_a_while)
    pool = workers.Workers(2)
    (cell, *_) = plan(load(TINY))
    pool.submit(tmp_path, cell, 0)
    manager = pool._executor._executor_manager_thread
    pool.replace()
    assert manager.is_alive()
    pool.close()
    assert not manager.is_alive()


@pytest.mark.parametrize("most", [18, 22, 26])
def test_where_few_files_may_be_open_that_is_said_in_a_line_and_what_starts_the_workers_says_nothing(tmp_path, most):
    few = partial(resource.setrlimit, resource.RLIMIT_NOFILE, (most, most))
    environment = {"NUMBA_DISABLE_JIT": "1"}
    done = new_process("run", TINY, NAVIGATION, "-w", 2, "-q", "--out", tmp_path, env=environment, preexec_fn=few)
    assert done.returncode == 4
    assert done.stderr.splitlines()[0].startswith("the system does not let us go on: Too many open files (at most")
    assert len(done.stderr.splitlines()) == 1
