"""`start_from`: what may stand there, what is refused and where, and that configs without it stay as they were."""

from pathlib import Path

import pytest

from tests.config.lab import LAB, Complain, Load, edited
from tests.program import TINY
from visitlab_cli.config.canonical import canonical, config_hash, dump_yaml
from visitlab_cli.config.loading import load

ON = "  on: {task: social, agents: [mb], humans: [human_1], steps: 100, start_from: social/mb/human_2}\n"
STARTED = LAB + ON
HASHES = {"quickstart": "621f9df4", "paper": "c7c38838", TINY: "54e75efa"}


def started(old: str, new: str) -> str:
    return edited(old, new, STARTED)


@pytest.mark.parametrize(("name", "digest"), HASHES.items(), ids=map(str, HASHES))
def test_a_config_without_it_keeps_its_hash(name: str | Path, digest: str) -> None:
    config = load(name)
    assert config_hash(config) == digest
    assert "start_from" not in dump_yaml(config)


def test_it_is_kept_and_hashed(loaded: Load) -> None:
    config = loaded(STARTED)
    assert canonical(config)["experiments"]["on"]["start_from"] == "social/mb/human_2"
    assert loaded(dump_yaml(config)) == config
    from_nothing = loaded(started(", start_from: social/mb/human_2", ""))
    from_another = loaded(started("start_from: social/mb/human_2", "start_from: social/mb/human_1"))
    assert len({config_hash(each) for each in (config, from_nothing, from_another)}) == 3


def test_it_may_vary(loaded: Load) -> None:
    config = loaded(STARTED + "vary: {experiments.on.start_from: [social/mb/human_1, social/mb/human_2]}\n")
    assert config.vary == {"experiments.on.start_from": ("social/mb/human_1", "social/mb/human_2")}


def test_another_agent_of_the_same_kind_may_go_on(loaded: Load) -> None:
    text = edited("  mf: {kind: q_learning}\n", "  mf: {kind: q_learning}\n  bold: {like: mb, epsilon: 0.2}\n", STARTED)
    config = loaded(
        edited("agents: [mb], humans: [human_1], steps: 100, s", "agents: [bold], humans: [human_1], s", text)
    )
    assert config.experiments["on"].start_from == "social/mb/human_2"


WRONG = [
    ("social/mb/human_2", "socail/mb/human_2", "no experiment is called socail; did you mean social?"),
    ("social/mb/human_2", "navigation/rmax", "navigation has the task navigation; needed is social; known: social, on"),
    ("social/mb/human_2", "social/mbb/human_2", "social does not train mbb; did you mean mb?"),
    ("social/mb/human_2", "social/mb/human_3", "social does not train with human_3; did you mean human_2?"),
    ("social/mb/human_2", "social/mb", "say with which human: social/mb/human_1 or social/mb/human_2"),
    (
        "social/mb/human_2",
        "social/mf/human_2",
        "mf is of kind q_learning; mb, of kind model_based, can't go on from it",
    ),
    ("social/mb/human_2", "on/mb/human_1", "goes round in a circle: on -> on"),
    ("social/mb/human_2", "on/mb", "say with which human: on/mb/human_1"),
    ("social/mb/human_2", "human_2", "a module is experiment/agent or experiment/agent/human (got 'human_2')"),
    ("social/mb/human_2", "7", "must be text (got 7; put it in quotes)"),
    ("social/mb/human_2", "~", "must be experiment/agent/human; leave it out to start with nothing learned"),
]


@pytest.mark.parametrize(("old", "new", "message"), WRONG, ids=[new for _, new, _ in WRONG])
def test_what_is_wrong_is_told_at_its_place(complaint: Complain, old: str, new: str, message: str) -> None:
    line = STARTED.count("\n")
    column = ON.index("social/mb") + 1
    told = complaint(started(f"start_from: {old}", f"start_from: {new}"))
    assert f"lab.yaml:{line}:{column}: experiments.on.start_from: {message}" in told
    assert all("experiments.on.start_from: " in each for each in told)


def test_a_circle_is_told_of_those_in_it(complaint: Complain) -> None:
    other = ON.replace("  on:", "  off:").replace("social/mb/human_2", "on/mb/human_1")
    third = ON.replace("  on:", "  beside:").replace("social/mb/human_2", "on/mb/human_1")
    text = LAB + ON.replace("social/mb/human_2", "off/mb/human_1") + other + third
    assert [line.split(": ", 1)[1] for line in complaint(text)] == [
        "experiments.on.start_from: goes round in a circle: on -> off -> on",
        "experiments.off.start_from: goes round in a circle: off -> on -> off",
    ]


@pytest.mark.parametrize("task", ["navigation", "go_to_human"])
def test_other_tasks_have_no_such_setting(complaint: Complain, task: str) -> None:
    (line,) = complaint(edited(f"{task}: {{task: {task},", f"{task}: {{task: {task}, start_from: social/mb/human_1,"))
    assert f"experiments.{task}.start_from: unknown; known: " in line


def test_the_start_must_be_of_a_training_that_is_right_itself(complaint: Complain) -> None:
    told = complaint(edited("humans: [human_1, human_2], steps: 100", "humans: [human_1, human_2], steps: 7", STARTED))
    assert len(told) == 1
    assert "experiments.social.steps" in told[0]
