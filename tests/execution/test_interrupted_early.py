"""Ctrl-C before a cell runs: one line and exit code 130, also where Python would drop the exception."""

import ctypes
import os
import signal
import subprocess
import sys
import time

import pytest

from tests.program import TINY, start, visitlab
from visitlab_cli import stopping

NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf], steps: 40}}"
AT_IMPORT = """
import signal, sys
class Finder:
    def find_spec(name, *_):
        if name == {name!r}:
            signal.raise_signal(signal.SIGINT)
sys.meta_path.insert(0, Finder)
from visitlab_cli.__main__ import main
main()
"""


@pytest.mark.parametrize(
    ("delay", "number"),
    [
        (0.3, signal.SIGINT),
        pytest.param(1.0, signal.SIGTERM, marks=pytest.mark.slow),
        (1.7, signal.SIGHUP),
        pytest.param(2.4, signal.SIGINT, marks=pytest.mark.slow),
    ],
)
def test_while_the_compiler_is_at_work(tmp_path, delay, number):
    program = start("run", TINY, "--out", tmp_path / "runs", env={"VISITLAB_CACHE": str(tmp_path / "cache")})
    assert any("compiling" in line for line in program.stderr)
    time.sleep(delay)
    program.send_signal(number)
    stdout, stderr = program.communicate(timeout=60)
    assert (program.returncode, stdout, stderr) == (130, "", "interrupted\n")


@pytest.mark.parametrize(
    ("delay", "number"),
    [
        pytest.param(delay, number, marks=[] if (place + other) % 3 == 0 else pytest.mark.slow)
        for place, delay in enumerate([0, 0.15, 0.3, 0.45])
        for other, number in enumerate([signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
    ],
)
def test_all_processes_are_signalled_while_the_workers_start(tiny_run, tmp_path, delay, number):
    program = start("run", TINY, "--out", tmp_path / "runs", "--workers", 2)  # tiny_run: the compiler has been at work
    assert any("cells to do" in line for line in program.stderr)
    time.sleep(delay)
    os.killpg(program.pid, number)
    _, stderr = program.communicate(timeout=60)
    assert program.returncode == 130, stderr
    assert stderr.splitlines()[-1].startswith("interrupted")
    assert "Traceback" not in stderr


@pytest.mark.parametrize("name", ["typer", "visitlab_cli.console.running", "visitlab_cli.execution.warm_up"])
def test_while_the_program_is_imported(tmp_path, name):
    arguments = ["train", TINY, NAVIGATION, "--out", tmp_path, "--quiet"]
    command = [sys.executable, "-c", AT_IMPORT.format(name=name), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


@pytest.fixture
def call_back():
    """What calls a Python function through C, where exceptions are dropped."""
    return ctypes.CFUNCTYPE(None)


def test_an_interruption_that_was_dropped_comes_again(call_back):
    handlers = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGALRM)]
    hook = sys.unraisablehook
    with pytest.raises(KeyboardInterrupt), stopping.interruptible():
        call_back(lambda: signal.raise_signal(signal.SIGINT))()
        assert stopping.was_asked()
        with pytest.raises(KeyboardInterrupt):
            stopping.check_asked()
        time.sleep(10)
    assert [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGALRM)] == handlers
    assert sys.unraisablehook is hook
    with stopping.interruptible():
        stopping.check_asked()


COMPILES = """
def compiles():
    signal.raise_signal(signal.SIGINT)
    time.sleep(0.1)
    ended.append(True)
"""


def test_the_compiler_is_not_left_midway():
    ended = []
    scope = {"__name__": "numba.core.compiler", "signal": signal, "time": time, "ended": ended}
    exec(COMPILES, scope)
    with pytest.raises(KeyboardInterrupt), stopping.interruptible():
        scope["compiles"]()
        time.sleep(10)
    assert ended


def test_other_dropped_exceptions_are_told(call_back, capfd):
    with stopping.interruptible():
        call_back(lambda: 1 / 0)()
        assert not stopping.was_asked()
    assert "ZeroDivisionError" in capfd.readouterr().err


@pytest.mark.parametrize("end", ["raise ValueError('object not compiled yet')", "sys.exit(0)"])
def test_an_interruption_that_came_to_nothing_is_told_at_the_end(end):
    program = (
        "import ctypes, signal, sys\n"
        "from visitlab_cli import cli\n"
        "def ends(**_):\n"
        "    ctypes.CFUNCTYPE(None)(lambda: signal.raise_signal(signal.SIGINT))()\n"
        f"    {end}\n"
        "cli.app = ends\n"
        "cli.main()\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")


def test_ctrl_c_in_the_end_of_python_itself_changes_no_exit_code():
    program = (
        "import os, signal, sys\n"
        "class Late:\n"
        "    def __del__(self, kill=os.kill, pid=os.getpid(), number=signal.SIGINT):\n"
        "        kill(pid, number)\n"
        "sys.late = Late()\n"
        "sys.argv = ['visitlab', '--version']\n"
        "from visitlab_cli.__main__ import main\n"
        "main()\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_run_that_lost_an_interruption_starts_no_cell(tmp_path):
    program = (
        "import sys\n"
        "from visitlab_cli import cli, stopping\n"
        "from visitlab_cli.execution import runner\n"
        "before = runner.remove_leftovers\n"
        "def lose(run):\n"
        "    stopping._asked = True\n"
        "    before(run)\n"
        "runner.remove_leftovers = lose\n"
        "cli.main()\n"
    )
    command = [sys.executable, "-c", program, "train", str(TINY), NAVIGATION, "--out", str(tmp_path), "-q"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, "interrupted\n")
    assert not list(tmp_path.rglob("seed-*"))


def test_interrupted_it_goes_on_with_the_same_command(tmp_path):
    arguments = ["train", TINY, NAVIGATION, "--out", tmp_path / "runs", "-q"]
    code = AT_IMPORT.format(name="visitlab_cli.execution.warm_up")
    subprocess.run([sys.executable, "-c", code, *map(str, arguments)], capture_output=True, check=False)
    assert os.listdir(tmp_path / "runs")
    assert visitlab(*arguments).returncode == 0
