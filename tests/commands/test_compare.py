"""`visitlab compare`, end to end, on runs whose trials are made up."""

import json

import pytest

from tests.commands.test_runs import tell
from tests.paper.made_runs import make_run
from tests.program import visitlab
from tests.results.runs_by_hand import open_lab, reach

VISIT, NAVIGATION = "visit/human_1", "navigation/rmax"


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    out = tmp_path_factory.mktemp("runs")
    make_run(out, {NAVIGATION: 0.0, VISIT: 2.0}, name="main")
    make_run(out, {VISIT: 0.0}, name="variant", planner="restart")
    return out


def test_compare_prints_verdicts_and_the_cause(runs):
    done = visitlab("compare", "main", "--out", runs)
    assert done.returncode == 0, done.stderr
    navigation, visit = done.stdout.splitlines()[1:3]
    assert "agrees" in navigation
    assert "differs" in visit
    assert "visit.planner_rewards: restart (not carried)" in done.stdout


def test_compare_as_json(runs):
    found = json.loads(visitlab("compare", "main", "--out", runs, "--json", "--margin", "3").stdout)
    assert found["margin"] == 3
    assert [(curve["group"], curve["verdict"]) for curve in found["curves"]] == [
        (NAVIGATION, "agrees"),
        (VISIT, "agrees"),
    ]
    assert set(found["curves"][0]["parts"]) == {"first_tenth", "middle_tenth", "last_tenth", "whole"}
    assert {"figure": "fig8_humans", "condition": "human_1", "group": "social_humans/mb/human_1"}.items() <= (
        next(each for each in found["not_compared"] if each["figure"] == "fig8_humans").items()
    )


def test_a_variant_from_elsewhere(runs, tmp_path):
    run = make_run(tmp_path, {VISIT: 2.0}, name="alone")
    (variant,) = runs.glob("variant-*")
    alone = json.loads(visitlab("compare", run, "--json").stdout)["curves"][0]
    assert alone["cause"] == "unexplained"
    explained = json.loads(visitlab("compare", run, "--variant", variant, "--json").stdout)["curves"][0]
    assert explained["cause"].startswith(variant.name)


def test_a_run_without_published_curves(tiny_run):
    done = visitlab("compare", tiny_run)
    assert done.returncode == 5
    assert len(done.stderr.splitlines()) == 1


def test_what_is_not_as_published_is_not_judged_and_said(tmp_path):
    run = make_run(tmp_path, {NAVIGATION: 0.0, VISIT: 0.0}, planner="restart")
    told = "not compared: not as published: visit.planner_rewards restart, published carried: visit/human_1"
    done = visitlab("compare", run)
    assert done.returncode == 0, done.stderr
    assert told in done.stdout.splitlines()
    found = json.loads(visitlab("compare", run, "--json").stdout)
    assert [curve["group"] for curve in found["curves"]] == [NAVIGATION]
    page = tmp_path / "page.md"
    assert visitlab("compare", run, "--page", page).returncode == 0
    name = "Fig. 8 right, visit the lab: Human 1"
    assert f"- {name}: not as published: visit.planner_rewards restart, published carried" in page.read_text()
    assert f"| {name} |" not in page.read_text()


def test_visits_of_one_model_are_said_to_be_one(tmp_path):
    out = visitlab("compare", make_run(tmp_path, {VISIT: 0.0}, models="first")).stdout
    assert "1 model, 10 visits" in out
    assert "fig8_adaptation human_1: one model has no interval; more are needed" in out
    assert "Visits of the same trained modules count as one" in out


def test_wrong_words(runs):
    assert visitlab("compare", "nothing", "--out", runs).returncode == 5
    assert visitlab("compare", "main", "--out", runs, "--margin", "nan").returncode == 2
    assert visitlab("compare", "main", "--out", runs, "--variant", "nothing").returncode == 5


MODULES = "modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}"
PHASES = "phases: [{trials: 2, human: slow}, {trials: 3, human: fast}]"
VISITS = f"""
  swap: {{task: visit, {MODULES}, {PHASES}}}
  swap_none: {{task: visit, social_reward: none, {MODULES}, {PHASES}}}
  visit_none: {{task: visit, social_reward: none, {MODULES}, humans: [slow], trials: 20, trial_steps: 10}}
"""


@pytest.mark.parametrize(
    ("visits", "words"),
    [
        (["visit/slow", "visit_none/slow"], "Last tenth of trials; the second"),
        (["swap/phases", "swap_none/phases"], "All trials of each phase; the second"),
        (
            ["visit/slow", "visit_none/slow", "swap/phases", "swap_none/phases"],
            "Last tenth of trials, of a phase all of them; the second",
        ),
    ],
)
def test_which_trials_count_is_one_sentence(tmp_path, visits, words):
    run, cells = open_lab(tmp_path, seeds=1, more=VISITS)
    reach(run, cells, {f"{visit}/seed-0000": 1.0 for visit in visits})
    code, out, _ = tell("compare", run, "--by", "experiment")
    assert code == 0
    assert f"\n{words} less the first" in out
