"""All figures of a run as files: by the real program, and with the same bytes again."""

import shutil

import matplotlib
import pytest

from tests.program import visitlab
from visitlab_cli.commands.figures import FIGURES
from visitlab_cli.errors import RunError
from visitlab_cli.figures.making import NAMES, make_figures
from visitlab_cli.replay.strip import strip

PAPER = [*(name for name in NAMES if name.startswith("fig")), "visits"]
"""What a run of the paper's config has."""


@pytest.fixture
def copy(paper_run, tmp_path):
    run = tmp_path / "run"
    shutil.copytree(paper_run, run)
    return run


def contents(run):
    """The pictures of a run, which are then taken away."""
    found = {file.name: file.read_bytes() for file in (run / "figures").iterdir()}
    shutil.rmtree(run / "figures")
    return found


def test_one_command_makes_them_all_and_again_the_same_bytes(copy):
    done = visitlab("figures", copy)
    assert (done.returncode, done.stdout.splitlines()) == (0, [f"{copy}/figures/{name}.svg" for name in PAPER])
    *unlike, told = done.stderr.splitlines()
    assert all(": not as published: " in line for line in unlike)
    assert told.startswith("fig9: shows visit/human_2/seed-0000, trial ")
    first = contents(copy)
    made = make_figures(copy, strip)
    assert [file.name for file in made.files] == [f"{name}.svg" for name in PAPER]
    assert contents(copy) == first


@pytest.mark.parametrize("kind", ["svg", "pdf", "png"])
def test_the_users_own_settings_change_nothing(copy, kind):
    make_figures(copy, strip, ["fig7"], kind)
    first = contents(copy)
    with matplotlib.rc_context({"font.size": 30, "lines.linewidth": 9, "svg.hashsalt": "mine"}):
        make_figures(copy, strip, ["fig7"], kind)
        assert matplotlib.rcParams["font.size"] == 30
    assert contents(copy) == first
    assert list(first) == [f"fig7.{kind}"]


def test_a_damaged_cell_is_one_line(copy):
    file = copy / "navigation_observed" / "mf" / "seed-0001" / "model.npz"
    file.write_bytes(b"x" * file.stat().st_size)
    with pytest.raises(RunError) as caught:
        make_figures(copy, strip, ["fig7"])
    assert str(caught.value).startswith(f"{file}: damaged: File is not a zip file")


def test_a_folder_that_cannot_be_written_is_one_line(copy):
    (copy / "figures").write_text("in the way")
    with pytest.raises(RunError) as caught:
        make_figures(copy, strip, ["fig7"])
    assert str(caught.value) == f"{copy}/figures: is a file where a folder belongs; move it away"


def test_the_command_names_all_that_can_be_drawn():
    assert FIGURES == NAMES
