"""What the user's surroundings say reaches nothing: the same pictures, words and results, or one line."""

import os
import subprocess

import pytest

from tests.program import COMMAND, TINY, hashes, the_run, visitlab

NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf], steps: 1200}}"
HOSTILE = {
    "MPLBACKEND": "module://matplotlib_inline.backend_inline",
    "RERUN": "off",
    "RERUN_STRICT": "nonsense",
    "RUST_LOG": "trace",
    "PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION": "cpp",
    "SOURCE_DATE_EPOCH": "nonsense",
    "PYTHONWARNINGS": "error",
    "NUMBA_NUM_THREADS": "0",
    "NUMBA_CPU_NAME": "nonsense",
    "NUMBA_DEBUG": "1",
    "NUMBA_CACHE_LOCATOR_CLASSES": "Nonsense",
    "NPY_DISABLE_CPU_FEATURES": "nonsense",
    "ARROW_DEFAULT_MEMORY_POOL": "nonsense",
    "OMP_NUM_THREADS": "nonsense",
    "OPENBLAS_CORETYPE": "nonsense",
    "COLUMNS": "\u00b2",
    "LINES": "-1",
    "TERMINAL_WIDTH": "nonsense",
    "TERM": "dumb",
    "FORCE_COLOR": "1",
    "NO_COLOR": "",
    "LC_ALL": "nonsense",
    "PYTHONIOENCODING": "ascii",
    "PYTHONHASHSEED": "7",
    "PYTHONOPTIMIZE": "1",
    "PYTHONDONTWRITEBYTECODE": "1",
    "TZ": "nonsense",
    "TMPDIR": "/nonsense",
    "XDG_CONFIG_HOME": "/dev/null/x",
    "XDG_DATA_HOME": "relative",
}
FAT = "text.usetex: True\nlines.linewidth: 9\nfont.size: 30\nsvg.fonttype: none\nnonsense: 1\n"


def drawn(run, folder, environment, before=()):
    """A strip and the size of a recording, made in a folder where other files were `before`."""
    folder.mkdir()
    for name, content in before:
        (folder / name).write_text(content)
    social = ["replay", run, "-e", "social", "--agent", "mb"]
    files = [folder / "strip.svg", folder / "trial.rrd"]
    for file in files:
        option = "--save" if file.suffix == ".rrd" else "--strip"
        done = visitlab(*social, option, file, cwd=folder, env=environment)
        assert done.returncode == 0, done.stderr
        assert "arn" not in done.stderr, done.stderr
    return files[0].read_bytes(), files[1].stat().st_size // 10_000


@pytest.mark.slow
def test_pictures_are_the_same_whatever_the_surroundings_say(tiny_run, tmp_path):
    home = tmp_path / "home"
    (home / ".config" / "matplotlib").mkdir(parents=True)
    (home / ".config" / "matplotlib" / "matplotlibrc").write_text(FAT)
    (home / "matplotlibrc").write_text(FAT)
    usual = drawn(tiny_run, tmp_path / "usual", {})
    homely = HOSTILE | {"HOME": str(home), "MATPLOTLIBRC": str(home)}
    assert drawn(tiny_run, tmp_path / "hostile", homely, [("matplotlibrc", FAT)]) == usual


def test_results_are_the_same_whatever_the_surroundings_say(tiny_run, tmp_path):
    done = visitlab("run", TINY, NAVIGATION, "--out", tmp_path, "--workers", 2, env=HOSTILE)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr + done.stdout
    model = "navigation/mf/seed-0000/model.npz"
    assert hashes(the_run(tmp_path))[model] == hashes(tiny_run)[model]


@pytest.mark.parametrize(
    ("environment", "name"),
    [
        ({"NUMBA_DISABLE_JIT": "\x1b[2J"}, "NUMBA_DISABLE_JIT"),
        ({"PYTHONOPTIMIZE": "2"}, "PYTHONOPTIMIZE"),
    ],
)
def test_what_must_not_be_set_is_named_in_one_line(environment, name):
    done = visitlab("optimum", env=environment)
    assert done.returncode == 2
    assert name in done.stderr
    assert "unset" in done.stderr
    assert done.stderr.count("\n") == 1
    assert done.stderr.rstrip("\n").isprintable()


def test_numbas_settings_in_the_folder_are_named(tmp_path):
    (tmp_path / ".numba_config.yaml").write_text("debug: 1\n")
    done = visitlab("optimum", cwd=tmp_path)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert ".numba_config.yaml" in done.stderr


def test_without_a_home_or_variables_it_runs(tmp_path):
    bare = {"PATH": os.environ["PATH"], "VISITLAB_CACHE": os.environ.get("VISITLAB_CACHE", "")}
    done = subprocess.run(
        [*COMMAND, "validate", "quickstart"], env=bare, cwd=tmp_path, check=False, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_a_long_temporary_folder_stops_no_workers(tmp_path):
    long = tmp_path / ("x" * 128)
    long.mkdir()
    done = visitlab("run", TINY, NAVIGATION, "seeds=2", "--out", tmp_path / "r", "-w", 2, env={"TMPDIR": str(long)})
    assert done.returncode == 0, done.stderr


def test_a_terminals_width_is_a_number(tmp_path):
    for columns in ("0", "\u00b2"):
        done = visitlab("--help", env={"COLUMNS": columns})
        assert done.returncode == 0, done.stderr
        assert "Run, record and replay" in done.stdout
