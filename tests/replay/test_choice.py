"""Which log and which trial a user's words choose."""

import numpy as np
import pytest

from tests.program import TINY, the_run, visitlab
from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.log.reader import read_steps, read_trial
from visitlab_cli.plan.selection import Selection
from visitlab_cli.replay.choice import Log, Logs, choose_trial, find_logs
from visitlab_cli.storage.arrays import read_trials


@pytest.fixture
def find(tiny_run):
    return lambda *selection: find_logs(tiny_run.name[:6], tiny_run.parent, Selection(*selection))


@pytest.fixture(scope="session")
def social(tiny_run):
    return tiny_run / "social" / "script" / "fast" / "seed-0000" / "steps.mcap"


def chosen(file, word):
    return choose_trial(Logs((Log(file, str(file)),)), word).trial


def test_without_selection_the_first_visit(find, tiny_run):
    logs = find()
    assert [log.cell for log in logs.first] == ["visit/fast/seed-0000", "visit/slow/seed-0000"]
    assert [log.cell for log in logs.others] == ["visit_scripted/fast_pointing/seed-0000"]
    assert logs.first[0].path == tiny_run / "visit" / "fast" / "seed-0000" / "steps.mcap"
    found = choose_trial(logs, "3")
    assert (found.log, found.trial) == (logs.first[0], 3)
    assert found.note.startswith("chose visit/fast/seed-0000 of 3 cells; the next is visit/slow/seed-0000; --exp")


@pytest.mark.parametrize(
    ("selection", "cell"),
    [
        (("", "slow"), "visit/slow/seed-0000"),
        (("navigation", "", "watcher"), "navigation/watcher/seed-0000"),
        (("social", "", "script", 0), "social/script/fast/seed-0000"),
        (("", "", "rmax"), "navigation/rmax/seed-0000"),
        (("visit_scripted",), "visit_scripted/fast_pointing/seed-0000"),
    ],
)
def test_selection(find, selection, cell):
    assert find(*selection).first[0].cell == cell


def test_a_file(find_file, social):
    assert find_file(social) == Logs((Log(social, str(social)),))


@pytest.fixture
def find_file(tmp_path):
    return lambda file, *selection: find_logs(str(file), tmp_path, Selection(*selection))


@pytest.mark.parametrize(
    ("selection", "line"),
    [
        (("", "fats"), "{run}: no human fats; did you mean fast?"),
        (("vist",), "{run}: no experiment vist; did you mean visit?"),
        (("", "", "dyna"), "{run}: no agent dyna; known: chance, mb, mf, rmax, script, watcher"),
        (("visit", "", "", 7), "{run}: no seed 7; its seeds are 0 to 0"),
        (
            ("visit", "", "watcher"),
            "{run}: no cell with --experiment visit --agent watcher; there are navigation/mf/seed-0000, "
            "navigation/mb/seed-0000, navigation/rmax/seed-0000 and 14 more",
        ),
    ],
)
def test_no_such_cell(find, tiny_run, selection, line):
    with pytest.raises(NotFoundError) as error:
        find(*selection)
    assert str(error.value) == line.format(run=tiny_run)


def test_no_such_file_or_run(find_file, social, tmp_path):
    with pytest.raises(NotFoundError, match=r"^none\.mcap: no such file$"):
        find_file("none.mcap")
    with pytest.raises(NotFoundError, match=f"^none: no such run in {tmp_path}$"):
        find_file("none")
    with pytest.raises(UsageError) as error:
        find_file(social, "", "slow")
    assert str(error.value) == f"{social}: is one log; --human slow choose within a run"


def test_a_cell_that_is_not_done_and_one_without_a_log(tmp_path):
    done = visitlab("train", TINY, "record.steps=none", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    run = the_run(tmp_path)
    with pytest.raises(NotFoundError) as error:
        find_logs(str(run), tmp_path, Selection("visit", "slow"))
    assert str(error.value) == (
        f"{run}: not run yet: visit/slow/seed-0000; finish with visitlab run {run}/config.yaml --out {run.parent}"
    )
    with pytest.raises(NotFoundError) as error:
        find_logs(str(run), tmp_path, Selection("navigation", "", "mb"))
    assert str(error.value) == (
        f"{run}/navigation/mb/seed-0000: has no log, its config records no steps; run it with record.steps=every"
    )


def test_trials_by_reward(social):
    rewards = read_trials(social.with_name("trials.parquet"))["reward"]
    assert rewards.max() > rewards.min()
    assert chosen(social, "17") == 17
    assert chosen(social, "best") == np.flatnonzero(rewards == rewards.max())[0]
    assert chosen(social, "worst") == np.flatnonzero(rewards == rewards.min())[0]
    assert rewards[chosen(social, "median")] == np.sort(rewards)[(len(rewards) - 1) // 2]


def test_the_longest_engagement(social):
    longest = {}
    for trial in range(60):
        run = best = 0
        for level in read_trial(social, trial)["interaction_level"]:
            run = run + 1 if level >= 5 else 0
            best = max(best, run)
        longest[trial] = best
    assert max(longest.values()) > 3
    assert chosen(social, "longest-engagement") == max(longest, key=longest.get)


def test_trials_that_cannot_be_chosen(find, social, tmp_path):
    with pytest.raises(UsageError) as error:
        chosen(social, "bset")
    assert str(error.value) == "--trial bset: must be a number or one of best, worst, median, longest-engagement"
    with pytest.raises(UsageError, match="nobody is engaged in this task"):
        choose_trial(find("navigation"), "longest-engagement")
    broken = tmp_path / "broken.mcap"
    broken.write_bytes(social.read_bytes()[:-1000])
    with pytest.raises(RunError, match=f"^{broken}: "):
        chosen(broken, "best")
    assert len(read_steps(social)["step"]) == 60 * 21
