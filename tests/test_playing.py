"""`visitlab_cli.make_task`: the tasks from Python, as a run plays them."""

import re

import numpy as np
import pytest

import visitlab_cli
from visitlab_cli import Action
from visitlab_cli.errors import UsageError
from visitlab_cli.log.reader import read_steps
from visitlab_cli.random_numbers import random_state

HUMAN = {"p_S": [0, 0.5, 0.5], "p_H": 0.2, "p_M": 0.2, "p_O": 0.2, "p_A": 0.05, "p_P": 0.05}
TABLES = {"navigation": np.zeros((5184, 25)), "go_to_human": np.zeros((320, 25))}
MADE = {
    "navigation": {},
    "go_to_human": {"success": "seen"},
    "social": {"human": HUMAN, "arena": 30},
    "visit": {"human": HUMAN, "tables": TABLES, "goal_rooms": [0, 8]},
}


@pytest.mark.parametrize("name", MADE)
def test_a_trial_is_played_within_the_task(name):
    task = visitlab_cli.make_task(name, trial_steps=30, **MADE[name])
    random = task.random(3)
    scene = task.begin(random)
    assert (scene.executed_action, scene.engagement) == (Action.NO_ACTION, 0)
    for action in np.random.default_rng(0).integers(0, task.n_actions, task.trial_steps):
        assert 0 <= task.observe(scene) < task.n_states
        scene, reward = task.step(scene, action, random)
        assert reward in (0.0, 1.0)
    assert max(scene.robot_row, scene.robot_col) < (30 if name == "social" else 24)
    assert name != "visit" or scene.goal_room in (0, 8)


def test_the_same_seed_is_the_same_trial_and_another_one_another():
    task = visitlab_cli.make_task("social", human=HUMAN)

    def played(seed):
        random = task.random(seed)
        scenes = [task.begin(random)]
        for _ in range(20):
            scenes.append(task.step(scenes[-1], Action.GO_TO_HUMAN_VISION, random)[0])
        return scenes

    assert played(1) == played(1) != played(2)


def test_it_plays_what_a_run_logged(tiny_run):
    """By the scripted agent, which draws nothing from the cell's stream."""
    cell = "social/script/fast/seed-0000"
    run = visitlab_cli.load(tiny_run)
    steps = read_steps(tiny_run / cell / "steps.mcap")
    task = visitlab_cli.make_task("social", human=run.config["humans"]["fast"])
    random, scene = random_state(run.config["seed"], cell, "simulation"), None
    for row in range(200):
        if steps["step"][row] == 0:
            scene = task.begin(random) if scene is None else task.begin(random, scene)
        else:
            scene, reward = task.step(scene, steps["action"][row], random)
            assert reward == steps["reward"][row]
        for name in ("robot_row", "robot_col", "human_row", "human_heading", "desired_direction", "human_action"):
            assert getattr(scene, name) == steps[name][row]
        assert task.observe(scene) == steps["state"][row]


@pytest.mark.parametrize(
    ("name", "settings", "told"),
    [
        ("socal", {}, r"^socal: no such task; did you mean social\?$"),
        ("social", {}, "^human: must be given in social$"),
        ("navigation", {"human": HUMAN}, "^human: there is none in navigation$"),
        ("social", {"human": {**HUMAN, "p_h": 1}}, r"^human.p_h: unknown; did you mean p_H\?$"),
        ("social", {"human": HUMAN, "arena": 1, "trial_steps": 0}, r"^arena: .*\(got 1\)\ntrial_steps: .*\(got 0\)$"),
        ("social", {"human": HUMAN, "aren": 9}, r"^aren: no setting of social; did you mean arena\?$"),
        ("visit", {"human": HUMAN}, r"^tables: must have navigation of shape \(5184, 25\) and go_to_human of shape"),
        ("go_to_human", {"distances": [4, 3, 2, 1]}, "^distances: must increase$"),
        ("navigation", {"trial_steps": object()}, "^settings must be plain values"),
    ],
)
def test_what_is_wrong_is_told_by_the_name_of_the_argument(name, settings, told):
    with pytest.raises(UsageError, match=told):
        visitlab_cli.make_task(name, **settings)


@pytest.mark.parametrize("action", [-1, 25, 1.5, "1", None, True, 10**30])
def test_an_action_that_there_is_not(action):
    task = visitlab_cli.make_task("navigation")
    random = task.random(0)
    with pytest.raises(UsageError, match=f"^action {action}: navigation has 0 to 24$"):
        task.step(task.begin(random), action, random)


@pytest.mark.parametrize("lab", [5, ["AAaB"], 0.5])
def test_what_is_no_lab_is_told_as_such(lab):
    with pytest.raises(UsageError, match="lab: must be a mapping, as under labs in a config, or a map"):
        visitlab_cli.make_task("navigation", lab=lab)


@pytest.mark.parametrize("action", [np.array([3]), np.array(1.0), [3]])
def test_an_array_of_one_action_is_none(action):
    task = visitlab_cli.make_task("navigation")
    random = task.random(0)
    with pytest.raises(UsageError, match=r"^action .*: navigation has 0 to 24$"):
        task.step(task.begin(random), action, random)


@pytest.mark.parametrize("seed", [-1, 1.5, "1", None])
def test_a_seed_is_a_whole_number(seed):
    with pytest.raises(UsageError, match=r"^seed .*: must be a whole number, at least 0$"):
        visitlab_cli.make_task("navigation").random(seed)


NO_TABLES = {
    "some that are not finite": np.full((5184, 25), np.nan),
    "complex128": np.zeros((5184, 25), complex),
    "object": [[1], [1, 2]],
    "<U1": "x",
    "(3, 25)": np.zeros((3, 25)),
}


@pytest.mark.parametrize("got", NO_TABLES)
def test_what_is_no_table_of_finite_numbers_is_told_as_such(got):
    line = f"tables: the Q of navigation must be finite numbers of shape (5184, 25) (got {got})"
    with pytest.raises(UsageError, match=f"^{re.escape(line)}$"):
        visitlab_cli.make_task("visit", human=HUMAN, tables={**TABLES, "navigation": NO_TABLES[got]})


@pytest.mark.parametrize(
    ("name", "settings", "told"),
    [
        ("social", {"human": "human_2"}, r"^human: must be a mapping, as under humans in a config \(got 'human_2'\)$"),
        ("social", {"human": HUMAN, "distances": 3}, "^distances: must be a list"),
        (
            "visit",
            {"human": HUMAN, "tables": TABLES, "goal_rooms": None},
            "^goal_rooms: must be all or a list of rooms",
        ),
        ("visit", {"human": HUMAN, "tables": [1]}, "^tables: must have navigation of shape"),
    ],
)
def test_an_argument_of_another_type_is_told_by_its_name(name, settings, told):
    with pytest.raises(UsageError, match=told):
        visitlab_cli.make_task(name, **settings)
