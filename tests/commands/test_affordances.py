"""`visitlab affordances`, end to end."""

import json

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
