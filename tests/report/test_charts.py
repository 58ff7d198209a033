"""Which curves share a chart, and which colour they have."""

from tests.results.runs_by_hand import open_lab, reach
from visitlab_cli.colours import looks_of
from visitlab_cli.report.curves import charts_of
from visitlab_cli.results.groups import groups_of

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


def test_visits_as_long_share_a_chart(tmp_path):
    found = charts(tmp_path, trials=20)
    assert list(found) == ["navigation", "go_to_human", "social", "visit, visit_mf"]
    assert [curve.name for curve in found["visit, visit_mf"]] == ["mb · slow", "mb · fast", "mf · slow", "mf · fast"]


def test_visits_of_other_lengths_do_not(tmp_path):
    assert list(charts(tmp_path, trials=30))[-2:] == ["visit", "visit_mf"]


def test_nor_do_many(tmp_path, monkeypatch):
    monkeypatch.setattr("visitlab_cli.report.curves.MOST_TOGETHER", 3)
    assert list(charts(tmp_path, trials=20))[-2:] == ["visit", "visit_mf"]


def test_an_agent_has_its_colour_in_every_chart(tmp_path):
    found = charts(tmp_path, trials=20)
    looks = looks_of(["mb", "mf"])
    for curve in (curve for curves in found.values() for curve in curves):
        agent = "mf" if curve.name.startswith("mf") else "mb"
        assert (curve.hue, curve.marker) == looks[agent]


def test_a_curve_knows_its_line_of_the_table(tmp_path):
    run, cells = open_lab(tmp_path, agents_of_social="mb, mf", more="record: {steps: none}\n")
    reach(run, cells, {path: 1.0 for path in cells if not path.startswith("navigation")})
    groups = groups_of(list(cells.values()))
    lines = {curve.line for chart in charts_of(run, groups) for curve in chart.curves}
    assert lines == {line for line, group in enumerate(groups) if group.experiment != "navigation"}
