"""`key=value` on the command line."""

import pytest

from tests.config.lab import Complain, Load, edited
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.loading import load
from visitlab_cli.errors import UsageError

EXPECTED = "name: lab\nexpected: {navigation/rmax: {value: 18, tolerance: 0.5}}"


def test_each_override_is_an_edit(loaded: Load) -> None:
    config = loaded(
        overrides=[
            "seeds=10",
            "experiments.social.steps=20000",
            "humans.human_2.p_S=[0, 0, 1]",
            "record.steps.one_trial_in=5",
            "agents.chance={kind: random}",
            "experiments.navigation.agents=[rmax, mf, chance]",
        ]
    )
    assert config.seeds == 10
    assert config.experiments["social"].steps == 20000
    assert config.humans["human_2"].p_S == (0, 0, 1)
    assert config.record.one_trial_in == 5
    assert config.experiments["navigation"].agents == ("rmax", "mf", "chance")


def test_null_leaves_a_key_out(loaded: Load, complaint: Complain) -> None:
    phases = "experiments.visit.phases=[{trials: 2, human: human_1}]"
    told = complaint(overrides=[phases])
    assert [line.partition(": ")[2] for line in told] == [
        f"experiments.visit.humans: stands in the phases; leave it out (by override '{phases}')"
    ]
    assert loaded(overrides=[phases, "experiments.visit.humans=null"]).experiments["visit"].n_trials == 2
    assert "script" not in loaded(overrides=["agents.script=null"]).agents
    assert "experiments.visit.modules: missing (by " in complaint(overrides=["experiments.visit.modules=null"])[0]
    assert complaint(overrides=["sedes=null"])[0].endswith("sedes: unknown; did you mean seeds?")


TOGETHER = "agents.mb: exploration: count_bonus goes with a bonus, and only that does"


@pytest.mark.parametrize(
    ("overrides", "line"),
    [
        (["agents.mb.bonus=1"], f"override 'agents.mb.bonus=1': {TOGETHER}"),
        (["agents.mb.bonus=1", "seeds=2"], f"override 'agents.mb.bonus=1': {TOGETHER}"),
        (
            ["experiments.navigation.agents=[mf]"],
            "lab.yaml:17:27: experiments.visit.modules.navigation: navigation does not train rmax; known: mf "
            "(by override 'experiments.navigation.agents=[mf]')",
        ),
        (
            ["experiments.navigation.trial_steps=30", "seeds=2"],
            "lab.yaml:12:61: experiments.navigation.steps: must be a whole number of trials of 30 steps, such as 90 or "
            "120 (got 100) (by the overrides)",
        ),
    ],
)
def test_what_is_wrong_by_an_override_names_it(complaint: Complain, overrides: list[str], line: str) -> None:
    assert complaint(overrides=overrides) == [line]


def test_an_override_is_not_blamed_for_what_was_wrong_before(complaint: Complain) -> None:
    text = edited("kind: model_based", "kind: model_based, bonus: 1")
    assert complaint(text, ["agents.mb.gamma=0.5"]) == [f"lab.yaml:7:7: {TOGETHER}"]


def test_a_figure_says_nothing_of_what_an_override_leaves_out(loaded: Load) -> None:
    figure = "figure: {question: Who?, draws: curves, names: {visit: all, mf: free}, dashed: {script: mb, mf: mb}}"
    settings = loaded(edited("name: lab", f"name: lab\n{figure}"), ["experiments.visit=null", "agents.script=null"])
    assert settings.figure is not None
    assert (settings.figure.names, settings.figure.dashed) == ({"mf": "free"}, {"mf": "mb"})


def test_the_last_override_of_a_key_wins(loaded: Load) -> None:
    assert loaded(overrides=["seed=1", "seed=2"]).seed == 2


def test_an_override_changes_what_is_like_it(loaded: Load) -> None:
    text = edited("human_2: {", "human_3: {like: human_2}\n  human_2: {")
    assert loaded(text, ["humans.human_2.p_A=0.25"]).humans["human_3"].p_A == 0.25


def test_names_with_dots(loaded: Load) -> None:
    text = edited("  mb: {kind", "  v1.0: {kind: random}\n  v1: {kind: rmax}\n  v1.0.b: {kind: rmax}\n  mb: {kind")
    config = loaded(text, ["agents.v1.0.b.gamma=0.5", "agents.v1.gamma=0.25", "agents.v1.0={kind: rmax}"])
    kinds = {name: config.agents[name].model_dump().get("gamma") for name in ("v1.0", "v1", "v1.0.b")}
    assert kinds == {"v1.0": 0.9, "v1": 0.25, "v1.0.b": 0.5}


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("seeds=abc", "seeds: must be a whole number (got 'abc')"),
        ("seeds=", "seeds: must be a whole number (got nothing; left out it is 1)"),
        ("seeds=1_0", "seeds: must be a whole number (got '1_0')"),
        ("seeds.x=1", "seeds: must be a whole number (got a mapping)"),
        ("seds=3", "seds: unknown; did you mean seeds?"),
        ("include=[x]", "include: cannot be overridden"),
        (
            "experiments.social.humans.0=slow",
            "experiments.social.humans.0: experiments.social.humans is a list; give it whole, as in "
            "experiments.social.humans=[human_1, human_2]",
        ),
        (
            "expected.nowhere={value: 3, tolerance: 1}",
            "expected.nowhere: no experiment is called nowhere; known: navigation, go_to_human, social, visit",
        ),
        ("experiments.social.step=20", "experiments.social.step: unknown; did you mean steps?"),
        (
            "experiments.socail.steps=20",
            "experiments.socail: no experiment of this name; did you mean social?",
        ),
        ("humans.h9.p_A=0", "humans.h9: no human of this name; known: human_1, human_2"),
        ("humans.human_1.p_A=3", "humans.human_1.p_A: must be at most 1 (got 3)"),
        (
            "experiments.visit.humans=[human_3]",
            "experiments.visit.humans.0: no human is called human_3; did you mean human_2?",
        ),
        ("name=*a", "an alias (*a); use `like` or `include`"),
        ("name={a: 1, a: 2}", None),
        ("name=\ud800", "not UTF-8"),
        ("name=[", None),
    ],
)
def test_a_bad_override_is_named(complaint: Complain, override: str, message: str | None) -> None:
    lines = complaint(overrides=[override, "seed=1"])
    assert all(line.startswith(f"override {override!r}: ") for line in lines)
    if message is not None:
        assert lines == [f"override {override!r}: {message}"]


def test_a_long_override_is_shortened(complaint: Complain) -> None:
    (line,) = complaint(overrides=["name=" + "x" * 1000])
    assert len(line) < 300


def test_overrides_come_after_the_file(complaint: Complain) -> None:
    assert complaint(edited("p_M: 0.1", "p_M: 2"), ["seeds=0"]) == [
        "lab.yaml:3:34: humans.human_1.p_M: must be at most 1 (got 2)",
        "override 'seeds=0': seeds: must be at least 1 (got 0)",
    ]


@pytest.mark.parametrize("override", ["seeds", "=3", "a..b=3", ".a=3", "a.=3", ""])
def test_what_is_no_override_is_wrong_usage(loaded: Load, override: str) -> None:
    with pytest.raises(UsageError) as error:
        loaded(overrides=[override])
    assert str(error.value) == f"override {override!r}: must be key=value, such as seeds=10"


@pytest.mark.parametrize(
    ("overrides", "kept"),
    [
        ([], True),
        (["seed=4", "seeds=7"], True),
        (["seeds=7", "record.steps=none"], False),
        (["name=x"], False),
    ],
)
def test_expected_values_belong_to_the_config_as_written(loaded: Load, overrides: list[str], kept: bool) -> None:
    assert bool(loaded(edited("name: lab", EXPECTED), overrides).expected) is kept


def test_expected_values_that_no_longer_fit_do_not_stop_an_override(loaded: Load) -> None:
    changed = ["experiments.navigation.agents=[mb]", "experiments.visit.modules.navigation=navigation/mb"]
    assert loaded(edited("name: lab", EXPECTED), changed).expected == {}


def test_a_shipped_config_by_its_name(folder) -> None:
    assert load("quickstart", ["seeds=3"]).seeds == 3
    assert config_hash(load("quickstart", ["seeds=3"])) == config_hash(load("quickstart"))
