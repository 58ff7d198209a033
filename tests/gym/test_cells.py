"""One of our agents, driven through an environment, reproduces its cell's log, number for number."""

import gymnasium
import numpy as np
import pytest

import visitlab_cli
import visitlab_cli.gym
from tests.agents.plain_q import PlainQ, PlainQParameters
from visitlab_cli.agents.base import Setting, choose, learn
from visitlab_cli.agents.plain import OWN_RANDOM, STREAM
from visitlab_cli.random_numbers import random_state
from visitlab_cli.storage.run_folder import read_config
from visitlab_cli.world.columns import COLUMNS

SEED = 5
CONFIG = {
    "name": "through",
    "seed": SEED,
    "humans": {"human_2": {"p_S": [0, 0.5, 0.5], "p_H": 0.05, "p_M": 0.05, "p_O": 0.15, "p_A": 0.05}},
    "agents": {"mf": {"kind": "q_learning"}, "mb": {"kind": "model_based", "plan_every": 500}},
    "experiments": {
        "navigation": {"task": "navigation", "agents": ["mf"], "steps": 2000},
        "go_to_human": {"task": "go_to_human", "agents": ["mf"], "steps": 2000, "success": "seen"},
        "social": {"task": "social", "agents": ["mb"], "humans": ["human_2"], "steps": 2000, "arena": 40},
        "visit": {
            "task": "visit",
            "modules": {"navigation": "navigation/mf", "go_to_human": "go_to_human/mf", "social": "social/mb"},
            "humans": ["human_2"],
            "trials": 20,
            "goal_rooms": [0, 4, 8],
        },
    },
}
SETTINGS = {
    "navigation": {},
    "go_to_human": {"success": "seen"},
    "social": {"arena": 40},
    "visit": {"goal_rooms": [0, 4, 8]},
}
NAMES = {"navigation": "Navigation", "go_to_human": "GoToHuman", "social": "Social", "visit": "Visit"}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return visitlab_cli.run(CONFIG, tmp_path_factory.mktemp("runs"))


def played(environment, cell, steps, act, taught):
    """A cell's rows, made through an environment: `act(state, step)`, `taught(...)` after each step."""
    rows, done, reset = [], 0, {"seed": SEED, "options": {"cell": cell}}
    while done < steps:
        state, info = environment.reset(**reset)
        reset, over, step = {}, False, 0
        rows.append({**info, "state": state, "action": 30, "explored": False, "reward": 0.0})
        while not over:
            done, step = done + 1, step + 1
            action, explored = act(state, done)
            after, reward, _, over, info = environment.step(action)
            taught(state, action, info.get("social_reward", reward), after, over, done)
            state = after
            rows.append({**info, "state": state, "action": action, "explored": explored, "reward": reward})
    return rows


def assert_logged(rows, cell):
    logged = cell.steps()
    told = [column.name for column in COLUMNS if column.name in logged and column.name not in ("trial", "step")]
    assert len(rows) == len(logged["state"])
    for name in told:
        np.testing.assert_array_equal([row[name] for row in rows], logged[name], err_msg=name)


@pytest.mark.parametrize("task", list(NAMES))
def test_a_compiled_agent_reproduces_its_log(run, task):
    (cell,) = run.select(experiment=task)
    modules = {name: run.select(experiment=name)[0].model for name in ("navigation", "go_to_human", "social")}
    settings = SETTINGS[task]
    if task == "visit":
        settings = settings | {"modules": {name: modules[name]["q"] for name in ("navigation", "go_to_human")}}
    environment = gymnasium.make(f"visitlab/{NAMES[task]}-v0", full_info=True, **settings).unwrapped
    config = read_config(run.path)
    steps = 2000
    spaces = int(environment.observation_space.n), int(environment.action_space.n)
    setting = Setting(task, *spaces, steps, config.agents)
    if task == "visit":
        visit = config.experiments["visit"]
        agent = visit.restored(visit.parameters_of(config.agents["mb"]), setting, modules["social"])
    else:
        agent = config.agents["mb" if task == "social" else "mf"].create(setting)
    random = environment.random_words
    rows = played(
        environment,
        cell.path,
        steps,
        lambda state, step: choose(agent, state, step, random),
        lambda *told: learn(agent, *told, random),
    )
    assert_logged(rows, cell)
    np.testing.assert_array_equal(random, cell.model["random_state"])
    np.testing.assert_array_equal(agent.q, cell.model["q"])


def test_a_plain_agent_reproduces_its_log(tmp_path, monkeypatch):
    """It draws from a generator of its own; the environment has the cell's stream to itself."""
    from tests.agents import plain_q

    monkeypatch.setenv("VISITLAB_PLUGINS", plain_q.__file__)
    agents = {"mine": {"kind": "plain_q"}}
    experiments = {"social": {"task": "social", "agents": ["mine"], "humans": ["human_2"], "steps": 2000}}
    config = {**CONFIG, "agents": agents, "experiments": experiments}
    (cell,) = visitlab_cli.run(config, tmp_path).cells
    environment = gymnasium.make("visitlab/Social-v0", full_info=True)
    agent = PlainQ(PlainQParameters(kind="plain_q"), Setting("social", 2560, 30, 2000))
    bits = np.random.SFC64()
    words = random_state(SEED, cell.path, STREAM)
    bits.state = {"bit_generator": "SFC64", "state": {"state": words}, "has_uint32": 0, "uinteger": 0}
    generator = np.random.Generator(bits)

    def act(state, step):
        chosen = agent.act(state, generator, step)
        return chosen if isinstance(chosen, tuple) else (chosen, False)

    rows = played(
        environment,
        cell.path,
        2000,
        act,
        lambda state, action, reward, after, end, step: agent.learn(state, action, reward, after, end, generator, step),
    )
    assert_logged(rows, cell)
    np.testing.assert_array_equal(cell.model[OWN_RANDOM][:4], generator.bit_generator.state["state"]["state"])
