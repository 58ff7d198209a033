"""`visitlab_cli.run`: what `visitlab run` makes, from Python, without a guard around it, and its errors."""

import json
import subprocess
import sys

import pytest
import yaml

import visitlab_cli
from tests.program import TINY, hashes, the_run
from visitlab_cli.errors import ConfigError, RunError, UsageError
from visitlab_cli.sources import CHECK_DIGITS, _checked, sources
from visitlab_cli.storage.cell_folder import to_json

SETTINGS = {
    "name": "py",
    "agents": {"mf": {"kind": "q_learning"}},
    "experiments": {"navigation": {"task": "navigation", "agents": ["mf"], "steps": 400}},
}


def test_the_same_bytes_as_the_command_from_plain_values_in_a_script_without_a_guard(tiny_run, tmp_path):
    settings = yaml.safe_load(TINY.read_text())
    (tmp_path / "script.py").write_text(
        f"import visitlab_cli\nprint(len(visitlab_cli.run({settings!r}, 'runs').cells))\n"
    )
    done = subprocess.run([sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    made = the_run(tmp_path / "runs")
    assert made.name == tiny_run.name
    cells = [{path: each for path, each in hashes(run).items() if "seed-" in path} for run in (tiny_run, made)]
    assert cells[0] == cells[1]
    assert int(done.stdout) == len(list(made.rglob("cell.json")))


def test_it_goes_on_where_it_stopped(tmp_path):
    first = visitlab_cli.run(SETTINGS, tmp_path)
    file = first.cells[0].folder / "cell.json"
    before = file.stat().st_mtime_ns
    again = visitlab_cli.run(SETTINGS | {"seeds": 2}, tmp_path)
    assert (again.path, len(again.cells)) == (first.path, 2)
    assert file.stat().st_mtime_ns == before
    assert json.loads(file.read_text())["seed"] == 0


def test_going_on_with_other_code_is_told(tmp_path, capsys):
    made = visitlab_cli.run(SETTINGS, tmp_path)
    file = made.cells[0].folder / "cell.json"
    theirs = _checked("0" * (len(sources()) - CHECK_DIGITS))
    file.write_text(to_json(json.loads(file.read_text()) | {"sources": theirs}))
    capsys.readouterr()
    visitlab_cli.run(SETTINGS | {"seeds": 2}, tmp_path)
    assert f"1 cell made by other code ({theirs}; this program is {sources()})" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "error", "line"),
    [
        ({"agents": {"mf": {"kind": "q_learning", "alpha": 2}}}, ConfigError, "agents.mf.alpha: must be at most 1"),
        ({"agents": {"mf": {"kind": object()}}}, UsageError, "the config: must be plain values"),
        (
            {"include": ["humans/paper.yaml"]},
            ConfigError,
            "include: only a file includes files; write out what they have",
        ),
    ],
)
def test_what_is_wrong_is_one_of_our_errors(tmp_path, change, error, line):
    with pytest.raises(error, match=line):
        visitlab_cli.run(SETTINGS | change, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_no_worker_and_no_place(tmp_path):
    with pytest.raises(UsageError, match="workers=0: must be at least 1"):
        visitlab_cli.run(SETTINGS, tmp_path, workers=0)
    (tmp_path / "file").touch()
    with pytest.raises(RunError, match="can't be written"):
        visitlab_cli.run(SETTINGS, tmp_path / "file")


def test_every_name_that_is_promised_is_there():
    assert all(getattr(visitlab_cli, name) is not None for name in visitlab_cli.__all__)
    assert set(visitlab_cli.__all__) <= set(dir(visitlab_cli))
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        visitlab_cli.nothing  # noqa: B018
