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
