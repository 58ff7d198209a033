"""What `eval` with options of its own played: shown, verified, mended, loaded, reported."""

import json
import shutil

import pytest

import visitlab_cli
from tests.program import hashes, visitlab
from visitlab_cli.plan.evaluation import AS_DECLARED, Evaluation, record_evaluation, recorded_evaluations
from visitlab_cli.storage.arrays import read_trials

OPTIONS = ("--human", "fast", "--trials", 20, "--frozen", "-e", "visit", "-q")
PLAYED = Evaluation(("fast",), 20, frozen=True)
CELL = f"{PLAYED.folder}visit/fast/seed-0000"


@pytest.fixture(scope="module")
def evaluated(tiny_run, tmp_path_factory):
    """A run with an evaluation; not to be changed."""
    run = tmp_path_factory.mktemp("evaluated") / tiny_run.name
    shutil.copytree(tiny_run, run)
    done = visitlab("eval", run, *OPTIONS)
    assert done.returncode == 0, done.stderr
    return run


@pytest.fixture
def run(evaluated, tmp_path):
    return shutil.copytree(evaluated, tmp_path / evaluated.name)


def test_show_has_a_line_that_says_how_it_was_played(evaluated):
    shown = visitlab("runs", "show", evaluated).stdout.splitlines()
    assert shown[0].startswith(f"{evaluated}: done, 17 of 17 cells")
    head = next(line for line in shown if line.startswith("experiment"))
    assert "played" in head.split()
    (line,) = [line for line in shown if "frozen, 20 trials" in line]
    told = json.loads(visitlab("runs", "show", evaluated, "--json").stdout)["results"]
    assert [each["evaluation"] for each in told if each["evaluation"]] == [
        {"humans": ["fast"], "trials": 20, "frozen": True, "social": ""}
    ]
    mean = read_trials(evaluated / CELL / "trials.parquet")["goals"].mean()
    assert f"{mean:.2f} ± ?" in line


def test_nothing_is_said_of_how_where_nothing_was_evaluated(tiny_run):
    assert "played" not in visitlab("runs", "show", tiny_run).stdout


def test_damage_is_named_and_mended_by_the_same_eval(run):
    assert visitlab("runs", "verify", run).stdout == f"{run}: 18 of 18 cells are as they were written\n"
    before = hashes(run)
    (run / CELL / "model.npz").unlink()
    (run / PLAYED.folder / "evaluation.json").write_text("{}")
    done = visitlab("runs", "verify", run)
    assert done.returncode == 4
    assert done.stdout.splitlines()[:2] == [
        f"{CELL}/model.npz: missing",
        f"{PLAYED.folder}evaluation.json: missing or damaged",
    ]
    assert "not in the plan" not in done.stdout
    mend = "what is damaged of evaluations/ counts as missing now; mend it with the same visitlab eval"
    assert done.stderr == f"{run}: {mend}\n"
    assert visitlab("eval", run, *OPTIONS).returncode == 0
    assert visitlab("runs", "verify", run).returncode == 0
    assert {path: digest for path, digest in hashes(run).items() if not path.endswith(".damaged")} == before


def test_verify_knows_how_long_it_should_be(run):
    facts = run / CELL / "cell.json"
    facts.write_text(facts.read_text().replace('"steps": 2000', '"steps": 1900'))
    assert f"{CELL}/cell.json: steps is 1900, not 2000" in visitlab("runs", "verify", run).stdout


def test_load_has_it_apart(evaluated):
    run = visitlab_cli.load(evaluated)
    assert {cell.path for cell in run.select(experiment="visit", human="fast")} == {"visit/fast/seed-0000"}
    (name,) = run.evaluations
    assert name == "frozen, 20 trials: fast"
    played = run.evaluations[name]
    assert [cell.path for cell in played.cells] == [CELL]
    assert len(played.trials()) == 20
    assert played.evaluations == {}


def test_the_report_has_it(evaluated, tmp_path):
    page = tmp_path / "page.html"
    assert visitlab("report", evaluated, "-o", page).returncode == 0
    assert "visit, frozen, 20 trials" in page.read_text()


def test_options_are_kept_as_they_are(tmp_path):
    several = [
        Evaluation(("fast",)),
        Evaluation(trials=7),
        Evaluation(frozen=True),
        Evaluation(("a", "b"), 1, True, "social/mb/c"),
    ]
    for each in [*several, AS_DECLARED]:
        record_evaluation(tmp_path, each)
    assert set(recorded_evaluations(tmp_path)) == set(several)
    assert several[3].words == "frozen, 1 trial, with social/mb/c"


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"frozen": false, "humans": [], "social": "", "trials": 8}', '{"humans": 3}', "\xff"]
)
def test_options_that_are_not_those_of_the_folder_are_none(tmp_path, text):
    evaluation = Evaluation(trials=7)
    record_evaluation(tmp_path, evaluation)
    (tmp_path / evaluation.folder / "evaluation.json").write_text(text, encoding="latin-1")
    assert recorded_evaluations(tmp_path) == []
    record_evaluation(tmp_path, evaluation)
    assert recorded_evaluations(tmp_path) == [evaluation]
