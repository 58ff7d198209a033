"""Which trial a user's words choose among several cells: over all seeds, and where something varies."""

import pytest

from tests.program import TINY, the_run, visitlab
from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.plan.selection import Selection
from visitlab_cli.replay.choice import choose_trial, find_logs
from visitlab_cli.storage.arrays import read_trials


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A run in which three seeds of two agents recorded one trial in three."""
    out = tmp_path_factory.mktemp("several")
    social = "experiments={social: {task: social, agents: [mf, mb], humans: [fast], steps: 1200}}"
    overrides = [social, "seeds=3", "record.steps={one_trial_in: 3}", "vary={agents.mf.alpha: [0.2, 0.5]}"]
    done = visitlab("train", TINY, *overrides, "--out", out, "-q")
    assert done.returncode == 0, done.stderr
    return the_run(out)


@pytest.fixture
def choose(run):
    return lambda word, **wanted: choose_trial(find_logs(str(run), run.parent, Selection("social", **wanted)), word)


def recorded(run, agent, at=""):
    """The reward of each recorded trial, by its cell and number."""
    folders = sorted(run.glob(f"social/{agent}/fast/{at}seed-*"))
    assert len(folders) == 3
    return {
        (str(folder.relative_to(run)), number): float(reward)
        for folder in folders
        for number, reward in enumerate(read_trials(folder / "trials.parquet")["reward"])
        if number % 3 == 0
    }


@pytest.mark.parametrize(("word", "best"), [("best", max), ("worst", min)])
def test_a_selector_looks_at_all_seeds(run, choose, word, best):
    found, rewards = choose(word, agent="mb"), recorded(run, "mb")
    assert (found.log.cell, found.trial) == best(rewards, key=rewards.get)
    ties = list(rewards.values()).count(rewards[found.log.cell, found.trial])
    equals = f", one of {ties} with the same reward" if ties > 1 else ""
    assert found.note == f"the {word} trial of 3 cells is {found.log.cell}, trial {found.trial}{equals}"
    by_file = choose_trial(find_logs(str(found.log.path), run.parent, Selection()), word)
    assert by_file.trial == found.trial


def test_the_median_is_that_of_all_seeds(run, choose):
    found, rewards = choose("median", agent="mb"), recorded(run, "mb")
    assert rewards[found.log.cell, found.trial] == sorted(rewards.values())[(len(rewards) - 1) // 2]


def test_the_longest_engagement_is_that_of_one_seed(choose):
    each = [choose("longest-engagement", agent="mb", seed=seed) for seed in range(3)]
    found = choose("longest-engagement", agent="mb")
    assert (found.log, found.trial) in [(one.log, one.trial) for one in each]


def test_what_varies_chooses(run, choose):
    at = "agents.mf.alpha=0.5"
    found, rewards = choose("worst", agent="mf", at=("agents.mf.alpha=.50",)), recorded(run, "mf", f"{at}/")
    assert (found.log.cell, found.trial) == min(rewards, key=rewards.get)
    assert choose("0", agent="mb", at=(at,)).log.cell == "social/mb/fast/seed-0000"  # there at every alpha


@pytest.mark.parametrize(
    ("at", "error", "line"),
    [
        ("agents.mf.alpha", UsageError, "--at agents.mf.alpha: must be PATH=VALUE, such as agents.mb.epsilon=0.1"),
        (
            "agents.mf.alpa=1",
            NotFoundError,
            "--at agents.mf.alpa: does not vary in {run}; did you mean agents.mf.alpha?",
        ),
        ("agents.mf.alpha=0.7", NotFoundError, "{run}: never at agents.mf.alpha=0.7; known: 0.2, 0.5"),
    ],
)
def test_a_value_at_which_nothing_is(run, choose, at, error, line):
    with pytest.raises(error) as told:
        choose("0", at=(at,))
    assert str(told.value) == line.format(run=run)
