"""What varies, as short columns."""

from visitlab_cli.results.groups import Group
from visitlab_cli.results.varying import Varying, names_within, varying


def point(**settings):
    return tuple((path.replace("__", "."), value) for path, value in settings.items())


def test_a_head_is_the_shortest_end_that_no_other_column_has():
    points = [
        point(agents__mb__epsilon="0"),
        point(agents__mb__epsilon="0.1", humans__shy__p_A="1"),
        point(agents__ql__epsilon="0", humans__shy__p_A="0"),
        point(agents__ql__epsilon="0.1"),
    ]
    found = varying(points)
    assert found.heads == {
        "agents.mb.epsilon": "mb.epsilon",
        "humans.shy.p_A": "p_A",
        "agents.ql.epsilon": "ql.epsilon",
    }
    assert [found.values(each) for each in points[:2]] == [["0", "-", "-"], ["0.1", "1", "-"]]
    assert found.words(points[2]) == ["p_A=0", "ql.epsilon=0"]


def test_a_head_is_no_other_head_of_the_table():
    points = [point(experiments__x__n="1"), point(experiments__x__n="2")]
    assert varying(points).heads == {"experiments.x.n": "n"}
    assert varying(points, taken=["n", "mean"]).heads == {"experiments.x.n": "x.n"}


def test_what_is_the_same_in_all_lines_is_no_column():
    assert varying([point(a__b="1", a__c="1"), point(a__b="2", a__c="1")]).heads == {"a.b": "b"}


def test_of_an_entry_that_varies_as_a_whole_only_what_differs_is_a_column():
    points = [
        point(humans__shy='{"p_S": [1.0, 0.0, 0.0], "p_A": 0.1, "p_H": 0.5}'),
        point(humans__shy='{"p_S": [0.0, 1.0, 0.0], "p_A": 0.2, "p_H": 0.5}'),
    ]
    found = varying(points)
    assert found.heads == {"humans.shy.p_S": "p_S", "humans.shy.p_A": "p_A"}
    assert found.words(points[1]) == ["p_S=[0.0, 1.0, 0.0]", "p_A=0.2"]


def group(experiment="social", agent="mb", human="shy", **settings):
    return Group("", experiment, agent, human, point(**settings), [])


def test_what_differs_names_a_curve():
    assert names_within([group(agent="mb"), group(agent="ql")], Varying({})) == ["mb", "ql"]
    visits = [group("visit_mb", "mb"), group("visit_ql", "ql")]
    assert names_within(visits, Varying({})) == ["mb", "ql"]
    same = [group("first", human="shy"), group("second", human="shy")]
    assert names_within(same, Varying({})) == ["first · mb · shy", "second · mb · shy"]
    varied = [group(humans__shy__p_A="0.1"), group(humans__shy__p_A="0.2")]
    assert names_within(varied, varying(each.point for each in varied)) == ["p_A=0.1", "p_A=0.2"]
