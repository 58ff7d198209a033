"""How conditions are named: short, and told apart."""

import pytest

from visitlab_cli.report.names import breakable, names_within
from visitlab_cli.results.groups import Group
from visitlab_cli.results.varying import Varying, varying


def group(experiment="social", agent="mb", human="shy", **point):
    return Group(
        "", experiment, agent, human, tuple((path.replace("__", "."), value) for path, value in point.items()), []
    )


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("slow_and_distractible", "slow_<wbr>and_<wbr>distractible"),
        ("p_A=0.1234567", "p_A=0.1234567"),
        ("humans.shyer.p_S=[0.333, 0.667]", "humans.<wbr>shyer.<wbr>p_S=[0.333, 0.667]"),
        ("a<long_name", "a&lt;long_<wbr>name"),
    ],
)
def test_a_name_breaks_behind_words_and_never_in_a_number(text, shown):
    assert breakable(text) == shown


def test_what_differs_names_a_curve():
    assert names_within([group(agent="mb"), group(agent="ql")], Varying({})) == ["mb", "ql"]
    visits = [group("visit_mb", "mb"), group("visit_ql", "ql")]
    assert names_within(visits, Varying({})) == ["mb", "ql"]
    same = [group("first", human="shy"), group("second", human="shy")]
    assert names_within(same, Varying({})) == ["first · mb · shy", "second · mb · shy"]
    varied = [group(humans__shy__p_A="0.1"), group(humans__shy__p_A="0.2")]
    assert names_within(varied, varying(each.point for each in varied)) == ["p_A=0.1", "p_A=0.2"]
