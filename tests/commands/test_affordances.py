"""`visitlab affordances`, end to end."""

import json

import pytest

from tests.program import visitlab


def test_affordances_prints_the_arrows(tiny_run):
    done = visitlab("affordances", tiny_run)
    assert done.returncode == 0, done.stderr
    assert "social/mb/fast/seed-0000, learned with fast" in done.stdout
    assert "visit/slow/seed-0000, after its visit to slow" in done.stdout


def test_affordances_as_json(tiny_run):
    found = json.loads(visitlab("affordances", tiny_run, "--json").stdout)
    assert found["trained"]["human"] == "fast"
    assert [visit["human"] for visit in found["visits"]] == ["fast", "slow"]
    assert {"transitions", "seen_in_visit", "policy"} <= set(found["visits"][0])
    assert found["trained"]["policy"]


def test_a_module_that_is_not_there(tiny_run):
    done = visitlab("affordances", tiny_run, "--agent", "chance")
    assert done.returncode == 5
    assert len(done.stderr.splitlines()) == 1
    assert visitlab("affordances", tiny_run, "--seed", "9").returncode == 5


def test_a_picture(tiny_run, tmp_path):
    picture = tmp_path / "folder" / "picture.png"
    done = visitlab("affordances", tiny_run, "--picture", picture)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{picture}\n", "")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_picture_of_another_kind(tiny_run, tmp_path):
    done = visitlab("affordances", tiny_run, "--picture", tmp_path / "picture.gif")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == f"--picture {tmp_path}/picture.gif: must end in .svg, .png, .pdf\n"
    assert not list(tmp_path.iterdir())


INTENTS = ("affordances", "--intents", "--threshold", 0.5, "--trials", 5)


def test_intents_as_a_table_and_as_json(tiny_run):
    command, *options = INTENTS
    done = visitlab(command, tiny_run, *options)
    assert done.returncode == 0, done.stderr
    assert "social/mb/fast, 1 seed\n" in done.stdout
    assert "k 0.5 " in done.stdout
    found = json.loads(visitlab(command, tiny_run, *options, "--json").stdout)
    assert found["trials"] == 5
    (module,) = found["modules"]
    assert [each["threshold"] for each in module["sets"]] == [None, None, 0.5]
    assert set(module["sets"][2]["affording"]) == {"faces", "nears", "advances", "leads", "keeps"}


def test_a_picture_of_intents_has_the_same_bytes_again(tiny_run, tmp_path):
    command, *options = INTENTS
    pictures = [tmp_path / "a.svg", tmp_path / "b.svg"]
    for picture in pictures:
        done = visitlab(command, tiny_run, *options, "--picture", picture)
        assert (done.returncode, done.stdout, done.stderr) == (0, f"{picture}\n", "")
    assert pictures[0].read_bytes() == pictures[1].read_bytes()


@pytest.mark.parametrize(
    ("options", "exit_code", "message"),
    [
        (("--threshold", 0.5), 2, "--threshold: goes with --intents only\n"),
        (("--trials", 5), 2, "--trials: goes with --intents only\n"),
        (("--intents", "--threshold", 0), 2, "--threshold 0: must be a probability above 0\n"),
        (("--intents", "--threshold", "nan"), 2, "--threshold nan: must be a probability above 0\n"),
        (("--intents", "--threshold", 1.5), 2, "--threshold 1.5: must be a probability above 0\n"),
        (("--intents", "--picture", "a.gif"), 2, "--picture a.gif: must end in .svg, .png, .pdf\n"),
        (("--intents", "--agent", "chance"), 5, None),
        (("--intents", "--seed", 9), 5, None),
    ],
)
def test_what_intents_refuse_is_one_line(tiny_run, options, exit_code, message):
    done = visitlab("affordances", tiny_run, *options)
    assert (done.returncode, done.stdout) == (exit_code, "")
    assert done.stderr == message if message else len(done.stderr.splitlines()) == 1
