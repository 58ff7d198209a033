"""What no command takes: an empty word where a path or a name belongs, and no number."""

import pytest

from tests.program import visitlab


@pytest.mark.parametrize(
    ("words", "name"),
    [
        (["runs", "list", "--out", ""], "--out"),
        (["report", "RUN", "-o", ""], "--output"),
        (["init", "--folder="], "--folder"),
        (["plugin", "new", "mine", "-f", ""], "--folder"),
        (["compare", "RUN", "--page", ""], "--page"),
        (["submit", "quickstart", "--shell", "--script", ""], "--script"),
        (["labs", "quickstart", "--picture", ""], "--picture"),
        (["optimum", ""], "CONFIG|RUN"),
        (["recover", ""], "FILE"),
        (["runs", "show", ""], "RUN"),
        (["validate", "quickstart", "seeds=1", ""], "KEY=VALUE"),
    ],
)
def test_an_unset_variable_is_no_path(tiny_run, tmp_path, words, name):
    done = visitlab(*(tiny_run if word == "RUN" else word for word in words), cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"{name}: must not be empty\n")
    assert list(tmp_path.iterdir()) == []


def test_here_is_a_path_and_no_name_is_no_choice(tiny_run):
    assert visitlab("runs", "list", "--out", ".", cwd=tiny_run.parent).returncode == 0
    assert visitlab("runs", "list", "--help").returncode == 0
    assert visitlab("metrics", tiny_run, "--experiment", "").returncode == 0


@pytest.mark.parametrize(
    "words",
    [
        ["compare", "RUN", "--margin"],
        ["export", "RUN", "--ros2bag", "--cell-size"],
        ["optimum", "--gamma"],
        ["runs", "show", "RUN", "--level"],
        ["submit", "quickstart", "--shell", "--margin"],
        ["affordances", "RUN", "--intents", "--threshold"],
    ],
)
@pytest.mark.parametrize("number", ["nan", "inf", "1e300"])
def test_every_number_has_its_bounds(tiny_run, words, number):
    done = visitlab(*(tiny_run if word == "RUN" else word for word in words), number)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert words[-1] in done.stderr
