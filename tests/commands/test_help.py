"""The help pages: panels, examples that run, near misses; completion; readers that leave early."""

import glob
import os
import shlex
import shutil
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from tests.program import COMMAND, TINY, visitlab
from visitlab_cli import commands
from visitlab_cli.cli import app
from visitlab_cli.config.canonical import dump_yaml
from visitlab_cli.config.loading import load
from visitlab_cli.console.help import PANELS, commands_in, examples_in

EXAMPLES = dict(examples_in(commands))
EXAMPLES |= {"runs rm": EXAMPLES.pop("runs rm")}  # the last, for it removes what the others show
ALONE = {command.name for command in app.registered_commands}
GROUPS = {group.name: group.typer_instance for group in app.registered_groups}
WITHIN = {f"{name} {each.name}" for name, group in GROUPS.items() for each in group.registered_commands}
HEAVY = {"numpy", "numba", "yaml", "pyarrow", "mcap", "google.protobuf", "rerun", "matplotlib", "pandas"}
COMPLETE = (
    "import sys; sys.argv = ['visitlab']; from visitlab_cli.cli import main\n"
    "try: main()\n"
    f"finally: print(sorted({HEAVY!r} & set(sys.modules)), file=sys.stderr)"
)


def in_shell(line, folder):
    """Run a line of a page in bash, `visitlab` being this program."""
    script = f'set -o pipefail; visitlab() {{ "{COMMAND[0]}" -m visitlab_cli "$@"; }}; {line}'
    environment = os.environ | {"NO_COLOR": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(
        ["bash", "-c", script], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def in_this_process(line):
    """Run a line without pipes here, which saves the imports of each."""
    words = [found for word in shlex.split(line) for found in (sorted(glob.glob(word)) if "*" in word else [word])]
    return CliRunner().invoke(app, words[1:], catch_exceptions=False)


def test_every_command_has_a_panel_and_two_examples():
    assert {module.HELP.panel for _, module in commands_in(commands)} == set(PANELS)
    assert set(EXAMPLES) == ALONE | WITHIN
    for words, examples in EXAMPLES.items():
        assert len(examples) == 2, words
        assert all(example.startswith(f"visitlab {words}") for example in examples)


@pytest.mark.slow
def test_the_examples_run_one_after_the_other(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for words, examples in EXAMPLES.items():
        assert words in ALONE | WITHIN, f"{words}: has examples, but is no command"
        for example in examples:
            if "|" in example or ">" in example:
                done = in_shell(example, tmp_path)
                assert done.returncode == 0, f"{example}: {done.stderr}"
            else:
                done = in_this_process(example)
                assert done.exit_code == 0, f"{example}: {done.output}"
            assert done.stdout or ">" in example, example


def test_the_help_shows_panels_in_order_and_examples():
    told = visitlab("--help").stdout
    places = [told.index(f"─ {panel} ─") for panel in PANELS]
    assert places == sorted(places)
    assert EXAMPLES["eval"][1] in visitlab("eval", "-h").stdout


def test_no_arguments_show_the_help():
    done = visitlab()
    assert "visitlab [OPTIONS] COMMAND" in done.stdout + done.stderr


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ("list", "visitlab: no such command 'list'; did you mean 'runs list'?; see visitlab --help"),
        ("runs shw x", "visitlab runs: no such command 'shw'. Did you mean 'show'?; see visitlab runs --help"),
        ("run", "visitlab run: missing argument 'CONFIG'; see visitlab run --help"),
        ("train x -w two", "visitlab train: invalid value for '--workers' / '-w': must be a whole number; see "),
        ("runs show x --lvel 1", "visitlab runs show: no such option: --lvel (Possible options: "),
        ("--colour", "visitlab: no such option: --colour"),
    ],
)
def test_wrong_usage_is_one_line(words, line):
    done = visitlab(*words.split())
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith(line)


def test_no_color_stands_anywhere(tmp_path):
    for words in (("--no-color", "runs", "list"), ("runs", "list", "--no-color"), ("runs", "--no-color", "list")):
        assert visitlab(*words, "--out", tmp_path).returncode == 0
    assert visitlab("runs", "list", "--out", tmp_path, "--", "--no-color").returncode == 2


@pytest.mark.parametrize(("word", "meant"), [("runn", "run"), ("valdate", "validate"), ("inti", "init")])
def test_near_misses_of_commands_are_suggested(word, meant):
    done = visitlab(word)
    assert done.returncode == 2
    assert f"'{meant}'" in done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder of a user who ran quickstart (only its config is there)."""
    folder = tmp_path_factory.mktemp("user")
    run = folder / "runs" / "quickstart-0123abcd"
    run.mkdir(parents=True)
    (run / "config.yaml").write_text(dump_yaml(load("quickstart", ["vary={agents.mb.epsilon: [0.1]}"])))
    shutil.copytree(run, folder / "runs" / "quickstart-\x1b[2J")
    older = folder / "runs" / "older-0123abcd"
    older.mkdir()
    (older / "config.yaml").write_text(dump_yaml(load("quickstart", ["humans.another={p_S: [1, 0, 0]}"])))
    os.utime(older, (0, 0))
    (folder / "mine.yaml").touch()
    return folder


def completed(line, folder):
    words = line.split(" ")
    variables = {
        "_VISITLAB_COMPLETE": "complete_bash",
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(words) - 1),
        "PYTHONPATH": os.pathsep.join(sys.path),
    }
    done = subprocess.run(
        [sys.executable, "-c", COMPLETE],
        cwd=folder,
        env=os.environ | variables,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == "[]\n", done.stderr
    return done.stdout.split()


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("visitlab va", ["validate"]),
        ("visitlab run pa", ["paper"]),
        ("visitlab run paper/fig8_h", ["paper/fig8_humans"]),
        ("visitlab validate qui", ["quickstart"]),
        ("visitlab init my", ["my-human"]),
        ("visitlab run mi", ["mine.yaml"]),
        ("visitlab eval la", ["latest"]),
        ("visitlab eval quick", ["quickstart-0123abcd"]),
        ("visitlab eval latest --human hu", ["human_2"]),
        ("visitlab eval quickstart --human x", []),
        ("visitlab eval runs/qui", ["runs/quickstart-0123abcd"]),
        ("visitlab eval ru", []),
        ("visitlab eval ./ru", ["./runs/"]),
        ("visitlab compare latest --by a", ["agent", "agents.mb.epsilon"]),
        ("visitlab export latest --table tr", ["trials"]),
        ("visitlab steps latest --trial wo", ["worst"]),
        ("visitlab figures latest --only fig6 --format p", ["png", "pdf"]),
    ],
)
def test_completion_loads_nothing_heavy(line, found, folder):
    assert completed(line, folder) == found


def test_a_reader_that_leaves_early_is_no_failure(tiny_run, tmp_path):
    done = in_shell("visitlab schema | head -n 1", tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "{\n", "")
    gone = in_shell(f"visitlab steps '{tiny_run}' --experiment visit_scripted --json | true", tmp_path)
    assert (gone.returncode, gone.stderr) == (0, "")


def test_json_is_all_that_stdout_has(tmp_path):
    one_cell = "experiments={navigation: {task: navigation, agents: [mf], steps: 40}}"
    line = f"visitlab run {TINY} '{one_cell}' --json --out . | '{sys.executable}' -m json.tool --compact"
    done = in_shell(line, tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith('{"run":')
    assert "cells to do" in done.stderr
