"""Broken configs, each with its exact message."""

import json
import re
from collections.abc import Iterator
from typing import Any

import pytest
from pydantic import ValidationError

from tests.config.lab import LAB, Complain, Load, edited
from visitlab_cli.config.canonical import canonical
from visitlab_cli.config.messages import issues_of
from visitlab_cli.config.model import Config

NAME_RULE = "a name has 1 to 64 of A-Z a-z 0-9 . _ - and starts with a letter or digit"
TOP_KEYS = "agents, expected, experiments, figure, humans, include, interaction, labs, name, record, seed, seeds, vary"

ONE_LINE = [
    # humans
    ("p_M: 0.1", "p_M: 1.5", "3:34: humans.human_1.p_M: must be at most 1 (got 1.5)"),
    ("p_M: 0.1", "p_M: -1", "3:34: humans.human_1.p_M: must be at least 0 (got -1)"),
    ("p_M: 0.1", "p_m: 0.1", "3:29: humans.human_1.p_m: unknown; did you mean p_M?"),
    (
        "p_M: 0.1",
        "zz: 0.1",
        "3:29: humans.human_1.zz: unknown; known: like, p_A, p_H, p_M, p_O, p_P, p_S",
    ),
    ("p_M: 0.1", "p_M: .nan", "3:34: humans.human_1.p_M: must be a finite number (got nan)"),
    ("p_M: 0.1", "p_M: 1e400", "3:34: humans.human_1.p_M: must be a finite number (got inf)"),
    ("p_M: 0.1", "p_M: yes", "3:34: humans.human_1.p_M: must be a number (got 'yes')"),
    ("p_M: 0.1", "p_M: true", "3:34: humans.human_1.p_M: must be a number (got true)"),
    ("p_M: 0.1", "p_M: 1_0", "3:34: humans.human_1.p_M: must be a number (got '1_0')"),
    ("p_M: 0.1", "p_M: '0.1'", "3:34: humans.human_1.p_M: must be a number (got '0.1')"),
    ("p_M: 0.1", "p_M: [1]", "3:34: humans.human_1.p_M: must be a number (got a list)"),
    ("p_M: 0.1", "p_M: ~", "3:34: humans.human_1.p_M: must be a number (got nothing; left out it is 0.0)"),
    ("p_S: [1, 0, 0], ", "", "3:3: humans.human_1.p_S: missing"),
    ("[1, 0, 0]", "[1, 0]", "3:18: humans.human_1.p_S: must have at least 3 entries (got 2)"),
    ("[1, 0, 0]", "[1, 0, 0, 0]", "3:18: humans.human_1.p_S: must have at most 3 entries (got 4)"),
    ("[1, 0, 0]", "[1, 0, 0.1]", "3:18: humans.human_1.p_S: must sum to 1 (sums to 1.1)"),
    ("[1, 0, 0]", "[1, 0, 7]", "3:25: humans.human_1.p_S.2: must be at most 1 (got 7)"),
    ("[1, 0, 0]", "1", "3:18: humans.human_1.p_S: must be a list (got 1)"),
    # the top
    ("name: lab", "name: ../x", f"1:7: name: {NAME_RULE} (got '../x')"),
    ("name: lab", "name: /abs", f"1:7: name: {NAME_RULE} (got '/abs')"),
    ("name: lab", "name: a/b", f"1:7: name: {NAME_RULE} (got 'a/b')"),
    ("name: lab", "name: ..", f"1:7: name: {NAME_RULE} (got '..')"),
    ("name: lab", "name: -x", f"1:7: name: {NAME_RULE} (got '-x')"),
    ("name: lab", "name: <script>", f"1:7: name: {NAME_RULE} (got '<script>')"),
    ("name: lab", "name: '=cmd'", f"1:7: name: {NAME_RULE} (got '=cmd')"),
    ("name: lab", 'name: "a\\0b"', f"1:7: name: {NAME_RULE} (got 'a\\x00b')"),
    ("name: lab", 'name: "lab\\n"', f"1:7: name: {NAME_RULE} (got 'lab\\n')"),
    ("name: lab", f"name: {'a' * 300}", f"1:7: name: {NAME_RULE} (got '{'a' * 59}...)"),
    ("name: lab", "name: latest", "1:7: name: latest stands for a run, whatever its name; choose another"),
    ("name: lab", "name: LaTeST", "1:7: name: latest stands for a run, whatever its name; choose another"),
    ("name: lab", "name: a.MCAP", "1:7: name: what ends in .mcap stands for a log; choose another"),
    ("name: lab", "name: 007", "1:7: name: must be text (got 7; put it in quotes)"),
    ("name: lab\n", "", "1:1: name: missing"),
    ("name: lab", "name: lab\nseeds: 0", "2:8: seeds: must be at least 1 (got 0)"),
    ("name: lab", "name: lab\nseeds: 1.5", "2:8: seeds: must be a whole number (got 1.5)"),
    ("name: lab", "name: lab\nseeds: no", "2:8: seeds: must be a whole number (got 'no')"),
    (
        "name: lab",
        f"name: lab\nseeds: {10**30}",
        f"2:8: seeds: must be at most 100000 (got {10**30})",
    ),
    ("name: lab", "name: lab\nseed: " + "9" * 5000, "2:7: a number of more than 40 characters"),
    ("name: lab", "name: lab\nexperimints: 3", "2:1: experimints: unknown; did you mean experiments?"),
    ("name: lab", "name: lab\nzzzz: 3", f"2:1: zzzz: unknown; known: {TOP_KEYS}"),
    ("name: lab", "name: lab\n<<: {a: 1}", f"2:1: <<: unknown; known: {TOP_KEYS}"),
    ("name: lab", "name: lab\nno: 1", f"2:1: no: unknown; known: {TOP_KEYS}"),
    # agents
    ("kind: rmax", "kind: rmaxx", "6:16: agents.rmax.kind: no such kind: 'rmaxx'; did you mean rmax?"),
    ("kind: rmax", "gamma: 0.5", "6:3: agents.rmax.kind: missing"),
    ("kind: rmax", "kind: rmax, gama: 0.5", "6:22: agents.rmax.gama: unknown; did you mean gamma?"),
    ("kind: rmax", "kind: rmax, gamma: 1", "6:29: agents.rmax.gamma: must be less than 1 (got 1)"),
    (
        "kind: model_based",
        "kind: model_based, unvisited: zeros",
        "7:38: agents.mb.unvisited: must be uniform or zero (got 'zeros')",
    ),
    (
        "mf: {kind: q_learning}",
        "mf: {kind: q_learning, alpha: 0}",
        "8:33: agents.mf.alpha: must be more than 0 (got 0)",
    ),
    (
        "watches: mb",
        "watches: mbb",
        "9:38: agents.watcher.watches: no agent is called mbb; did you mean mb?",
    ),
    (
        "watches: mb",
        "watches: watcher",
        "9:38: agents.watcher.watches: watcher refers to other agents itself; name one that does not",
    ),
    (
        "learner: mf",
        "learner: mb",
        "9:51: agents.watcher.learner: must name an agent of kind q_learning (mb is of kind model_based)",
    ),
    ("  mb: {kind", "  a/b: {kind: random}\n  mb: {kind", f"7:3: agents.a/b: {NAME_RULE} (got 'a/b')"),
    (
        "  mb: {kind",
        "  MB: {kind: random}\n  mb: {kind",
        "8:3: agents.mb: differs from MB in case only, which some file systems ignore",
    ),
    # trainings
    (
        "[rmax, mf], steps",
        "[rmax, mff], steps",
        "12:49: experiments.navigation.agents.1: no agent is called mff; did you mean mf?",
    ),
    (
        "[rmax, mf], steps",
        "[rmax, script], steps",
        "12:49: experiments.navigation.agents.1: script cannot play navigation; it plays social, visit",
    ),
    (
        "[rmax, mf], steps",
        "[rmax, rmax], steps",
        "12:42: experiments.navigation.agents: has rmax twice",
    ),
    (
        "agents: [mb], steps",
        "agents: [mb], humans: [human_1], steps",
        "13:50: experiments.go_to_human.humans: unknown; known: agents, lab, phases, steps, success, task, trial_steps",
    ),
    (
        "[rmax, mf], steps: 100",
        "[rmax, mf], steps: 110",
        "12:61: experiments.navigation.steps: must be a whole number of trials of 20 steps, "
        "such as 100 or 120 (got 110)",
    ),
    (
        "[rmax, mf], steps: 100",
        "[rmax, mf], steps: 10",
        "12:61: experiments.navigation.steps: must be a whole number of trials of 20 steps, such as 20 (got 10)",
    ),
    (
        "[rmax, mf], steps: 100",
        "[rmax, mf], trial_steps: 30",
        "12:3: experiments.navigation.steps: must be a whole number of trials of 30 steps, "
        "such as 499980 or 500010 (got 500000)",
    ),
    ("humans: [human_1, human_2], ", "", "14:3: experiments.social.humans: missing"),
    (
        "[human_1, human_2]",
        "[]",
        "14:52: experiments.social.humans: must have at least 1 entry (got 0)",
    ),
    (
        "[human_1, human_2]",
        "[human_2, human_9]",
        "14:62: experiments.social.humans.1: no human is called human_9; did you mean human_2?",
    ),
    (
        "  navigation: {task: navigation",
        "  navigation: {task: navigate",
        "12:22: experiments.navigation.task: no such task: 'navigate'; did you mean navigation?",
    ),
    (
        "  navigation: {task",
        "  figures: {task: navigation, agents: [mb]}\n  navigation: {task",
        "12:3: experiments.figures: is the name of something else in a run folder; choose another",
    ),
    # the visit
    (
        "navigation/rmax",
        "navigation/mb",
        "17:27: experiments.visit.modules.navigation: navigation does not train mb; known: rmax, mf",
    ),
    (
        "navigation/rmax",
        "navigaton/rmax",
        "17:27: experiments.visit.modules.navigation: no experiment is called navigaton; did you mean navigation?",
    ),
    (
        "navigation/rmax",
        "social/mb",
        "17:27: experiments.visit.modules.navigation: social has the task social; needed is navigation; "
        "known: navigation",
    ),
    (
        "navigation/rmax",
        "navigation/rmax/human_1",
        "17:27: experiments.visit.modules.navigation: navigation has no human; write navigation/rmax",
    ),
    (
        "social/mb/human_2",
        "social/mb",
        "17:81: experiments.visit.modules.social: say with which human: social/mb/human_1 or social/mb/human_2",
    ),
    (
        "social/mb/human_2",
        "social/mb/humn_1",
        "17:81: experiments.visit.modules.social: social does not train with humn_1; did you mean human_1?",
    ),
    (
        "social/mb/human_2",
        "social",
        "17:81: experiments.visit.modules.social: a module is experiment/agent or experiment/agent/human "
        "(got 'social')",
    ),
    ("navigation: navigation/rmax, ", "", "17:5: experiments.visit.modules.navigation: missing"),
    (
        "    task: visit",
        "    task: visit\n    goal_rooms: [1]",
        "17:17: experiments.visit.goal_rooms: must have at least 2 entries (got 1)",
    ),
    (
        "    task: visit",
        "    task: visit\n    goal_rooms: [1, 9]",
        "17:21: experiments.visit.goal_rooms.1: must be less than 9 (got 9)",
    ),
    (
        "    task: visit",
        "    task: visit\n    goal_rooms: [1, 1]",
        "17:17: experiments.visit.goal_rooms: has 1 twice",
    ),
    (
        "    task: visit",
        "    task: visit\n    goal_rooms: some",
        "17:17: experiments.visit.goal_rooms: must be all or a list of rooms (got 'some')",
    ),
    (
        "    task: visit",
        "    task: visit\n    models: pair",
        "17:13: experiments.visit.models: must be paired, first or crossed (got 'pair')",
    ),
    (
        "social: social/mb/human_2",
        "social: [social/mb/human_1, social/mb/human_2]",
        "17:81: experiments.visit.modules.social: must be one module, or several as one: "
        "{pool: [social/mb/human_1, social/mb/human_2]}",
    ),
    (
        "social/mb/human_2",
        "{pool: [social/mb/human_1, [social/mb/human_2]]}",
        "17:108: experiments.visit.modules.social.pool.1: must be one module (got a list); "
        "several as one: a visit's social module only",
    ),
    (
        "[human_1, human_2], steps: 100",
        "[human_1], start_from: {pool: [social/mb/human_2]}",
        "14:75: experiments.social.start_from: must be one module (got a mapping); "
        "several as one: a visit's social module only",
    ),
    (
        "social/mb/human_2",
        "{pool: [navigation/rmax, social/mb/human_2]}",
        "17:89: experiments.visit.modules.social.pool.0: navigation has the task navigation; needed is social; "
        "known: social",
    ),
    (
        "social/mb/human_2",
        "{pool: [social/mf/human_2, social/mb/human_2]}",
        "17:89: experiments.visit.modules.social.pool.0: an agent of kind q_learning can't be put together of "
        "several; one of model_based or multi_model can",
    ),
    (
        "social/mb/human_2}",
        "navigation/mf}\n    plan_every: 10",
        "17:81: experiments.visit.modules.social: navigation has the task navigation; needed is social; known: social",
    ),
    (
        "    modules: {navigation: navigation/rmax",
        "    controller: route\n    modules: {navigation: social/mf/human_1",
        "18:27: experiments.visit.modules.navigation: social has the task social; needed is navigation; "
        "known: navigation",
    ),
    # the rest
    (
        "name: lab",
        "name: lab\nfigure: {question: Who?, draws: curves, names: {mbb: it, visit: the visit}}",
        "2:49: figure.names.mbb: no experiment, agent or human is called mbb; did you mean mb?",
    ),
    (
        "name: lab",
        "name: lab\nfigure: {question: Who?, draws: curves, dashed: {mf: mb, rmax: human_3}}",
        "2:64: figure.dashed.rmax: no experiment, agent or human is called human_3; did you mean human_2?",
    ),
    (
        "name: lab",
        "name: lab\nrecord: {steps: evry}",
        "2:17: record.steps: must be every or none (got 'evry')",
    ),
    (
        "name: lab",
        "name: lab\nrecord: {steps: {one_trial_in: 0}}",
        "2:32: record.steps.one_trial_in: must be at least 1 (got 0)",
    ),
    ("name: lab", "name: lab\nrecord: every", "2:9: record: must be a mapping (got 'every')"),
    (
        "name: lab",
        "name: lab\ninteraction: {distances: [1, 2, 2, 3]}",
        "2:26: interaction.distances: must increase",
    ),
    (
        "name: lab",
        "name: lab\nexpected: {navigation/rmx: {value: 1, tolerance: 1}}",
        "2:12: expected.navigation/rmx: navigation has no rmx; did you mean rmax?",
    ),
    (
        "name: lab",
        "name: lab\nexpected: {social/mb: {value: 1, tolerance: 1}}",
        "2:12: expected.social/mb: must be social/agent/human",
    ),
    (
        "name: lab",
        "name: lab\nexpected: {visits/human_2: {value: 1, tolerance: 1}}",
        "2:12: expected.visits/human_2: no experiment is called visits; did you mean visit?",
    ),
    (
        "name: lab",
        "name: lab\nexpected: {visit/human_2: {value: 1, tolerance: -1}}",
        "2:49: expected.visit/human_2.tolerance: must be at least 0 (got -1)",
    ),
    (
        "task: visit",
        "task: visit\n    controller: nonsense",
        "17:17: experiments.visit.controller: must be paper, lead, route, mask or plan, or a list of route, mask, plan "
        "and lead",
    ),
]


@pytest.mark.parametrize(("old", "new", "line"), ONE_LINE)
def test_one_mistake_is_one_line(complaint: Complain, old: str, new: str, line: str) -> None:
    assert complaint(edited(old, new)) == [f"lab.yaml:{line}"]


def test_the_unbroken_config_loads(loaded: Load) -> None:
    assert loaded().name == "lab"


def test_all_mistakes_at_once_sorted_by_line(complaint: Complain) -> None:
    text = edited("agents: [rmax, mf]", "agents: [rmax, mff]")
    text = edited("kind: scripted", "kind: scripd", text)
    text = edited("p_M: 0.1", "p_M: 1.5, p_h: 0", text)
    text = edited("humans: [human_2]", "humans: [human_2]\nseed: 1\nseed: 2", text)
    assert complaint(text) == [
        "lab.yaml:3:34: humans.human_1.p_M: must be at most 1 (got 1.5)",
        "lab.yaml:3:39: humans.human_1.p_h: unknown; did you mean p_H?",
        "lab.yaml:10:18: agents.script.kind: no such kind: 'scripd'; did you mean scripted?",
        "lab.yaml:12:49: experiments.navigation.agents.1: no agent is called mff; did you mean mf?",
        "lab.yaml:20:1: 'seed' a second time; first at lab.yaml:19:1",
    ]


def test_what_is_missing_at_one_place_is_told_one_by_one(complaint: Complain) -> None:
    assert complaint("name: x") == ["lab.yaml:1:1: agents: missing", "lab.yaml:1:1: experiments: missing"]


def test_an_agent_that_an_observer_watches_must_play_the_task_too(complaint: Complain) -> None:
    text = edited("watches: mb", "watches: script", edited("[rmax, mf], ", "[rmax, watcher], "))
    assert complaint(text) == [
        "lab.yaml:12:49: experiments.navigation.agents.1: script, which watcher refers to, cannot play "
        "navigation; it plays social, visit"
    ]


def test_planning_options_are_refused_where_the_social_module_does_not_plan(complaint: Complain, loaded: Load) -> None:
    model_free = edited("social/mb/human_2", "social/mf/human_2")
    assert loaded(model_free).experiments["visit"].modules.social == "social/mf/human_2"
    written = "    task: visit\n    plan_every: 100\n    planner_rewards: carried\n"
    assert complaint(edited("    task: visit\n", written, model_free)) == [
        f"lab.yaml:{line}:5: experiments.visit.{option}: means nothing here: the social module's agent, mf, "
        "does not plan; leave it out"
        for line, option in ((17, "plan_every"), (18, "planner_rewards"))
    ]
    assert loaded(edited("    task: visit\n", written)).experiments["visit"].plan_every == 100


def test_a_flood_of_mistakes_is_cut(complaint: Complain) -> None:
    lines = complaint(LAB + "".join(f"key_{n}: 1\n" for n in range(1000)))
    assert len(lines) == 51
    assert lines[-1] == "... and 950 more"


ODD: tuple[Any, ...] = (1.5, -1, "b", None, True, {}, {"zzz": 1}, [], [1.5], ["Z", "b"], [None], [[]], [{}], 10**400)


def _mutants(plain: Any) -> Iterator[Any]:
    """Copies of plain values: at each place in turn something else, and in each mapping a key that there is not."""
    if isinstance(plain, dict):
        yield {**plain, "zzz": 1}
        for key, inner in plain.items():
            yield from ({**plain, key: other} for other in (*_mutants(inner), *ODD))
    elif isinstance(plain, list):
        for place, inner in enumerate(plain):
            yield from ([*plain[:place], other, *plain[place + 1 :]] for other in (*_mutants(inner), *ODD))


MORE = """
labs: {rows: {rooms: 3 x 3, closed: [AB]}, drawn: {map: ab}}
record: {steps: {one_trial_in: 3}}
expected: {navigation/rmax: {value: 1, tolerance: 1, trials: [1, 2]}}
"""
OF_PYDANTIC = re.compile(r"[<>]|function|(literal|tuple|list|dict|union)\[|Input|tag")


def test_no_message_tells_of_how_it_is_checked_or_names_keys_that_do_not_fit(loaded: Load) -> None:
    text = (
        edited("    humans: [human_2]", "    humans: [human_2]\n    goal_rooms: [0, 3]\n    controller: [route]") + MORE
    )
    plain = canonical(loaded(text))
    found = []
    for mutant in _mutants(plain):
        try:
            Config.model_validate_json(json.dumps(mutant), strict=True)
        except ValidationError as error:
            found += issues_of(error)
    assert len({issue.path for issue in found}) > 50
    for issue in found:
        words = f"{'.'.join(map(str, issue.path))}: {issue.message}"
        assert not OF_PYDANTIC.search(words), issue
        assert len(issue.path) == 1 or "experiments" not in issue.message, issue
