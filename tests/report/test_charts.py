"""Which curves share a chart, and which colour they have."""

import pytest

from tests.results.runs_by_hand import open_lab, reach
from visitlab_cli.report.curves import charts_of
from visitlab_cli.report.hues import COLOURS, Hues
from visitlab_cli.results.groups import Group, groups_of

OTHER_VISIT = """
  visit_mf:
    task: visit
    modules: {{navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mf/slow}}
    humans: [slow, fast]
    trials: {trials}
    trial_steps: 10
record: {{steps: none}}
"""


def charts(tmp_path, trials):
    more = OTHER_VISIT.format(trials=trials)
    run, cells = open_lab(tmp_path, agents_of_social="mb, mf", more=more)
    done = reach(run, cells, dict.fromkeys(cells, 1.0))
    return {chart.title: chart.curves for chart in charts_of(run, groups_of(done))}


def group(agent, human="", point=()):
    return Group("", "", agent, human, point, [])


def test_visits_as_long_share_a_chart(tmp_path):
    found = charts(tmp_path, trials=20)
    assert list(found) == ["navigation", "go_to_human", "social", "visit, visit_mf"]
    assert [curve.name for curve in found["visit, visit_mf"]] == ["mb · slow", "mb · fast", "mf · slow", "mf · fast"]


def test_visits_of_other_lengths_do_not(tmp_path):
    assert list(charts(tmp_path, trials=30))[-2:] == ["visit", "visit_mf"]


def test_nor_do_more_than_there_are_colours(tmp_path, monkeypatch):
    monkeypatch.setattr("visitlab_cli.report.curves.COLOURS", 3)
    assert list(charts(tmp_path, trials=20))[-2:] == ["visit", "visit_mf"]


def test_an_agent_keeps_its_colour(tmp_path):
    found = charts(tmp_path, trials=20)
    mb, mf = (curve.hue for curve in found["navigation"])
    assert mb != mf
    assert [curve.hue for curve in found["go_to_human"]] == [mb]
    assert [curve.hue for curve in found["social"]] == [mb, mf]
    hues = {curve.name: curve.hue for curve in found["visit, visit_mf"]}
    assert (hues["mb · slow"], hues["mf · slow"]) == (mb, mf)
    assert len(set(hues.values())) == 4


def test_a_condition_keeps_its_colour():
    hues = Hues()
    first = hues.of_chart([group("mb", "shy"), group("mb", "bold"), group("ql", "shy")])
    assert hues.of_chart([group("ql", "shy"), group("mb", "bold")]) == [first[2], first[1]]
    assert hues.of_chart([group("mb", "new")]) == [first[0]]


@pytest.mark.parametrize("number", [COLOURS, 50])
def test_the_curves_of_a_chart_differ(number):
    hues = Hues()
    hues.of_chart([group(f"other_{place}") for place in range(5)])
    found = hues.of_chart([group("mb", point=(("p", str(place)),)) for place in range(number)])
    assert set(found) == set(range(number))


def test_few_curves_are_not_dashed():
    hues, many = Hues(), [group("mb", point=(("p", str(place)),)) for place in range(COLOURS + 3)]
    hues.of_chart(many)
    assert set(hues.of_chart(many[3:])) == set(range(COLOURS))
