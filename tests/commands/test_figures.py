"""`visitlab figures`: what it prints, and its exit codes."""

import json
import shutil

import pytest

from tests.program import visitlab

PLANNING = "R-max: rmax.plan_every 400, published 1000; model-based: mb.plan_every 400, published 1000"
SKIPPED = {
    "fig6": [
        "without social/rmax/human_1, social/mb/human_1, social/mf/human_1, social/mf_after_mb/human_1: not in this "
        "run",
        f"Navigation: not as published: {PLANNING}",
        f"Go to human: not as published: {PLANNING}",
    ],
    "fig7": [
        "without navigation_observed/mf, navigation_observed/mf_watching_mb, navigation_observed/mf_watching_rmax: "
        "not in this run"
    ],
}


@pytest.fixture
def copy(tiny_run, tmp_path):
    run = tmp_path / "run"
    shutil.copytree(tiny_run, run)
    return run


def test_it_prints_what_it_wrote_and_a_line_for_what_is_not_there(copy):
    done = visitlab("figures", copy, "--only", "fig6", "--only", "fig7")
    assert (done.returncode, done.stdout) == (0, f"{copy}/figures/fig6.svg\n")
    assert done.stderr.splitlines() == [f"{name}: {note}" for name, notes in SKIPPED.items() for note in notes]
    assert [file.name for file in (copy / "figures").iterdir()] == ["fig6.svg"]


def test_json(copy):
    done = visitlab("figures", copy.name, "--out", copy.parent, "--format", "png", "--only", "fig6", "--json")
    told = {"run": str(copy), "files": [f"{copy}/figures/fig6.png"], "notes": {"fig6": SKIPPED["fig6"]}}
    assert json.loads(done.stdout) == told


def test_a_run_with_nothing_to_draw(copy):
    done = visitlab("figures", copy, "--only", "fig7", "--only", "fig9")
    assert (done.returncode, done.stdout) == (5, "")
    assert done.stderr == f"{copy}: holds nothing for fig7, fig9; configs/paper/ has what each of the paper's needs\n"
    done = visitlab("figures", copy, "--only", "doors")
    needed = (
        "a training of navigation with recorded steps, a phase of which has a lab with other doors than the one before"
    )
    line = f"{copy}: holds nothing for doors; doors needs {needed}, as in configs/beyond/doors.yaml\n"
    assert (done.returncode, done.stderr) == (5, line)
    assert not (copy / "figures").exists()


@pytest.mark.parametrize(
    ("options", "code", "line"),
    [
        (
            ["--only", "fig5"],
            2,
            "--only fig5: no such figure; "
            "there are fig6, fig7, fig8, fig9, curves, doors, grid, meetings, phases, visits",
        ),
        (["--format", "gif"], 2, "--format gif: must be svg, png, pdf"),
    ],
)
def test_wrong_words(tiny_run, options, code, line):
    done = visitlab("figures", tiny_run, *options)
    assert (done.returncode, done.stdout, done.stderr) == (code, "", line + "\n")


def test_no_such_run(tmp_path):
    done = visitlab("figures", "nowhere", "--out", tmp_path)
    assert (done.returncode, done.stderr) == (5, f"nowhere: no such run in {tmp_path}\n")
