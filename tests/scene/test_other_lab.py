"""A lab that is not the paper's: 2 x 3 rooms of 5 x 4 cells, drawn, told of, played in and solved."""

import math

import numpy as np
import pytest

from tests.scene.test_scene import by_role
from tests.scene.test_words import BEGIN, visit
from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.greedy_table import GreedyTable
from visitlab_cli.agents.q_learning import QLearningParameters
from visitlab_cli.agents.uniform_random import UniformRandom
from visitlab_cli.errors import RunError
from visitlab_cli.exact.go_to_human import go_to_human_random
from visitlab_cli.exact.navigation import navigation_optimal_q, navigation_optimum, navigation_random
from visitlab_cli.log.reader import check_values
from visitlab_cli.random_numbers import random_state
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Role
from visitlab_cli.scene.sight import REACH
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import caption
from visitlab_cli.simulation.loop import START, play
from visitlab_cli.world.columns import empty_columns
from visitlab_cli.world.enums import Direction
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.go_to_human import make_go_to_human
from visitlab_cli.world.lab import make_lab
from visitlab_cli.world.navigation import make_navigation
from visitlab_cli.world.tasks import TASKS, VISIT

LAB = make_lab(10, 12, rooms=np.arange(10)[:, None] // 5 * 3 + np.arange(12) // 4)
TRIAL_STEPS = 20


@pytest.fixture
def trial(tmp_path):
    """The human stands in room 5, the goal, before the first step; the next goal is room 1."""
    begin = BEGIN | {"robot_row": 8, "robot_col": 7, "human_row": 9, "human_col": 11, "goal_room": 5}
    stays = {"human_row": 9, "human_col": 11, "robot_row": 8, "robot_col": 7}
    steps = visit(begin, stays | {"reward": 1, "goal_room": 1}, stays | {"goal_room": 1})
    headings = {f"{who}_heading": np.full(len(steps["step"]), Direction.SOUTH) for who in ("robot", "human")}
    return Trial(tmp_path, "visit", VISIT, 0, {**steps, **headings}, LAB, DISTANCES)


def test_its_rooms_are_where_they_are(trial):
    scene = Scene(trial)
    place, first = by_role(scene.place()), by_role(scene.moment(1))
    assert [room.text for room in place[Role.ROOM]] == [f"Room {number}" for number in range(6)]
    assert [room.corner.tolist() for room in place[Role.ROOM]] == [[x, y] for y in (0, 5) for x in (0, 4, 8)]
    assert {tuple(room.size.tolist()) for room in place[Role.ROOM]} == {(4, 5)}
    assert place[Role.FLOOR][0].size.tolist() == [12, 10]
    assert scene.view == ((-0.6, 12.6), (-0.6, 10.6))
    (goal,), (reached,), (cloth,) = first[Role.GOAL], first[Role.REACHED], first[Role.CLOTH]
    assert (goal.corner.tolist(), reached.corner.tolist()) == ([4, 0], [8, 5])
    assert (goal.corner <= cloth.points).all()
    assert (cloth.points <= goal.corner + goal.size).all()
    (sight,) = first[Role.SIGHT]
    assert not sight.cells[REACH + 1 :].any(), "nothing south of the last row"
    assert not sight.cells[:, REACH + 1 :].any(), "nothing east of the last column"


def test_words_know_who_began_in_the_goal_room(trial):
    assert caption(trial.steps, 1, LAB).endswith("the human began in goal Room 5, the next is Room 1")


def test_the_strip_is_drawn_as_wide_and_high_as_the_lab(trial, tmp_path):
    pytest.importorskip("matplotlib")
    from visitlab_cli.replay.strip import draw_strip, save_strip

    axes = draw_strip(trial, [0, 1]).axes[0]
    assert (axes.get_xlim(), axes.get_ylim()) == ((-0.6, 12.6), (10.6, -0.6))
    save_strip(trial, tmp_path / "strip.svg")
    drawn = (tmp_path / "strip.svg").read_text()
    assert [f"<!-- Room {number} -->" in drawn for number in range(9)] == [True] * 6 + [False] * 3


@pytest.mark.parametrize(("column", "value"), [("robot_row", 10), ("human_col", 12), ("goal_room", 6), ("state", 2560)])
def test_what_it_does_not_have_is_refused(trial, column, value):
    check_values(trial.path, dict(trial.steps), trial.task, LAB)
    with pytest.raises(RunError, match=f"has {column} {value}, which there is not"):
        check_values(trial.path, trial.steps | {column: np.full(3, value)}, trial.task, LAB)


def played(task, agent, trials, seed=3):
    """Reward of each trial, and the log's columns."""
    rewards, columns = np.zeros(trials), empty_columns(trials * (TRIAL_STEPS + 1))
    play(task, agent, START, trials * TRIAL_STEPS, random_state(seed), columns, rewards)
    return rewards, columns


def assert_close(rewards, exact):
    assert abs(rewards.mean() - exact) < 4.5 * rewards.std() / math.sqrt(len(rewards))


def test_navigation_is_learned_in_it():
    size = TASKS["navigation"].size(LAB)
    assert size == (6 * 10 * 12, 25)
    parameters = QLearningParameters(kind="q_learning")
    agent = parameters.create(Setting("navigation", *size, 4_000 * TRIAL_STEPS))
    rewards, columns = played(make_navigation(TRIAL_STEPS, LAB), agent, 4_000)
    assert agent.q.shape == tuple(size)
    assert [columns.robot_row.max(), columns.robot_col.max(), columns.goal_room.max()] == [9, 11, 5]
    assert navigation_random(TRIAL_STEPS, LAB) < rewards[:200].mean() < rewards[-200:].mean()
    assert rewards[-200:].mean() > 0.85 * navigation_optimum(TRIAL_STEPS, LAB), "which explores one step in twenty"


def test_its_exact_values_are_those_of_long_simulation():
    best = GreedyTable(navigation_optimal_q(0.9, LAB).copy())
    assert_close(played(make_navigation(TRIAL_STEPS, LAB), best, 5_000)[0], navigation_optimum(TRIAL_STEPS, LAB))
    task = make_go_to_human(TRIAL_STEPS, lab=LAB)
    chance = UniformRandom(np.zeros(TASKS["go_to_human"].size(LAB)))
    assert_close(played(task, chance, 20_000)[0], go_to_human_random(TRIAL_STEPS, lab=LAB))
