"""A visit that begins with what several trainings have learned, and a robot that is told that another human comes."""

import json

import numpy as np
import pytest

from tests.execution.test_phases import HUMANS
from tests.program import the_run, visitlab
from visitlab_cli.affordances.counts import learned_counts
from visitlab_cli.affordances.learned import affordances
from visitlab_cli.agents.base import Setting
from visitlab_cli.config.loading import load, load_text
from visitlab_cli.errors import ConfigError
from visitlab_cli.log.reader import read_steps
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.evaluation import Evaluation
from visitlab_cli.plan.saved import unsound
from visitlab_cli.plan.selection import Selection
from visitlab_cli.results.metrics import Part, metrics_of
from visitlab_cli.results.own_models import active_models, met
from visitlab_cli.storage.arrays import read_model

MODULES = "navigation: navigation/rmax, go_to_human: go_to_human/mb"
POOL = "pool: [social/mb/fast, social/mb/still], prior_strength: 5"
CONFIG = f"""
name: pools
seed: 5
humans: {HUMANS}
agents:
  mb: {{kind: model_based, plan_every: 200}}
  light: {{kind: model_based, plan_every: 200, prior_strength: 3}}
  mirror: {{kind: model_based, plan_every: 200, symmetric: true, unvisited: zero}}
  mf: {{kind: q_learning}}
  rmax: {{kind: rmax, plan_every: 200}}
  multi: {{kind: multi_model, plan_every: 200}}
experiments:
  navigation: {{task: navigation, agents: [rmax], steps: 800}}
  go_to_human: {{task: go_to_human, agents: [mb], steps: 800}}
  social: {{task: social, agents: [mb, light, mirror, mf, multi], humans: [fast, still], steps: 1200}}
  pooled:
    task: visit
    modules: {{{MODULES}, social: {{{POOL}}}}}
    trials: 5
    humans: [fast]
  mirrored:
    task: visit
    modules: {{{MODULES}, social: {{pool: [social/mirror/fast, social/mirror/still]}}}}
    trials: 5
    humans: [fast]
  in_turn:
    task: visit
    modules: {{{MODULES}, social: social/light/fast}}
    phases: [{{trials: 20, human: fast}}, {{trials: 1, human: still}}]
  several:
    task: visit
    modules: {{{MODULES}, social: {{pool: [social/multi/fast, social/multi/still]}}}}
    phases: [{{trials: 5, human: fast}}, {{trials: 5, human: still}}]
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pools")
    (folder / "pools.yaml").write_text(CONFIG)
    visitlab("run", folder / "pools.yaml", "--out", folder / "runs", "--workers", "2", "--quiet")
    return the_run(folder / "runs")


def test_all_of_it_is_done_and_sound(run):
    cells = plan(load(run / "config.yaml"))
    assert [found for cell in cells if (found := unsound(run, cell))] == []


def test_it_began_with_what_both_have_learned_as_one(run):
    config = load_text(CONFIG, "pools.yaml")
    agent = config.agents["mb"]
    both = [read_model(run / f"social/mb/{human}/seed-0000/model.npz") for human in HUMANS]
    began = agent.pooled(Setting("social", 2560, 30, 1), both, 5)
    ended = read_model(run / "pooled/fast/seed-0000/model.npz")
    assert ended["visits"].sum() == pytest.approx(began["visits"].sum() + 5 * 100)
    assert (ended["visits"] >= began["visits"]).all()
    assert {cell.path: cell for cell in plan(config)}["pooled/fast/seed-0000"].modules == {
        "navigation": "navigation/rmax/seed-0000",
        "go_to_human": "go_to_human/mb/seed-0000",
        "social": "social/mb/fast/seed-0000",
        "social 2": "social/mb/still/seed-0000",
    }


def test_a_phase_with_another_human_finds_old_counts_lighter(run):
    """The last trial of a hundred steps is all that may lie above."""
    visits = read_model(run / "in_turn/phases/seed-0000/model.npz")["visits"]
    assert np.maximum(visits - 3, 0).sum() <= 100
    assert visits.max() > 3


def test_affordances_show_what_a_visit_begins_with_and_that_a_module_is_one_of_a_pool(run):
    config = load(run / "config.yaml")
    both = [read_model(run / f"social/mb/{human}/seed-0000/model.npz") for human in HUMANS]
    began = config.agents["mb"].pooled(Setting("social", 2560, 30, 1), both, 5)
    found = affordances(run, plan(config), Selection(experiment="pooled"))
    assert (found.cell.path, found.adaptations, found.cell.humans) == ("pooled/fast/seed-0000", [], ("fast",))
    assert (found.knows.visits == np.rint(learned_counts(began).sum(axis=(2, 3)))).all()
    told = json.loads(visitlab("affordances", run, "--experiment", "pooled", "--json").stdout)["trained"]
    assert told["pool"] == ["social/mb/fast/seed-0000", "social/mb/still/seed-0000"]
    text = visitlab("affordances", run).stdout.splitlines()
    assert text[0] == "social/mb/fast/seed-0000, learned with fast"
    assert text[-1] == "It is one of 2 that pooled/fast begins with as one: --experiment pooled shows that."
    (line, *_) = visitlab("affordances", run, "--experiment", "in_turn").stdout.splitlines()
    assert line == "social/light/fast/seed-0000, learned with fast"
    several = visitlab("affordances", run, "--experiment", "several")
    assert (several.returncode, several.stdout.count(" true\n")) == (0, 1)


def test_frozen_it_plays_by_the_pool_and_with_another_module_without(run):
    visitlab("eval", run, "--frozen", "--experiment", "pooled", "--workers", "1", "--quiet")
    config = load(run / "config.yaml")
    (cell,) = (cell for cell in plan(config, Evaluation(frozen=True)) if cell.experiment == "pooled")
    assert unsound(run, cell) is None
    (other,) = (cell for cell in plan(config, Evaluation(social="social/mb/still")) if cell.experiment == "pooled")
    assert other.modules["social"] == "social/mb/still/seed-0000"
    assert "social 2" not in other.modules


@pytest.mark.parametrize(
    ("pool", "line"),
    [
        ("pool: [social/mb/fast]", "social.pool: must have at least 2 entries (got 1)"),
        ("pool: [social/mb/fast, social/mb/fast]", "social.pool: has social/mb/fast twice"),
        (
            "pool: [social/mb/fast, social/mb/stil]",
            "social.pool.1: social does not train with stil; did you mean still?",
        ),
        (
            "pool: [social/mb/fast, navigation/mb]",
            "social.pool.1: navigation has the task navigation; needed is social",
        ),
        ("pool: [social/mb/fast, social/mb]", "social.pool.1: say with which human"),
        ("pool: [social/mb/fast, social/mirror/still]", "social.pool.1: mb and mirror can't be one: of the two only"),
        ("pool: [social/mb/fast, social/multi/still]", "social.pool.1: is of kind multi_model, mb of kind model_based"),
        ("pool: [social/mf/fast, social/mf/still]", "social.pool.0: an agent of kind q_learning can't be put together"),
        ("pool: [social/mb/fast, social/mb/still], prior_strength: 0", "social.prior_strength: must be at least 1"),
        (
            "pool: [social/mb/fast, social/mb/still], prior_strength: null",
            "social.prior_strength: must be a number (got nothing; left out it is 20)",
        ),
        ("pool: [social/mb/fast, social/mb/still], strength: 2", "social.strength: unknown"),
        ("prior_strength: 5", "social.pool: missing"),
    ],
)
def test_each_mistake_has_its_line(pool, line):
    with pytest.raises(ConfigError) as told:
        load_text(CONFIG.replace(POOL, pool), "pools.yaml")
    assert f"experiments.pooled.modules.{line}" in str(told.value)
    assert "\n" not in str(told.value)


def test_the_log_and_the_metrics_tell_which_model_is_active(run):
    (cell,) = (each for each in plan(load(run / "config.yaml")) if each.experiment == "several")
    steps = read_steps(run / cell.path / "steps.mcap", ["step", "active_model", "evidence"])
    active = active_models(read_model(run / cell.path / "model.npz"), cell.steps)
    told = steps["active_model"][steps["step"] > 0]
    # a step's row says what is active after it, so that the next one is chosen by that
    assert np.array_equal(told[:-1], active[1:])
    assert steps["evidence"].max() > 0
    parts = metrics_of(run, cell, first=2)
    for phase in met(cell, read_model(run / cell.path / "model.npz")):
        assert parts[Part(cell.humans.index(phase.human), "first 2")]["own_model"] == phase.own[:200].mean()
    plain = next(each for each in plan(load(run / "config.yaml")) if each.experiment == "pooled")
    assert "active_model" not in read_steps(run / plain.path / "steps.mcap")
