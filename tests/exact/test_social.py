"""The social task's optimum: against a tree of all outcomes, what is known of the paper's humans, and by playing it."""

import math

import numpy as np
import pytest

from tests.exact.test_draws import ODD
from visitlab_cli.exact import social
from visitlab_cli.exact.draws import outcomes
from visitlab_cli.exact.social import mean_over_starts, model_of, optimum, random_reward
from visitlab_cli.exact.social_induction import Induction, direction_blind, shape_of
from visitlab_cli.exact.social_model import social_model
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.enums import N_SOCIAL_ACTIONS, Engagement
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.scene import NOWHERE, Body, first_scene, related
from visitlab_cli.world.social import begin_trial, make_social, step

HUMAN_2 = SixParameters(p_S=(0, 0.5, 0.5), p_H=0.05, p_M=0.05, p_O=0.15, p_A=0.05)
PAPER = {
    "human_1": (SixParameters(p_S=(1, 0, 0), p_M=0.1, p_O=0.1), 12.44),
    "human_2": (HUMAN_2, 9.83),
    "human_2_pointing": (HUMAN_2.model_copy(update={"p_P": 1.0}), 8.75),
    "human_3": (SixParameters(p_S=(0.33, 0.33, 0.34), p_H=0.5, p_M=0.2, p_O=0.3, p_A=0.1, p_P=0.5), 6.32),
}
CALM = SixParameters(p_S=(0, 0.4, 0.6), p_H=0.3, p_A=0.2, p_P=0.3)
"""One of few outcomes."""
SIDE, CHANGE = 61, 0.2


@pytest.fixture(scope="module")
def calm():
    return model_of(CALM, 0.0, DISTANCES)


def place_of(model, scene):
    """Where its values are: (state of one robot's heading, robot's heading, direction)."""
    row, col = (
        int(np.clip(robot - human, -model.reach, model.reach)) + model.reach
        for robot, human in ((scene.robot_row, scene.human_row), (scene.robot_col, scene.human_col))
    )
    place = scene.engagement, scene.human_heading, row, col
    return int(np.ravel_multi_index(place, shape_of(model)[:-1])), scene.robot_heading, scene.desired_direction


def tree(task, scene, steps, choose, known):
    """The value of a scene by the whole tree of the task's own steps."""
    if steps == 0:
        return 0.0
    key = scene._replace(executed_action=0, human_action=0), steps
    if key not in known:
        worth = [
            sum(
                p * (reward + tree(task, after, steps - 1, choose, known))
                for (after, reward, _), p in outcomes(step, task, scene, action).items()
            )
            for action in range(N_SOCIAL_ACTIONS)
        ]
        known[key] = choose(worth)
    return known[key]


STARTS = [(2, 3, 6, 7, Engagement.GREETED, 2), (-2, 0, 1, 6, Engagement.FOLLOWING, 1), (6, 1, 0, 4, Engagement.NONE, 5)]


@pytest.mark.parametrize("start", STARTS)
def test_two_steps_are_worth_what_the_whole_tree_says(calm, start):
    task = make_social(CALM.create(), arena=SIDE, direction_change=0.0)
    row, col, robot, human, engagement, desired = start
    middle = SIDE // 2
    scene = first_scene(
        task.lab, task.geometry, NOWHERE, Body(middle + row, middle + col, robot), Body(middle, middle, human)
    )
    scene = related(
        task.lab, task.geometry, scene._replace(engagement=int(engagement), desired_direction=desired, goal_room=0)
    )
    *_, (values, _) = Induction(calm).optimal(2)
    assert values[place_of(calm, scene)] == pytest.approx(tree(task, scene, 2, max, {}), abs=1e-12)
    chance = Induction(calm).random(2)
    assert chance[place_of(calm, scene)] == pytest.approx(tree(task, scene, 2, np.mean, {}), abs=1e-12)


@pytest.mark.slow
def test_farther_offsets_change_nothing(calm):
    farther = social_model(CALM.create(), DISTANCES, calm.reach + 2, 0.0)
    found = []
    for model in (calm, farther):
        *_, (values, _) = Induction(model).optimal(6)
        found.append(mean_over_starts(model, values, 120))
    assert found[0] == pytest.approx(found[1], abs=1e-12)
    assert found[0] > 0.1


def test_random_actions_need_not_see_the_direction(calm):
    whole = mean_over_starts(calm, Induction(calm).random(5), 120)
    assert mean_over_starts(calm, Induction(direction_blind(calm)).random(5), 120) == pytest.approx(whole)


@pytest.mark.slow
def test_the_same_twice(calm):
    first, second = ([each for each in Induction(calm).optimal(4)][-1] for _ in range(2))
    assert (first[0] == second[0]).all()
    assert (first[1] == second[1]).all()


def played(human, steps, trials, seed):
    """Rewards of trials in the simulator with the best actions, and what was promised on average."""
    model, task, random = model_of(human, CHANGE, DISTANCES), make_social(human.create(), steps), random_state(seed)
    induction = list(Induction(model).optimal(steps))
    rewards = np.zeros(trials)
    for trial in range(trials):
        scene = begin_trial(task, NOWHERE, random)
        for _, actions in reversed(induction):
            scene, reward, _ = step(task, scene, int(actions[place_of(model, scene)]), random)
            rewards[trial] += reward
    return rewards, mean_over_starts(model, induction[-1][0], task.lab.rows)


@pytest.mark.slow
def test_the_best_actions_earn_what_is_promised():
    rewards, promised = played(ODD, 8, 800, 3)
    assert abs(rewards.mean() - promised) < 4.5 * rewards.std() / math.sqrt(len(rewards))


@pytest.mark.slow
@pytest.mark.parametrize("name", PAPER)
def test_the_papers_humans(name):
    human, expected = PAPER[name]
    found = optimum(human)
    assert found == pytest.approx(expected, abs=0.005)
    rewards, promised = played(human, 20, 30_000, 1)
    assert promised == pytest.approx(found, abs=1e-9)
    assert abs(rewards.mean() - found) < 4 * rewards.std() / math.sqrt(len(rewards))


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("VISITLAB_CACHE", str(tmp_path / "cache"))
    social._value.cache_clear()
    yield tmp_path / "cache"
    social._value.cache_clear()


def test_what_was_computed_is_kept_and_only_for_the_same_question(own_cache, monkeypatch):
    first = optimum(CALM, trial_steps=3)
    other = optimum(CALM, trial_steps=3, direction_change=0.0)
    (folder,) = own_cache.iterdir()
    assert len(list(folder.iterdir())) == 2
    social._value.cache_clear()
    monkeypatch.setattr(social, "model_of", None)
    assert (optimum(CALM, trial_steps=3), optimum(CALM, trial_steps=3, direction_change=0.0)) == (first, other)
    for changed in (CALM.model_copy(update={"p_A": 0.21}), CALM.model_copy(update={"p_M": 0.01})):
        with pytest.raises(TypeError):
            optimum(changed, trial_steps=3)
    with pytest.raises(TypeError):
        random_reward(CALM, trial_steps=3)


@pytest.mark.parametrize("damage", [lambda data: data[: len(data) // 2], lambda data: data.replace(b"0x1.", b"0x1.1")])
def test_a_damaged_value_is_computed_anew(own_cache, damage):
    first = optimum(CALM, trial_steps=3)
    (file,) = [file for folder in own_cache.iterdir() for file in folder.iterdir()]
    whole = file.read_bytes()
    file.write_bytes(damage(whole))
    assert file.read_bytes() != whole
    social._value.cache_clear()
    assert optimum(CALM, trial_steps=3) == first
    assert file.read_bytes() == whole


@pytest.mark.parametrize(
    ("settings", "word"),
    [({"arena": 100}, "border"), ({"trial_steps": 201, "arena": 9000}, "200"), ({"distances": (1, 2, 4, 13)}, "12")],
)
def test_where_it_is_not_known_it_says_why(settings, word):
    with pytest.raises(ValueError, match=word):
        optimum(HUMAN_2, **settings)
