"""`visitlab_cli.load`: what it gives is what lies in the files, and docs/python.md runs as it stands."""

import contextlib
import io
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import visitlab_cli
from tests.program import visitlab
from tests.results.runs_by_hand import open_lab, write_cell
from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.log.reader import read_steps
from visitlab_cli.storage.arrays import read_model, read_trials
from visitlab_cli.world.enums import InteractionLevel

PAGE = Path(visitlab_cli.__file__).parents[1] / "docs" / "python.md"
PIECE = re.compile(r"```python\n(.*?)```\n\n```text\n(.*?)```", re.DOTALL)
VISIT = "visit/fast/seed-0000"


def outputs(pieces):
    """What each piece of code prints, one after another in one namespace."""
    names = {}
    for code in pieces:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(code, PAGE.name, "exec"), names)
        yield re.sub(r" +$", "", printed.getvalue(), flags=re.MULTILINE)


def make_page():
    """Write into the page what its pieces print, in a folder that has its run."""
    found = outputs(code for code, _ in PIECE.findall(PAGE.read_text()))
    PAGE.write_text(PIECE.sub(lambda piece: f"```python\n{piece[1]}```\n\n```text\n{next(found)}```", PAGE.read_text()))


def test_the_page_runs_and_prints_what_it_says(tmp_path, monkeypatch):
    page = PAGE.read_text()
    (command,) = re.findall(r"^visitlab (run .*)$", page, re.MULTILINE)
    done = visitlab(*command.split(), "--quiet", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    monkeypatch.chdir(tmp_path)
    pieces = PIECE.findall(page)
    assert len(pieces) == page.count("```python") == 8
    assert list(outputs(code for code, _ in pieces)) == [output for _, output in pieces]


@pytest.fixture(scope="module")
def run(tiny_run):
    return visitlab_cli.load(tiny_run)


def test_a_run_as_it_lies_there(run, tiny_run):
    assert run.path == tiny_run
    assert run.config["agents"]["mf"]["alpha"] == 0.5
    assert len(run.cells) == 17
    assert run.versions["visitlab"] == visitlab_cli.__version__
    (cell,) = run.select(experiment="visit", human="fast")
    assert (cell.path, cell.agent, cell.seed, cell.facts["trials"]) == (VISIT, "mb", 0, 4)


def test_arrays_are_the_files(run, tiny_run):
    (cell,) = run.select(experiment="visit", human="fast")
    for found, expected in (
        (cell.trials, read_trials(tiny_run / VISIT / "trials.parquet")),
        (cell.model, read_model(tiny_run / VISIT / "model.npz")),
        (cell.steps(), read_steps(tiny_run / VISIT / "steps.mcap")),
    ):
        assert found.keys() == expected.keys()
        assert all(np.array_equal(found[name], expected[name]) for name in expected)
    assert list(cell.steps(["reward"])) == list(cell.steps("reward")) == ["reward"]
    assert cell.trial(2, ["trial", "step"])["step"].tolist() == list(range(101))


def test_trials_of_all_cells(run, tiny_run):
    frame = run.trials()
    assert list(frame) == ["experiment", "agent", "human", "seed", "trial", "reward", "goals"]
    assert len(frame) == 14 * 60 + 3 * 4
    mine = frame[(frame["experiment"] == "visit") & (frame["human"] == "fast")]
    assert mine["goals"].tolist() == read_trials(tiny_run / VISIT / "trials.parquet")["goals"].tolist()
    assert frame[frame["experiment"] != "visit"][["goals"]].isna().sum().item() > 0
    assert frame[frame["experiment"] == "navigation"]["human"].isna().all()


def test_steps_have_words(run, tiny_run):
    frame = run.steps(experiment="visit", human="fast")
    expected = read_steps(tiny_run / VISIT / "steps.mcap")
    assert list(frame) == ["experiment", "agent", "human", "seed", *expected]
    assert frame["robot_row"].tolist() == expected["robot_row"].tolist()
    words = [InteractionLevel(level).name for level in expected["interaction_level"].tolist()]
    assert frame["interaction_level"].tolist() == words
    assert list(run.steps(["reward"], agent="mf", experiment="social"))[4:] == ["reward"]


def test_models_by_state_and_action(run, tiny_run):
    frame = run.models(experiment="social", agent="mb")
    model = read_model(tiny_run / "social/mb/fast/seed-0000/model.npz")
    assert list(frame)[4:] == ["state", "action", "q", "visits", "reward_sums"]
    assert len(frame) == 2560 * 30
    row = frame.iloc[30 * 1234 + 7]
    assert (row["state"], row["action"]) == (1234, 7)
    states, actions = frame["state"].to_numpy(), frame["action"].to_numpy()
    assert np.array_equal(frame["q"].to_numpy(), model["q"][states, actions])


def test_results_are_those_of_runs_show(tmp_path):
    folder, cells = open_lab(tmp_path, more="vary: {agents.mf.alpha: [0.1, 0.5]}\n")
    for seed, value in enumerate((1.0, 2.0, 6.0)):
        write_cell(folder, cells[f"navigation/mf/agents.mf.alpha=0.5/seed-000{seed}"], [value] * 20)
    run = visitlab_cli.load("lab", out=tmp_path)
    line = run.results().set_index("name").loc["navigation/mf/agents.mf.alpha=0.5"]
    assert (line["mean"], line["n"], line["agents.mf.alpha"]) == (3.0, 3, "0.5")
    assert (line["low"], line["high"]) == pytest.approx((3 - 6.572, 3 + 6.572), abs=1e-3)
    assert len(run.cells) == 3
    assert run.trials()["agents.mf.alpha"].unique().tolist() == [0.5]


def test_what_is_not_there_is_said(run, tmp_path):
    with pytest.raises(UsageError, match="select: no 'agnet'; did you mean agent?"):
        run.select(agnet="mb")
    with pytest.raises(NotFoundError, match="no finished cell with human=slow seed=3"):
        run.trials(human="slow", seed=3)
    with pytest.raises(NotFoundError, match="nothing: no such run in"):
        visitlab_cli.load("nothing", out=tmp_path)
    folder, cells = open_lab(tmp_path)
    with pytest.raises(NotFoundError, match="no finished cell at all"):
        visitlab_cli.load(folder).trials()
    write_cell(folder, cells["navigation/mb/seed-0000"], [1.0] * 20)
    with pytest.raises(NotFoundError, match="has no log, its config records no steps"):
        visitlab_cli.load(folder).steps()


@pytest.mark.parametrize("first", [-1, 0, 2.5, "a", None, True, np.array([3])])
@pytest.mark.parametrize("frame", ["phases", "metrics"])
def test_how_many_trials_are_the_first_ones_is_a_whole_number_from_1(run, frame, first):
    with pytest.raises(UsageError, match=r"^first=.*: must be a whole number, at least 1$"):
        getattr(run, frame)(first)


def test_without_pandas_arrays_work_and_frames_say_what_they_need(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    assert len(run.cells[0].trials["reward"]) == 60
    for frame in (run.trials, run.steps, run.models, run.results):
        with pytest.raises(UsageError, match="data frames need pandas: pip install pandas"):
            frame()


def test_importing_the_package_is_light():
    program = "import sys, visitlab_cli; print(*sorted(name for name in sys.modules if '.' not in name))"
    loaded = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()
    bare = subprocess.run(
        [sys.executable, "-c", "import sys, typing; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    assert set(loaded) - set(bare.stdout.split()) == {"visitlab_cli"}
