"""A run whose own config is missing, damaged or edited, and one that was renamed: what is said, and that it helps."""

import shutil

import pytest

from tests.commands.test_runs import json_of, tell
from tests.program import TINY, visitlab
from tests.results.runs_by_hand import LAB, open_lab, reach

CELLS = {f"navigation/mb/seed-000{seed}": 1 for seed in range(3)}


@pytest.fixture
def run(tmp_path):
    """A run by hand, in the folder `runs`, with three finished cells."""
    run, cells = open_lab(tmp_path / "runs")
    reach(run, cells, CELLS)
    return run


@pytest.fixture
def made_from(run):
    """The config that the run was made from."""
    return run.parent / "lab.yaml"


@pytest.fixture
def trained(tiny_run, tmp_path):
    """A copy of the tiny run that a test may change."""
    return shutil.copytree(tiny_run, tmp_path / "runs" / tiny_run.name)


def edit(run, old="steps: 400", new="steps: 500"):
    config = run / "config.yaml"
    text = config.read_text()
    assert old in text
    config.write_text(text.replace(old, new, 1))
    return config


def open_again(made_from):
    """Begin the run again without running a cell: its folder is opened, then the options are refused."""
    return tell("train", made_from, "--out", made_from.parent, "--quiet", "--verbose")


def test_a_run_without_its_config_is_still_a_run(run, made_from):
    config = run / "config.yaml"
    whole = config.read_bytes()
    config.unlink()
    missing = f"{config}: missing; run the config that the run was made from, which writes it anew"
    assert tell("runs", "show", "lab", "--out", run.parent) == (4, "", f"{missing}\n")
    code, out, err = tell("runs", "list", "--out", run.parent)
    assert (code, err) == (0, f"{missing}\n")
    assert out.splitlines()[1].startswith(f"{run.name}  damaged")
    code, out, err = tell("runs", "verify", "latest", "--out", run.parent)
    assert (code, err) == (4, f"{config}: restore it, or run the config that it was made from\n")
    assert "3 of 3 cells are as they were written" in out
    open_again(made_from)
    assert config.read_bytes() == whole
    assert tell("runs", "verify", run)[0] == 0


def test_a_damaged_config_is_kept_and_written_anew(run, made_from):
    config, aside = run / "config.yaml", run / "config.yaml.damaged"
    whole = config.read_bytes()
    config.write_bytes(b"\xff" + whole[1:])
    assert tell("runs", "verify", run)[0] == 4
    _, _, err = open_again(made_from)
    assert err.splitlines()[0] == f"{config}: was damaged; it is kept as config.yaml.damaged and written anew"
    assert config.read_bytes() == whole
    assert aside.read_bytes() == b"\xff" + whole[1:]
    assert tell("runs", "verify", run)[:2] == (
        0,
        f"{run}: 3 of 3 cells are as they were written; 15 more are not run yet\n",
    )
    config.write_text("[")
    line = f"{config}: damaged, and so was {aside}, which is kept; move that away first\n"
    assert open_again(made_from) == (4, "", line)
    assert (config.read_text(), aside.read_bytes()) == ("[", b"\xff" + whole[1:])


def test_an_edited_config_is_noted_by_show_and_its_plan_is_not_believed(run, made_from):
    whole = (run / "config.yaml").read_bytes()
    config = edit(run)
    code, _, err = tell("runs", "show", run)
    assert code == 0
    assert err.startswith(f"{config}: was edited: its hash is ")
    (run / "navigation/mb/seed-0000/model.npz").unlink()
    code, out, err = tell("runs", "verify", run)
    assert code == 4
    assert "steps is" not in out
    assert "not run yet" not in out
    assert err.splitlines() == [
        f"{config}: restore it, or delete it and run the config that it was made from",
        f"{run}: what is damaged counts as missing now; once its config is mended, the same command mends it",
    ]
    config.unlink()
    open_again(made_from)
    assert config.read_bytes() == whole


def test_eval_notes_an_edited_config(trained):
    config = edit(trained, "p_A: 0.05", "p_A: 0.5")
    code, _, err = tell("eval", trained)
    assert code == 0
    assert err.startswith(f"{config}: was edited: its hash is ")


def test_fewer_seeds_are_noted(run):
    edit(run, "seeds: 3", "seeds: 2")
    code, out, _ = tell("runs", "verify", run)
    assert code == 0
    lines = out.splitlines()
    assert lines[0].startswith("note: not in the plan of the run's config")
    assert lines[0].endswith(" navigation/mb/seed-0002")
    assert json_of("runs", "verify", run)["notes"] == [lines[0].removeprefix("note: ")]


def test_a_renamed_run_is_mended_and_removed_under_its_own_name(run):
    name = run.name
    renamed = run.rename(run.with_name("best"))
    (renamed / "versions.json").write_text("{")
    _, _, err = tell("runs", "verify", renamed, "--out", renamed.parent)
    again = f"visitlab run {run}/config.yaml --out {run.parent}"
    assert err.endswith(f"; rename the folder to {name} and mend it with {again}\n")
    shutil.copy(renamed / "versions.json.damaged", renamed / "versions.json")
    assert tell("runs", "rm", renamed, "--yes")[0] == 5
    (renamed / "versions.json").write_text('{"visitlab": "0"}')
    line = f"{renamed}: was renamed, so that it may be kept; to remove it, rename it to {name}\n"
    assert tell("runs", "rm", renamed, "--yes") == (4, "", line)
    assert len(list(renamed.rglob("cell.json"))) == 3
    (renamed / "versions.json.damaged").unlink()
    assert tell("runs", "rm", renamed.rename(run), "--yes")[0] == 0
    assert not run.exists()


def test_a_config_like_that_of_a_run_in_a_folder_of_the_users_is_no_run(run):
    project = run.with_name("project")
    project.mkdir()
    (project / "config.yaml").write_text(LAB.format(name="x", seed=0, seeds=1, models="paired", agents_of_social="mb"))
    assert tell("runs", "rm", project, "--yes")[0] == 5
    assert (project / "config.yaml").exists()


def test_eval_refuses_a_run_whose_config_was_edited(trained):
    config = trained / "config.yaml"
    config.write_text(config.read_text().replace("p_A: 0.05", "p_A: 0.5", 1))
    done = visitlab("eval", trained, "--frozen")
    assert done.returncode == 4
    line = f"{config}: was edited after the modules were trained; restore it, or train anew"
    assert done.stderr.splitlines()[-1] == line


def test_a_run_whose_config_was_edited_is_refused(trained):
    config = trained / "config.yaml"
    config.write_text(config.read_text().replace("alpha: 0.5", "alpha: 0.25", 1))
    done = visitlab("run", TINY, "--out", trained.parent)
    assert done.returncode == 4
    hint = "delete it and do the same again, which writes it as it was, or move the run away"
    assert done.stderr.splitlines()[-1] == f"{config}: was edited: agents.mf.alpha is 0.25, not 0.5; {hint}"
    config.unlink()
    assert visitlab("run", TINY, "--out", trained.parent).returncode == 0
