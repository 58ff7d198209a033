"""Visits with a controller of their own: the same bytes however they are run, and a log that tells of the plan."""

import pytest

from tests.program import hashes, only_cells, the_run, visitlab
from visitlab_cli.agents.base import Setting
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.loading import load, load_text
from visitlab_cli.config.references import Declared, issues
from visitlab_cli.errors import ConfigError
from visitlab_cli.execution.build import build
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.log.reader import read_steps
from visitlab_cli.log.schema import parts_in
from visitlab_cli.plan.cells import plan
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Role
from visitlab_cli.scene.trial import load_trial
from visitlab_cli.simulation.estimates import RECENT

CONFIG = """
name: leading
seed: 3
humans:
  fast: {p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.05}
  slow: {p_S: [1, 0, 0], p_A: 0.05}
agents:
  rmax: {kind: rmax}
  mb: {kind: model_based}
  script: {kind: scripted}
experiments:
  navigation: {task: navigation, agents: [rmax], steps: 100000}
  go_to_human: {task: go_to_human, agents: [mb], steps: 40000}
  social: {task: social, agents: [script], humans: [fast], steps: 20}
  paper: {task: visit, modules: MODULES, humans: [fast], trials: 11}
  mask: {task: visit, modules: MODULES, humans: [fast], trials: 11, controller: [mask]}
  lead: {task: visit, modules: MODULES, humans: [fast], trials: 11, controller: lead}
  lead_told: {task: visit, modules: MODULES, humans: [fast], trials: 11, controller: lead, told: true}
  in_turn:
    task: visit
    modules: MODULES
    controller: lead
    phases: [{trials: 5, human: fast}, {trials: 8, human: slow}, {trials: 5, human: fast}]
""".replace("MODULES", "{navigation: navigation/rmax, go_to_human: go_to_human/mb, social: social/script}")


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    file = tmp_path_factory.mktemp("leading") / "leading.yaml"
    file.write_text(CONFIG)
    return file


@pytest.fixture(scope="module")
def run(config):
    done = visitlab("run", config, "seeds=2", "--workers", 2, "--out", config.parent / "runs")
    assert done.returncode == 0, done.stderr
    return the_run(config.parent / "runs")


@pytest.mark.slow
def test_one_worker_and_what_is_added_later(run, config, tmp_path):
    for seeds in (1, 2):
        assert visitlab("run", config, f"seeds={seeds}", "--workers", 1, "--out", tmp_path).returncode == 0
    assert only_cells(hashes(the_run(tmp_path))) == only_cells(hashes(run))


@pytest.mark.slow
def test_only_a_plan_is_in_the_log(run):
    logs = {name: run / name / "fast" / "seed-0000" / "steps.mcap" for name in ("paper", "mask", "lead")}
    names = {name: list(read_steps(log)) for name, log in logs.items()}
    assert {name: parts_in(columns) for name, columns in names.items()} == {"paper": (), "mask": (), "lead": ("plan",)}
    assert names["paper"] == names["mask"] == names["lead"][:-5]
    assert b"plan_leads" not in logs["paper"].read_bytes()
    assert b"plan_leads" in logs["lead"].read_bytes()


@pytest.mark.slow
def test_a_plan_is_drawn_while_it_leads(run):
    trial = load_trial(run / "lead" / "fast" / "seed-0000" / "steps.mcap", 3)
    leads = trial.steps["plan_leads"]
    assert leads.any()
    for step, shapes in enumerate(Scene(trial).moments()):
        wanted = {shape.role: shape for shape in shapes if shape.role in (Role.WANTED_HUMAN, Role.WANTED_ROBOT)}
        assert bool(wanted) == leads[step]
        if wanted and step + 1 < trial.length:
            corner = wanted[Role.WANTED_ROBOT].points.min(axis=0)
            assert corner.tolist() == [trial.steps["robot_col"][step + 1], trial.steps["robot_row"][step + 1]]


@pytest.mark.slow
def test_who_is_told_leads_otherwise(run):
    told, estimated = (read_steps(run / name / "fast" / "seed-0000" / "steps.mcap") for name in ("lead_told", "lead"))
    assert any((told[name] != estimated[name]).any() for name in told)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("[mask]", "teleport", "must be paper, lead, route, mask or plan"),
        ("[mask]", "[paper, mask]", "leave it out"),
        ("[mask]", "[]", "must not be empty"),
        ("[mask]", "[mask, mask]", "twice"),
        ("[mask]", "[mask], told: true", "the controller does not plan"),
        ("rmax: {kind: rmax}", "rmax: {kind: q_learning}", "learns a model"),
        ("script: {kind: scripted}", "script: {kind: random}", "can't mask"),
        ("name: leading", "name: leading\ninteraction: {distances: [1, 2, 4, 11]}", "planned up to 10 cells"),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(tmp_path, old, new, told):
    file = tmp_path / "wrong.yaml"
    file.write_text(CONFIG.replace(old, new))
    with pytest.raises(ConfigError, match=told) as refused:
        load(file)
    assert "controller" in str(refused.value) or "told" in str(refused.value)


def test_the_controller_goes_on_with_what_it_knows_where_another_human_comes():
    (cell,) = (each for each in plan(load_text(CONFIG, "leading.yaml")) if each.experiment == "in_turn")
    sizes = {"navigation": ("rmax", 5184, 25), "go_to_human": ("mb", 320, 25)}
    models = {}
    for task, (name, states, actions) in sizes.items():
        agent = cell.config.agents[name]
        models[task] = agent.save(agent.create(Setting(task, states, actions, 1)))
    tasks = [task for task, *_ in build(cell, models | {"social": {}}).stretches]
    assert len({id(task.controller.estimates.speeds) for task in tasks}) == 1
    assert len({id(task.direction_values) for task in tasks}) == 1
    assert tasks[0].world.human == tasks[2].world.human != tasks[1].world.human
    assert len(tasks[0].controller.estimates.recent_moves) == RECENT


def test_who_is_told_is_told_of_each_human_that_has_something_to_tell():
    told = CONFIG.replace("    controller: lead\n", "    controller: lead\n    told: true\n")
    config = load_text(told, "leading.yaml")
    humans = {**config.humans, "slow": HumanParameters()}
    (found,) = issues(Declared(humans, config.agents, config.experiments))
    assert (found.path, found.message) == (
        ("experiments", "in_turn", "phases", 1, "human"),
        "told: slow has no p_S and p_A to tell",
    )


def test_one_controller_has_one_spelling(config):
    def hash_of(controller):
        file = config.with_name("spelled.yaml")
        file.write_text(CONFIG.replace("controller: [mask]", f"controller: {controller}"))
        return config_hash(load(file))

    assert hash_of("mask") == hash_of("[mask]")
    assert hash_of("[mask, route]") == hash_of("[route, mask]")
    assert hash_of("lead") == hash_of("[lead, route, mask]") != hash_of("[route, mask, plan]")
    plain = config.with_name("plain.yaml")
    plain.write_text(CONFIG.replace(", controller: [mask]", ""))
    from_default = config_hash(load(plain))
    assert from_default == hash_of("paper") == hash_of("[paper]")
