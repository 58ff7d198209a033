"""Conditions two by two, on cells written by hand: who is compared, what is paired, which numbers come out."""

import math

import pytest

from tests.results.runs_by_hand import open_lab, reach, write_cell
from visitlab_cli.errors import NotFoundError
from visitlab_cli.results.pairs import compare_by, compare_runs


def values(where, numbers):
    return {f"{where}/seed-{seed:04d}": number for seed, number in enumerate(numbers)}


def test_agents_are_independent_since_their_random_numbers_are(tmp_path):
    run, cells = open_lab(tmp_path)
    plan = reach(run, cells, values("navigation/mb", [1, 2, 3]) | values("navigation/mf", [11, 12, 13]))
    (pair,) = compare_by(run, plan, "agent").pairs
    assert (pair.where, pair.first.name, pair.second.name) == ("navigation", "mb", "mf")
    assert (pair.paired, pair.n, pair.difference.mean, pair.probability_of_improvement) == (False, 3, 10.0, 1.0)
    assert pair.difference.half == pytest.approx(2.776 * math.sqrt(2 / 3), abs=1e-3)  # 4 degrees of freedom


def test_visits_with_the_same_modules_are_paired(tmp_path):
    run, cells = open_lab(tmp_path)
    plan = reach(run, cells, values("visit/slow", [1, 5, 9]) | values("visit/fast", [2, 7, 12]))
    (pair,) = compare_by(run, plan, "human").pairs
    assert (pair.where, pair.first.name, pair.second.name, pair.measure) == (
        "visit mb",
        "slow",
        "fast",
        "goals a trial",
    )
    assert (pair.paired, pair.n, pair.difference.mean) == (True, 3, 2.0)
    assert pair.difference.half == pytest.approx(4.303 * math.sqrt(1 / 3), abs=1e-3)  # of the differences 1, 2, 3
    assert pair.probability_of_improvement == (3 + 2 + 1) / 9  # over all nine combinations


def test_only_common_seeds_make_pairs(tmp_path):
    run, cells = open_lab(tmp_path)
    plan = reach(run, cells, values("visit/slow", [1, 5, 100]) | values("visit/fast", [2, 7]))
    (pair,) = compare_by(run, plan, "human").pairs
    assert (pair.paired, pair.n, pair.first.n, pair.first.mean, pair.difference.mean) == (True, 2, 2, 3.0, 1.5)


def test_a_setting_that_varies(tmp_path):
    vary = "vary: {agents.mf.alpha: [0.1, 0.5, 1], humans.fast.p_A: [0, 0.5]}\n"
    run, cells = open_lab(tmp_path, seeds=2, more=vary)
    done = {f"navigation/mf/agents.mf.alpha={alpha}": [n, n + 1] for n, alpha in enumerate(("0.1", "0.5", "1.0"))}
    at = "visit/fast/agents.mf.alpha=0.1,humans.fast.p_A="
    done |= {f"{at}0.0": [0, 4], f"{at}0.5": [1, 5], "visit/slow/agents.mf.alpha=0.5": [3, 3]}
    plan = reach(run, cells, {path: n for where, numbers in done.items() for path, n in values(where, numbers).items()})
    by_alpha = compare_by(run, plan, "agents.mf.alpha").pairs
    assert [(pair.where, pair.first.name, pair.second.name, pair.difference.mean) for pair in by_alpha] == [
        ("navigation mf", "0.1", "0.5", 1.0),
        ("navigation mf", "0.1", "1.0", 2.0),
        ("navigation mf", "0.5", "1.0", 1.0),
    ]
    (by_human,) = compare_by(run, plan, "humans.fast.p_A").pairs
    assert by_human.where == "visit mb fast agents.mf.alpha=0.1"
    assert (by_human.paired, by_human.difference) == (True, (1.0, 0.0))


def test_agents_are_compared_at_each_of_their_settings(tmp_path):
    run, cells = open_lab(tmp_path, more="vary: {agents.mf.alpha: [0.1, 0.5], interaction.distances: [[1, 2, 3, 5]]}\n")
    done = {"navigation/mb": [1, 2], "navigation/mf/agents.mf.alpha=0.1": [3, 4], "go_to_human/mb": [1, 1]}
    done |= {"navigation/mf/agents.mf.alpha=0.5": [5, 6]}
    done = {path if "go_to" not in path else f"{path}/interaction.distances=0": n for path, n in done.items()}
    plan = reach(run, cells, {path: n for where, numbers in done.items() for path, n in values(where, numbers).items()})
    compared = compare_by(run, plan, "agent")
    assert [(pair.where, pair.first.name, pair.second.name) for pair in compared.pairs] == [
        ("navigation", "mb", "mf agents.mf.alpha=0.1"),
        ("navigation", "mb", "mf agents.mf.alpha=0.5"),
    ]
    assert compared.alone == ["go_to_human/mb/interaction.distances=0"]


def test_humans_are_compared_at_each_of_their_settings(tmp_path):
    run, cells = open_lab(tmp_path, more="vary: {humans.fast.p_A: [0, 0.5]}\n")
    done = {"visit/slow": [1, 2], "visit/fast/humans.fast.p_A=0.0": [3, 4], "visit/fast/humans.fast.p_A=0.5": [5, 6]}
    plan = reach(run, cells, {path: n for where, numbers in done.items() for path, n in values(where, numbers).items()})
    assert [(pair.first.name, pair.second.name, pair.paired) for pair in compare_by(run, plan, "human").pairs] == [
        ("slow", "fast humans.fast.p_A=0.0", True),
        ("slow", "fast humans.fast.p_A=0.5", True),
    ]


ANOTHER_VISIT = """
  visit_mf:
    task: visit
    modules: {{navigation: navigation/mf, go_to_human: go_to_human/mb, social: {social}}}
    humans: [slow]
    trials: {trials}
    trial_steps: 10
"""


def with_another_visit(tmp_path, trials=20, social="social/mf/slow"):
    run, cells = open_lab(tmp_path, more=ANOTHER_VISIT.format(trials=trials, social=social), agents_of_social="mb, mf")
    return run, reach(run, cells, values("visit/slow", [1, 2, 3]) | values("visit_mf/slow", [2, 4, 6]))


def test_visits_whose_social_agents_differ_are_compared(tmp_path):
    (pair,) = compare_by(*with_another_visit(tmp_path), "agent").pairs
    assert (pair.where, pair.first.name, pair.second.name) == ("visit/visit_mf slow", "mb", "mf")
    assert (pair.paired, pair.difference.mean, pair.measure) == (False, 2.0, "goals a trial")


def test_visits_that_differ_in_more_are_not_compared(tmp_path):
    with pytest.raises(NotFoundError, match="nothing that is done differs in agent alone"):
        compare_by(*with_another_visit(tmp_path, trials=21), "agent")


def test_agents_whose_visits_both_depend_on_what_varies_are_compared_at_each_value(tmp_path):
    more = ANOTHER_VISIT.format(trials=20, social="social/mf/slow") + "vary: {agents.mb.epsilon: [0.1, 0.2]}\n"
    run, cells = open_lab(tmp_path, more=more, agents_of_social="mb, mf")  # both go to the human with mb
    at = "agents.mb.epsilon="
    done = {f"{name}/slow/{at}{e}": [e, 2 * e] for name in ("visit", "visit_mf") for e in (0.1, 0.2)}
    plan = reach(run, cells, {path: n for where, numbers in done.items() for path, n in values(where, numbers).items()})
    compared = compare_by(run, plan, "agent")
    assert [(pair.where, pair.first.name, pair.second.name) for pair in compared.pairs] == [
        (f"visit/visit_mf slow {at}0.1", "mb", "mf"),
        (f"visit/visit_mf slow {at}0.2", "mb", "mf"),
    ]
    assert compared.alone == []


def test_humans_whose_visits_both_depend_on_what_varies_are_compared_at_each_value(tmp_path):
    run, cells = open_lab(tmp_path, more="vary: {humans.slow.p_A: [0, 0.5]}\n")  # the module was trained with slow
    at = "humans.slow.p_A="
    done = {f"visit/{human}/{at}{p}": [p, 2 * p] for human in ("slow", "fast") for p in (0.0, 0.5)}
    plan = reach(run, cells, {path: n for where, numbers in done.items() for path, n in values(where, numbers).items()})
    assert [(pair.where, pair.first.name, pair.second.name) for pair in compare_by(run, plan, "human").pairs] == [
        (f"visit mb {at}0.0", "slow", "fast"),
        (f"visit mb {at}0.5", "slow", "fast"),
    ]


LEAD = """
  leading:
    task: visit
    modules: {navigation: navigation/mb, go_to_human: go_to_human/mb, social: social/mb/slow}
    controller: lead
    humans: [slow]
  own_map:
    task: visit
    modules: {navigation: navigation/mb, go_to_human: go_to_human/mb, social: social/mb/slow}
    controller: plan
    humans: [fast, slow]
    trials: 40
  masked:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}
    humans: [slow]
"""


def test_visits_are_compared_each_with_the_first_of_the_same_agents_and_human(tmp_path):
    run, cells = open_lab(tmp_path, more=LEAD)
    numbers = {"leading/slow": [1, 2, 3], "own_map/slow": [2, 4, 6], "visit/slow": [0, 0, 0], "masked/slow": [1, 1, 1]}
    numbers |= {"own_map/fast": [9, 9, 9], "navigation/mb": [1, 1, 1]}
    plan = reach(run, cells, {path: n for name, each in numbers.items() for path, n in values(name, each).items()})
    compared = compare_by(run, plan, "experiment")
    assert [(pair.where, pair.first.name, pair.second.name) for pair in compared.pairs] == [
        ("slow", "visit", "masked"),
        ("slow", "leading", "own_map"),
    ]
    assert [(pair.paired, pair.n, pair.difference.mean) for pair in compared.pairs] == [(True, 3, 1.0), (True, 3, 2.0)]
    assert compared.alone == ["own_map/fast"]


def test_of_several_visits_all_are_compared_with_the_first_at_each_point_of_a_grid(tmp_path):
    more = LEAD.replace("navigation/mf", "navigation/mb") + "vary: {agents.mb.epsilon: [0.1, 0.2]}\n"
    run, cells = open_lab(tmp_path, more=more)
    names = [f"{visit}/slow/agents.mb.epsilon={e}" for visit in ("leading", "own_map", "masked") for e in (0.1, 0.2)]
    plan = reach(run, cells, {path: n for name in names for path, n in values(name, [1, 2]).items()})
    assert [(pair.where, pair.second.name) for pair in compare_by(run, plan, "experiment").pairs] == [
        (f"slow agents.mb.epsilon={e}", visit) for e in (0.1, 0.2) for visit in ("own_map", "masked")
    ]


PHASED = """
  swap:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}
    phases: [{trials: 2, human: slow}, {trials: 3, human: fast}]
  swap_none:
    task: visit
    social_reward: none
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}
    phases: [{trials: 2, human: slow}, {trials: 3, human: fast}]
"""


def test_visits_with_phases_are_compared_phase_by_phase(tmp_path):
    run, cells = open_lab(tmp_path, seeds=1, more=PHASED)
    for name, rewards in (("swap", [1, 3, 0, 0, 3]), ("swap_none", [5, 5, 2, 2, 2])):
        write_cell(run, cells[f"{name}/phases/seed-0000"], rewards)
    plan = list(cells.values())
    pairs = compare_by(run, plan, "experiment").pairs
    assert [(pair.where, pair.first.mean, pair.difference.mean, pair.part) for pair in pairs] == [
        ("slow phase 0", 2.0, 3.0, "all of the phase"),
        ("fast phase 1", 1.0, 1.0, "all of the phase"),
    ]
    assert {pair.as_json()["measure"] for pair in pairs} == {"goals a trial, all of the phase"}
    assert [pair.where for pair in compare_by(run, plan, "experiment", 1).pairs] == ["fast phase 1"]
    with pytest.raises(NotFoundError, match="the run has no such key; known: agent, human, experiment, phase$"):
        compare_by(run, plan, "fooled")


POOLED = """
  social_fast: {task: social, agents: [mb], humans: [fast], steps: 400}
  pooled:
    task: visit
    modules:
      navigation: navigation/mf
      go_to_human: go_to_human/mb
      social: {pool: [social/mb/slow, social_fast/mb/fast], prior_strength: 20}
    humans: [slow]
  by_fast:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social_fast/mb/fast}
    humans: [slow]
  strangers:
    task: visit
    modules: {navigation: other/mf, go_to_human: other_way/mb, social: other_social/mb/slow}
    humans: [slow]
  other: {task: navigation, agents: [mf], steps: 400}
  other_way: {task: go_to_human, agents: [mb], steps: 400}
  other_social: {task: social, agents: [mb], humans: [slow], steps: 400}
"""


def test_visits_with_some_modules_in_common_are_paired_also_with_a_pool(tmp_path):
    run, cells = open_lab(tmp_path, more=POOLED)
    numbers = {"visit/slow": [1, 5, 9], "pooled/slow": [3, 6, 13], "by_fast/slow": [0, 5], "strangers/slow": [1, 2, 3]}
    found = {path: n for name, each in numbers.items() for path, n in values(name, each).items()}
    pairs = compare_by(run, reach(run, cells, found), "experiment").pairs
    assert [(pair.first.name, pair.second.name, pair.paired, pair.n, pair.difference.mean) for pair in pairs] == [
        ("visit", "pooled", True, 3, pytest.approx(7 / 3)),
        ("visit", "by_fast", True, 2, -0.5),
        ("visit", "strangers", False, 3, -3.0),
    ]


def test_agents_are_compared_in_one_phase(tmp_path):
    more = """
  swap:
    task: social
    agents: [mb, mf]
    phases: [{trials: 2, human: slow}, {trials: 3, human: fast}]
"""
    run, cells = open_lab(tmp_path, more=more)
    for seed in range(3):
        write_cell(run, cells[f"swap/mb/phases/seed-{seed:04d}"], [1, 3, 0, 0, 3])
        write_cell(run, cells[f"swap/mf/phases/seed-{seed:04d}"], [5, 5, 2, 2, 2 + seed])
    plan = list(cells.values())
    (pair,) = compare_by(run, plan, "agent", 1).pairs
    assert (pair.where, pair.first.name, pair.second.name) == ("swap fast phase 1", "mb", "mf")
    assert (pair.first.mean, pair.second.mean, pair.part) == (1.0, pytest.approx(7 / 3), "all of the phase")
    assert pair.difference.half > 0
    with pytest.raises(NotFoundError, match="--phase 2: the run has none such; phases are 0 to 1"):
        compare_by(run, plan, "agent", 2)
    with pytest.raises(NotFoundError, match="nothing that is done differs in human alone"):
        compare_by(run, plan, "human", 1)


@pytest.mark.parametrize("key", ["agent", "experiments.visit.modules.social"])
def test_a_social_module_that_varies(tmp_path, key):
    vary = "vary: {experiments.visit.modules.social: [social/mb/slow, social/mf/slow]}\n"
    run, cells = open_lab(tmp_path, more=vary, agents_of_social="mb, mf")
    at = "visit/slow/experiments.visit.modules.social="
    plan = reach(run, cells, values(f"{at}0", [1, 2, 3]) | values(f"{at}1", [2, 4, 6]))
    (pair,) = compare_by(run, plan, key).pairs
    names = [f"social/{agent}/slow" for agent in ("mb", "mf")]
    if key == "agent":
        names = [f"{name.split('/')[1]} {'experiments.visit.modules.social'}={name}" for name in names]
    assert (pair.where, pair.first.name, pair.second.name) == ("visit slow", *names)
    assert pair.difference.mean == 2.0


def test_two_runs_are_paired_where_their_random_numbers_are_the_same(tmp_path):
    first, cells = open_lab(tmp_path)
    plan = reach(first, cells, values("navigation/mb", [1, 5, 9]) | values("social/mb/slow", [1, 1, 1]))
    for seed, paired in ((0, True), (1, False)):
        second, other = open_lab(tmp_path, seed=seed, more="interaction: {distances: [1, 2, 3, 5]}\n")
        their_plan = reach(second, other, values("navigation/mb", [2, 7, 12]))
        compared = compare_runs((first, plan), (second, their_plan))
        (pair,) = compared.pairs
        assert compared.alone == [f"{first.name}/social/mb/slow"]
        assert (pair.where, pair.first.name, pair.second.name) == ("navigation/mb", first.name, second.name)
        assert (pair.paired, pair.difference.mean) == (paired, 2.0)
        assert (pair.difference.half < 3) == paired


def test_what_cannot_be_compared_is_said(tmp_path):
    run, cells = open_lab(tmp_path)
    plan = reach(run, cells, values("navigation/mb", [1, 2]))
    with pytest.raises(NotFoundError, match="--by agnet: the run has no such key; did you mean agent?"):
        compare_by(run, plan, "agnet")
    with pytest.raises(NotFoundError, match="nothing that is done differs in agent alone"):
        compare_by(run, plan, "agent")
    other, cells = open_lab(tmp_path, seed=1)
    with pytest.raises(NotFoundError, match="no finished experiment, agent and human in common"):
        compare_runs((run, plan), (other, list(cells.values())))
