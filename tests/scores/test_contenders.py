"""Who is scored: kinds and configs, what their runs must declare, and what they can't play."""

import pytest

from tests.scores.test_rows import BUILT_IN, ROWS
from visitlab_cli.errors import ConfigError, NotFoundError, UsageError
from visitlab_cli.scores.asking import ask
from visitlab_cli.scores.contenders import check_names, contenders
from visitlab_cli.scores.rows import read_rows


def test_a_kind_is_scored_as_it_is_by_default_and_with_what_is_said():
    (found,) = contenders("q_learning", ["alpha=0.1"])
    assert (found.name, found.parameters.alpha, found.parameters.gamma) == ("q_learning", 0.1, 0.9)
    assert set(found.declared) == {"q_learning"}


def test_of_a_config_only_its_agents_count(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("agents:\n  a: {kind: q_learning}\n  b: {like: a, alpha: 0.1}\nexperiments: 7\nnonsense: 1\n")
    assert {each.name: each.parameters.alpha for each in contenders(str(file))} == {"a": 0.5, "b": 0.1}
    (only,) = contenders(str(file), ["agents.b.alpha=0.3"], ["b"])
    assert only.parameters.alpha == 0.3


def test_who_refers_to_others_brings_them_along():
    (observer,) = contenders(BUILT_IN, names=["observer"])
    assert set(observer.declared) == {"observer", "model_based", "q_learning"}
    rows = read_rows(ROWS)
    asked = ask(rows, observer, 1)
    assert set(asked.config.agents) == {"observer", "model_based", "q_learning", "partner"}


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("agents:\n  a: {kind: q_learning, alpha: 7}\n", ":2:32: agents.a.alpha: must be at most 1"),
        ("agents: [a]\n", ":1:9: agents: must be a mapping"),
        ("agents:\n  a: {kind: nobodys}\n", ":2:13: agents.a.kind: "),
    ],
)
def test_a_wrong_agent_is_told_where_it_stands(tmp_path, text, line):
    file = tmp_path / "mine.yaml"
    file.write_text(text)
    with pytest.raises(ConfigError) as told:
        contenders(str(file))
    assert str(told.value).startswith(f"{file}{line}")
    assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("words", "error", "line"),
    [
        (("q_lerning",), NotFoundError, "q_lerning: no kind of agent, and no config of this name; did you mean q_lea"),
        (("none/of.yaml",), NotFoundError, "none/of.yaml: no such file"),
        (("observer",), UsageError, "observer: refers to other agents (watches, learner, acts_as); declare them"),
        (("q_learning", ["alpha"]), UsageError, "must be key=value"),
        (("q_learning", ["aplha=1"]), ConfigError, "did you mean alpha?"),
        ((BUILT_IN, (), ["rmx"]), NotFoundError, "--agent rmx: the config declares no such agent; did you mean rmax?"),
    ],
)
def test_who_can_not_be_scored_is_one_line(words, error, line):
    with pytest.raises(error) as told:
        contenders(*words)
    assert line in str(told.value)
    assert "\n" not in str(told.value)


def test_an_agent_can_not_have_the_name_of_the_rows_own(tmp_path):
    file = tmp_path / "mine.yaml"
    file.write_text("agents: {partner: {kind: q_learning}}\n")
    with pytest.raises(UsageError, match=r"agents\.partner: the scorecard has an agent of this name"):
        check_names(contenders(str(file)), read_rows(ROWS))


def test_who_can_not_play_a_task_can_not_play_what_starts_from_it_and_the_reason_is_said():
    rows = read_rows(ROWS)
    (scripted,) = contenders("scripted")
    asked = ask(rows, scripted, 2)
    assert asked.unplayable == {"navigation": "can't play navigation; it plays social, visit"}
    assert asked.why_not(rows, "speed") == "can't play navigation; it plays social, visit"
    assert asked.why_not(rows, "visit") is None
    assert "navigation" not in asked.config.experiments


def test_of_some_rows_only_what_they_need_is_played_in_order():
    rows = read_rows(ROWS)
    (found,) = contenders("q_learning")
    asked = ask(rows, found, 1)
    played = [cell.experiment for cell in asked.needed(rows, ["remembers"])]
    assert played == ["social", "adapting", "again"]
    assert {cell.experiment for cell in asked.needed(rows, ["visit"])} == {
        "social",
        "partner_navigation",
        "partner_go_to_human",
        "visit",
    }
