"""`visitlab eval --matrix` and `--experiment`, end to end."""

import json
import shutil

import pytest
from typer.testing import CliRunner

from tests.program import hashes, the_run, visitlab
from visitlab_cli.cli import app
from visitlab_cli.config.loading import load
from visitlab_cli.console import matrix
from visitlab_cli.console.matrix import planned_cells
from visitlab_cli.console.running import How
from visitlab_cli.errors import NotFoundError, RunError, UsageError

LAB = """
name: lab
seeds: 2
humans: {slow: {p_S: [1, 0, 0]}, fast: {p_S: [0, 0, 1]}, lost: {like: fast, p_A: 0.5}}
agents: {mf: {kind: q_learning}}
experiments:
  navigation: {task: navigation, agents: [mf], steps: 400}
  go_to_human: {task: go_to_human, agents: [mf], steps: 400}
  social: {task: social, agents: [mf], humans: [slow, fast], steps: 400}
  on: {task: social, agents: [mf], humans: [lost], steps: 400, start_from: social/mf/slow}
  visit:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mf, social: social/mf/slow}
    humans: [slow]
    trials: 10
  visit_on:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mf, social: on/mf/lost}
    humans: [lost]
    trials: 10
record: {steps: none}
"""


def in_this_process(*words):
    """Run a command here, which saves the imports; its errors are raised."""
    return CliRunner().invoke(app, [str(word) for word in words], catch_exceptions=False)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("matrix")
    (folder / "lab.yaml").write_text(LAB)
    done = visitlab("train", folder / "lab.yaml", "--out", folder / "runs", "--workers", 2)
    assert done.returncode == 0, done.stderr
    return the_run(folder / "runs")


def test_the_matrix_is_played_told_and_drawn_and_again_the_same(run):
    done = visitlab("eval", run, "--matrix", "--workers", 2)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0] == "Goals a trial of visit with social/mf, n = 2 seeds."
    heads = [number for number, line in enumerate(lines) if line.split() == ["trained", "with", "slow", "fast", "lost"]]
    assert len(heads) == 2
    for head in heads:
        assert [lines[head + row].split()[0] for row in (1, 2)] == ["slow", "fast"]
        assert lines[head + 1].count("±") == 3
    picture = run / "figures" / "matrix.svg"
    assert lines[-1] == str(picture)
    assert len(list(run.glob("evaluations/*/visit/*/seed-*/cell.json"))) == 2 * (2 * 3 * 2 - 1)
    before = hashes(run)
    again = visitlab("eval", run, "--matrix", "--workers", 1)
    assert (again.stdout, again.stderr) == (done.stdout, "")
    assert hashes(run) == before
    assert in_this_process("runs", "verify", run).exit_code == 0


def test_one_human_fewer_trials_another_picture_as_json(run, tmp_path):
    target = tmp_path / "matrix.png"
    done = visitlab("eval", run, "--matrix", "--human", "lost", "--trials", 3, "--picture", target, "--json", "-q")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert (told["humans"], told["trials"], told["picture"]) == (["lost"], 3, str(target))
    assert [(each["trained_with"], each["mode"], each["n"]) for each in told["goals"]] == [
        (trained, mode, 2) for trained in ("slow", "fast") for mode in ("frozen", "adapting")
    ]
    assert all((run / each["cells"] / "seed-0001" / "cell.json").is_file() for each in told["goals"])
    assert target.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_picture_that_cannot_be_written_costs_no_table(run, tmp_path, options):
    (tmp_path / "file").touch()
    target = tmp_path / "file" / "matrix.png"
    few = ["--human", "lost", "--trials", 3, "--quiet"]
    done = visitlab("eval", run, "--matrix", *few, "--picture", target, *options)
    assert done.returncode == 4
    assert done.stderr.startswith(f"{target}: can't be written: ")
    assert "trained with" in done.stdout or json.loads(done.stdout)["goals"]


def test_a_picture_that_cannot_be_written_hides_no_failure(run, tmp_path, monkeypatch, capsys):
    planned = planned_cells(run, load(run / "config.yaml"), "visit", ["lost"], 3)
    monkeypatch.setattr(matrix, "run_missing", lambda *_: {"visit/lost/seed-0000": "it broke"})
    (tmp_path / "file").touch()
    target = tmp_path / "file" / "matrix.png"
    with pytest.raises(RunError, match="visit/lost/seed-0000: it broke"):
        matrix.play_matrix(run, planned, target, How(1, False, False, False, False))
    assert capsys.readouterr().err.startswith(f"{target}: can't be written: ")


def test_a_visit_of_a_module_that_started_from_another(run):
    done = visitlab("eval", run, "--experiment", "visit_on", "--matrix", "--trials", 2, "--human", "slow", "--json")
    assert json.loads(done.stdout)["trained_with"] == ["lost"]


def test_a_matrix_takes_the_place_of_no_other_visits_and_tells_of_another_question(run):
    matrix = ["eval", run, "--matrix", "--human", "slow", "--quiet", "--trials"]
    figures = run / "figures"
    assert visitlab(*matrix, 2).stdout.splitlines()[-1] == str(figures / "matrix.svg")
    before = (figures / "matrix.svg").read_bytes()
    other = visitlab(*matrix, 2, "--experiment", "visit_on")
    assert (other.stdout.splitlines()[-1], other.stderr) == (str(figures / "matrix-visit_on.svg"), "")
    assert (figures / "matrix.svg").read_bytes() == before
    loud = [word for word in matrix if word != "--quiet"]
    words = f"{figures / 'matrix.svg'}: took the place of another matrix, of other humans, trials or seeds\n"
    assert visitlab(*loud, 3).stderr.endswith(words)
    assert (figures / "matrix.svg").read_bytes() != before


def test_one_visit_of_two(run):
    alone = visitlab("eval", run, "-e", "visit_on", "--trials", 2, "--json")
    (result,) = json.loads(alone.stdout)["results"]
    assert result["name"].endswith("/visit_on/lost")


def test_what_there_is_to_do_is_told_and_nothing_written(run):
    before = hashes(run)
    told = json.loads(in_this_process("eval", run, "--matrix", "--trials", 9, "--dry-run", "--json").stdout)
    assert (told["cells"], told["done"]) == (24, 0)
    assert hashes(run) == before


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--matrix", "--frozen"], "leave out --frozen"),
        (["--picture", "x.svg"], "add --matrix"),
        (["--matrix", "--picture", "x.jpg"], r"must end in \.svg, \.png, \.pdf"),
        (["--matrix", "--quiet", "--verbose"], "choose one"),
    ],
)
def test_wrong_usage_is_refused(run, options, words):
    with pytest.raises(UsageError, match=words):
        in_this_process("eval", run, *options)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--matrix", "--human", "fats"], r"did you mean fast\?"),
        (["--matrix", "--experiment", "visit_off"], r"did you mean visit_on\?"),
        (["--experiment", "social"], "declares no such visit"),
    ],
)
def test_whom_a_run_does_not_have_is_not_found(run, options, words):
    with pytest.raises(NotFoundError, match=words):
        in_this_process("eval", run, *options)


def test_a_grid_has_no_matrix(run):
    grid = load(run / "config.yaml", ["vary={agents.mf.alpha: [0.1, 0.5]}"])
    with pytest.raises(UsageError, match=r"varies agents\.mf\.alpha"):
        planned_cells(run, grid, "visit", (), None)


def test_what_is_not_trained_is_named(run, tmp_path):
    copy = tmp_path / run.name
    shutil.copytree(run, copy)
    (copy / "social/mf/fast/seed-0001/cell.json").unlink()
    with pytest.raises(RunError, match="not trained yet: social/mf/fast/seed-0001"):
        in_this_process("eval", copy, "--matrix", "--trials", 8)
