"""`plugin check`: our own agents keep what agents promise, and each promise that is broken is seen."""

import json
from pathlib import Path

import numpy as np
import pytest

import visitlab_cli
from tests.agents.plain_q import PlainQ, PlainQParameters
from tests.program import visitlab
from visitlab_cli.agents.q_learning import QLearningParameters
from visitlab_cli.agents.registry import KINDS
from visitlab_cli.authoring.check import check
from visitlab_cli.authoring.kinds import agent_of

FILE = Path(__file__).parents[1] / "agents" / "plain_q.py"
ALONE = sorted(word for word, kind in KINDS.items() if not kind.references)


@pytest.mark.parametrize("kind", ALONE)
def test_every_built_in_agent_keeps_what_agents_promise(kind):
    answers = visitlab_cli.check_agent(kind)
    assert [answer for answer in answers if not answer.passed] == []
    assert {answer.task for answer in answers} >= set(KINDS[kind].tasks)
    assert (answers[-1].asked == "learns the chain of two states") == KINDS[kind].learns


def illegal(self, state, random, step):
    return 25 if step == 77 else 0


def unrepeatable(self, state, random, step):
    return int(np.random.default_rng().integers(2))


def forgetful(self, arrays):
    pass


def undecided(self, state):
    return int(np.random.default_rng().integers(2))


def not_a_number(self):
    return {"q": self.q * np.nan}


def growing(self):
    return {"q": self.q, f"extra_{int(self.q.sum() > 0)}": self.q}


def deaf(self, state, action, reward, next_state, end, random, step):
    pass


def learning_when_asked(self, state):
    self.q[state] += 1
    return 0


BROKEN = {
    "act illegal": (
        "act",
        illegal,
        "acts and learns",
        "step 17: ValueError: act answered 25, but actions go from 0 to 24",
    ),
    "act unrepeatable": ("act", unrepeatable, "does the same again", "the first time and"),
    "restore": ("restore", forgetful, "goes on where it stopped", "the second"),
    "greedy": ("greedy", undecided, "is greedy, and learns nothing", "the first time and"),
    "greedy learns": ("greedy", learning_when_asked, "is greedy, and learns nothing", "array q is another"),
    "arrays NaN": ("arrays", not_a_number, "does the same again", "its array q holds what is no number"),
    "arrays grow": ("arrays", growing, "what it saves survives", "has no array"),
    "learn": ("learn", deaf, "learns the chain", "the better action in"),
}


@pytest.mark.parametrize(("method", "instead", "asked", "seen"), BROKEN.values(), ids=BROKEN)
def test_a_broken_promise_is_seen_where_it_is_broken(monkeypatch, method, instead, asked, seen):
    if method == "arrays":
        monkeypatch.delattr(PlainQ, "values")  # which would be saved beside them, as q
    if method == "greedy":  # which act asks, too
        monkeypatch.setattr(PlainQ, "act", lambda self, state, random, step: int(self.q[state].argmax()))
    monkeypatch.setattr(PlainQ, method, instead)
    *passed, failed = check(PlainQParameters(kind="plain_q"))
    assert all(answer.passed for answer in passed)
    assert not failed.passed
    assert failed.asked.startswith(asked), failed
    assert seen in failed.seen, failed


class Diverged(QLearningParameters):
    def save(self, record):
        return {"q": record.q * np.nan}


def test_nan_in_a_compiled_agent_is_told_as_that():
    *_, failed = check(Diverged(kind="q_learning"))
    assert (failed.passed, failed.seen) == (False, "its array q holds what is no number")


def test_the_command_tells_what_it_asked_and_what_failed(tmp_path):
    done = visitlab("plugin", "check", "plain_q", "alpha=0.25", "--plugin", FILE)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.endswith("\nplain_q: passed\n")
    done = visitlab("plugin", "check", "plain_q", "wrong_at=30", "--plugin", FILE, "--json")
    told = json.loads(done.stdout)
    assert (done.returncode, told["passed"], len(told["answers"])) == (4, False, 1)
    line = (
        "its agent (kind plain_q) failed in trial 1, step 10: ValueError: act answered 25, but actions go from 0 to 24"
    )
    assert done.stderr == f"plain_q: acts and learns for 2,000 steps, navigation: {line}\n"


@pytest.mark.parametrize(
    ("words", "code", "line"),
    [
        (["nobodys"], 5, "no kind of agents is called nobodys here; install its package, or name its file by --plugin"),
        (["observer"], 2, "observer: refers to other agents (watches, learner, acts_as)"),
        (["q_learning", "alpha"], 2, "alpha: must be key=value"),
        (["q_learning", "alpha=[1"], 2, "alpha=[1: the value is no YAML"),
        (["q_learning", "kind=rmax"], 2, "kind=rmax: the kind is said before, without kind="),
        (["q_learning", "alpha=2"], 3, "alpha=2: must be at most 1 (got 2)"),
        (["q_learning", "aplha=0.2"], 3, "aplha=0.2: unknown; did you mean alpha?"),
        (["model_based", "bonus=1"], 3, "model_based: exploration: count_bonus goes with a bonus, and only that does"),
    ],
)
def test_what_can_not_be_checked_is_one_line(words, code, line):
    done = visitlab("plugin", "check", *words)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (code, "", 1)
    assert done.stderr.startswith(line)


def test_with_settings_that_some_tasks_do_not_take_it_is_checked_in_the_others():
    assert agent_of("q_learning", ["symmetric=true"]).playable == ("social", "visit")
