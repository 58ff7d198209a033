"""Phases as a config says them: what they stand in place of is left out, and each mistake has its line."""

import pytest

from tests.config.lab import LAB, Complain
from visitlab_cli.config.canonical import canonical, config_hash, dump_yaml
from visitlab_cli.config.loading import load_text
from visitlab_cli.plan.cells import plan

SOCIAL, VISIT = "humans: [human_1, human_2], steps: 100", "humans: [human_2]"
OTHERS = "phases: [{steps: 100, human: human_2}, {trials: 5, human: human_1, plan_every: 10}]"
IN_TURN = "phases: [{trials: 30, human: human_2}, {trials: 20, human: human_1}]"
PHASED = LAB.replace(SOCIAL, OTHERS).replace(VISIT, IN_TURN).replace("social/mb/human_2", "social/mb")


def test_a_config_with_phases_is_written_as_it_is_read() -> None:
    config = load_text(PHASED, "lab.yaml")
    plain = canonical(config)["experiments"]
    assert plain["social"]["phases"] == [
        {"steps": 100, "human": "human_2"},
        {"trials": 5, "plan_every": 10, "human": "human_1"},
    ]
    assert not {"humans", "steps"} & plain["social"].keys()
    assert not {"humans", "trials"} & plain["visit"].keys()
    assert "phases" not in plain["navigation"]
    again = load_text(dump_yaml(config), "again.yaml")
    assert again == config
    assert config_hash(again) == config_hash(config) != config_hash(load_text(LAB, "lab.yaml"))


def test_lengths_paths_and_what_each_result_depends_on() -> None:
    cells = {cell.group: cell for cell in plan(load_text(PHASED, "lab.yaml"))}
    assert (cells["social/mb/phases"].trials, cells["social/mb/phases"].steps) == (10, 200)
    assert (cells["visit/phases"].trials, cells["visit/phases"].steps) == (50, 5000)
    assert cells["visit/phases"].modules["social"] == "social/mb/phases/seed-0000"
    varied = load_text(PHASED + "vary: {humans.human_1.p_M: [0.1, 0.2]}\n", "lab.yaml")
    groups = {cell.group for cell in plan(varied)}
    assert {"visit/phases/humans.human_1.p_M=0.1", "visit/phases/humans.human_1.p_M=0.2"} <= groups
    sequences = "vary: {experiments.visit.phases: [[{trials: 3, human: human_1}], [{trials: 4, human: human_2}]]}\n"
    trials = [cell.trials for cell in plan(load_text(PHASED + sequences, "lab.yaml")) if cell.settings.assembled]
    assert trials == [3, 4]


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (VISIT, f"{VISIT}\n    {IN_TURN}", "18:5: experiments.visit.humans: stands in the phases; leave it out"),
        (VISIT, f"{IN_TURN}\n    trials: 5", "19:5: experiments.visit.trials: stands in the phases; leave it out"),
        (SOCIAL, f"{OTHERS}, steps: 20", "14:129: experiments.social.steps: stands in the phases; leave it out"),
        (VISIT, "phases: []", "18:13: experiments.visit.phases: must have at least 1 entry (got 0)"),
        (VISIT, "trials: 5", "15:3: experiments.visit.humans: missing"),
        (VISIT, "phases: [{trials: 5}]", "18:14: experiments.visit.phases.0.human: missing"),
        (
            VISIT,
            "phases: [{trials: 5, human: human_3}]",
            "18:33: experiments.visit.phases.0.human: no human is called human_3; did you mean human_2?",
        ),
        (
            VISIT,
            "phases: [{steps: 500, trials: 5, human: human_2}]",
            "18:15: experiments.visit.phases.0.steps: unknown; known: doors, human, lab, plan_every, trials",
        ),
        (
            SOCIAL,
            "phases: [{human: human_2}]",
            "14:53: experiments.social.phases.0: must have steps or trials, one of the two",
        ),
        (
            SOCIAL,
            "phases: [{steps: 100, trials: 5, human: human_2}]",
            "14:53: experiments.social.phases.0: must have steps or trials, one of the two",
        ),
        (
            SOCIAL,
            "phases: [{steps: 110, human: human_2}]",
            "14:61: experiments.social.phases.0.steps: must be a whole number of trials of 20 steps (got 110)",
        ),
        (
            SOCIAL,
            "phases: [{steps: null, human: human_2}]",
            "14:61: experiments.social.phases.0.steps: must be a whole number (got nothing)",
        ),
        (
            "agents: [mb], steps: 100",
            "agents: [mb], phases: [{trials: 3, human: human_2}]",
            "13:71: experiments.go_to_human.phases.0.human: unknown; known: doors, lab, plan_every, steps, trials",
        ),
        (
            "[rmax, mf], steps: 100",
            "[mf], phases: [{trials: 3, plan_every: 5}]",
            "12:69: experiments.navigation.phases.0.plan_every: means nothing here: no agent that acts here plans; "
            "leave it out",
        ),
    ],
)
def test_each_mistake_has_its_line(old: str, new: str, line: str, complaint: Complain) -> None:
    text = LAB.replace("navigation/rmax", "navigation/mf") if "[rmax" in old else LAB
    if old == SOCIAL:
        text = text.replace("social/mb/human_2", "social/mb")
    assert text.count(old) == 1
    assert complaint(text.replace(old, new)) == [f"lab.yaml:{line}"]


def test_a_human_may_not_be_called_as_phases_are(complaint: Complain) -> None:
    text = PHASED.replace("human_2", "phases")
    assert complaint(text) == [
        "lab.yaml:4:3: humans.phases: is what is said where humans are met in turn; choose another name"
    ]
    load_text(LAB.replace("human_2", "phases"), "lab.yaml")  # where nothing has phases it may


def test_a_reference_to_a_training_with_phases_names_no_human(complaint: Complain) -> None:
    assert complaint(PHASED.replace("social: social/mb}", "social: social/mb/human_2}")) == [
        "lab.yaml:17:81: experiments.visit.modules.social: social does not train with human_2; known: phases"
    ]
