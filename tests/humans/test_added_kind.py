"""A kind of human that somebody adds to the program: one file, and all who read a config meet it."""

import csv
import json

import pytest

from tests.docs.config_page import entries, table
from tests.program import Clone, the_run
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.loading import load

KIND = '''"""A human that keeps time: it walks east at every so many steps of a trial, and never looks at anybody."""

from typing import ClassVar, Literal, NamedTuple

from pydantic import Field

from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.enums import Action, Engagement
from visitlab_cli.world.geometry import Geometry
from visitlab_cli.world.human import REACT
from visitlab_cli.world.lab import Lab
from visitlab_cli.world.robot import move_of, moved
from visitlab_cli.world.scene import Reaction, Scene, human_of, reaction


class Clockwork(NamedTuple):
    every: int


class ClockworkParameters(HumanParameters):
    """Walks by the clock."""

    remembers: ClassVar[bool] = True

    kind: Literal["clockwork"]
    every: int = Field(default=3, ge=1, le=100, description="steps between two of its own")

    def create(self) -> Clockwork:
        return Clockwork(self.every)


@REACT.of(Clockwork)
def react(human: Clockwork, lab: Lab, geometry: Geometry, scene: Scene, action: int, random: RandomState) -> Reaction:
    memory = scene.human_memory + 1
    body, walk = human_of(scene), Action.STAY.value
    if memory % human.every == 0:
        walk = move_of(0, 1)
        body = moved(lab, body, walk, scene.open_doors)
    return reaction(body.row, body.col, body.heading, Engagement.NONE.value, walk, memory)
'''
CONFIG = """name: timed
humans:
  one: {kind: clockwork, every: 4}
  other: {like: one, every: 7}
  usual: {p_S: [1, 0, 0]}
agents:
  mb: {kind: model_based}
experiments:
  social: {task: social, agents: [mb], humans: [one, other, usual], steps: 80, trial_steps: 20}
  near: {task: go_to_human, agents: [mb], steps: 20}
  way: {task: navigation, agents: [mb], steps: 20}
  visit:
    task: visit
    modules: {navigation: way/mb, go_to_human: near/mb, social: social/mb/one}
    humans: [one, other]
    trials: 2
    trial_steps: 20
"""
MIXED = """name: mixed
humans: {clock: {kind: clockwork}, usual: {p_S: [1, 0, 0]}}
agents: {mb: {kind: model_based}}
experiments: {social: {task: social, agents: [mb], humans: [clock, usual], steps: 20}}
"""


@pytest.fixture
def program(tmp_path):
    """A clone to which the kind was added."""
    (tmp_path / "timed.yaml").write_text(CONFIG)
    (tmp_path / "mixed.yaml").write_text(MIXED)
    return Clone(tmp_path, {"humans/clockwork.py": KIND})


def walks(program, run, human):
    """The steps of its third trial at which a human walked."""
    told = program("steps", run, "--experiment", "social", "--human", human, "--trial", "2", "--json")
    assert told.returncode == 0, told.stderr
    return [row["step"] for row in json.loads(told.stdout)["steps"] if row["human_action"] == "MOVE_1_EAST"]


def memory(program, run, human):
    """What a human remembered after each step of its third trial, None where that is not logged."""
    told = program("steps", run, "--experiment", "social", "--human", human, "--trial", "2", "--json")
    rows = json.loads(told.stdout)["steps"]
    return [row["human_memory"] for row in rows] if "human_memory" in rows[0] else None


@pytest.mark.slow
def test_it_is_trained_visited_recorded_and_replayed_by_its_memory(program, tmp_path):
    done = program("run", "timed.yaml", "--workers", 2)
    assert done.returncode == 0, done.stderr
    run = the_run(tmp_path / "runs")
    assert walks(program, run, "one") == [4, 8, 12, 16, 20]
    assert walks(program, run, "other") == [7, 14]
    for command in (
        ["runs", "verify", run],
        ["affordances", run, "--json"],
        ["report", run],
        ["compare", run, "--by", "human"],
    ):
        told = program(*command)
        assert (told.returncode, told.stderr) == (0, ""), command
    remembered = {human: memory(program, run, human) for human in ("one", "other", "usual")}
    assert remembered == {"one": list(range(21)), "other": list(range(21)), "usual": None}
    table = program("export", run, "--csv", "--table", "steps", "--experiment", "social", "--output", "steps.csv")
    assert table.returncode == 0, table.stderr
    with (tmp_path / "steps.csv").open() as file:
        logged = [(row["human"] == "usual", row["human_memory"], row["step"]) for row in csv.DictReader(file)]
    assert all(memory == ("" if is_usual else step) for is_usual, memory, step in logged)
    visited = program("steps", run, "--experiment", "visit", "--human", "other", "--json")
    assert "MOVE_1_EAST" in {row["human_action"] for row in json.loads(visited.stdout)["steps"]}


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("humans.clock.kind=clockwrk", "humans.clock.kind: no such kind: 'clockwrk'; did you mean clockwork?"),
        ("humans.clock.every=0", "humans.clock.every: must be at least 1 (got 0)"),
        ("humans.clock.evry=2", "humans.clock.evry: unknown; did you mean every?"),
        ("humans.usual.p_s=[1, 0, 0]", "humans.usual.p_s: unknown; did you mean p_S?"),
        ("humans.usual.p_H=2", "humans.usual.p_H: must be at most 1 (got 2)"),
        ("humans.usual=3", "humans.usual: must be a mapping (got 3)"),
        ("humans.more={like: usual, kind: clockwork}", "humans.more.kind: must be that of usual, which it is like"),
        ("vary={humans.clock.every: [1, x]}", "must be a whole number (got 'x')"),
    ],
)
def test_what_is_wrong_with_one_is_told_as_of_any_other(program, override, told):
    refused = program("validate", "mixed.yaml", override)
    assert refused.returncode == 3
    assert told in refused.stderr


HIDDEN = """name: hidden
humans: {clock: {kind: clockwork}, usual: {p_S: [1, 0, 0]}}
agents: {mb: {kind: model_based}}
experiments:
  way: {task: navigation, agents: [mb], steps: 20}
  near: {task: go_to_human, agents: [mb], steps: 20}
  humans: {task: social, agents: [mb], humans: [usual, clock], steps: 20, BELIEF}
  phases: {task: social, agents: [mb], phases: [{steps: 20, human: usual}, {steps: 20, human: clock}], BELIEF}
  visit:
    task: visit
    modules: {navigation: way/mb, go_to_human: near/mb, social: humans/mb/usual}
    phases: [{trials: 2, human: clock}, {trials: 2, human: usual}]
    observe: geometry
    belief: {parameters: given}
"""


def test_a_belief_is_not_given_the_parameters_of_one_that_has_others(program, tmp_path):
    text = HIDDEN.replace("BELIEF", "observe: geometry, belief: {parameters: given}")
    (tmp_path / "hidden.yaml").write_text(text)
    refused = program("run", "hidden.yaml")
    assert (refused.returncode, refused.stdout) == (3, "")
    why = "no belief is given the parameters of this kind of human, which are not the paper's; say parameters: em"
    told = [line.split(" experiments.")[1] for line in refused.stderr.splitlines()]
    assert told == [f"{place}: {why}" for place in ("humans.humans.1", "phases.phases.1.human", "visit.phases.0.human")]
    (tmp_path / "hidden.yaml").write_text(text.replace("given", "em"))
    assert program("validate", "hidden.yaml").returncode == 0


def test_it_is_listed_with_its_settings_and_the_papers_stays_as_it_was(program, tmp_path):
    schema = json.loads(program("schema").stdout)
    pages = [
        (entry["description"], table(entry, schema["$defs"]))
        for entry in entries(schema["properties"]["humans"], schema["$defs"])
    ]
    assert len(pages) == 2
    (page,) = [page for told, page in pages if told == "Walks by the clock."]
    assert "| `every` | whole number, 1 to 100 | 3 | steps between two of its own |" in page
    shown = program("validate", "mixed.yaml", "--show").stdout
    assert "clock: {kind: clockwork, every: 3}" in shown
    assert "  usual:\n    p_S: [1.0, 0.0, 0.0]\n    p_H: 0.0" in shown
    ours = MIXED.replace("clock: {kind: clockwork}, ", "").replace("clock, ", "")
    (tmp_path / "ours.yaml").write_text(ours)
    planned = program("run", "ours.yaml", "--dry-run", "--json")
    assert f"ours-{config_hash(load(tmp_path / 'ours.yaml'))}".partition("-")[2] in planned.stdout
