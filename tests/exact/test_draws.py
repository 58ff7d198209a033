"""All ways of a kernel's draws: closed forms, and the oracle's reading of the human, of the robot and of a step."""

import itertools
from collections import Counter

import numpy as np
import pytest

from tests.oracle import rules
from tests.oracle.grid import Grid
from visitlab_cli.exact.draws import Ways, outcomes, undecided
from visitlab_cli.humans.six_parameters import SixParameters, random_speed
from visitlab_cli.random_numbers import happens, random_below, random_state
from visitlab_cli.world.enums import Action, Engagement
from visitlab_cli.world.scene import NOWHERE, Body, first_scene, random_direction, related
from visitlab_cli.world.social import make_social, step

ODD = SixParameters(p_S=(0.2, 0.3, 0.5), p_H=0.35, p_M=0.15, p_O=0.25, p_A=0.1, p_P=0.4)
SIDE = 61


def drawn_first(kernel, *others):
    """The outcomes of a kernel whose first argument is the random state."""
    function, ways, found, going = undecided(kernel), Ways(), {}, True
    while going:
        result = function(ways, *others)
        found[result] = found.get(result, 0) + ways.probability
        going = ways.turn()
    return found


def test_a_chance_goes_both_ways():
    assert drawn_first(happens, 0.3) == pytest.approx({True: 0.3, False: 0.7})
    assert drawn_first(happens, 0.0) == {False: 1.0}
    assert drawn_first(happens, 1.0) == {True: 1.0}


def test_a_whole_number_takes_each_value():
    assert drawn_first(random_below, 5) == pytest.approx(dict.fromkeys(range(5), 0.2))
    assert outcomes(random_direction) == dict.fromkeys(range(8), 0.125)


def test_one_number_compared_twice_is_the_same_number():
    assert outcomes(random_speed, ODD.create()) == pytest.approx({1: 0.2, 2: 0.3, 3: 0.5})
    fast = SixParameters(p_S=(0, 0, 1)).create()
    assert outcomes(random_speed, fast) == {3: 1.0}


def scenes(n):
    """Random ones, robot near the human as far as that goes, all engagements."""
    task, random = make_social(ODD.create(), arena=SIDE), np.random.default_rng(5)
    for _ in range(n):
        row, col = (int(each) for each in SIDE // 2 + random.integers(-7, 8, 2))
        robot = Body(row, col, int(random.integers(8)))
        human = Body(SIDE // 2, SIDE // 2, int(random.integers(8)))
        scene = first_scene(task.lab, task.geometry, NOWHERE, robot, human)
        scene = scene._replace(
            engagement=int(random.integers(4)), desired_direction=int(random.integers(8)), goal_room=0
        )
        yield task, related(task.lab, task.geometry, scene)


def by_the_oracle(scene, action, direction_change):
    """The same distribution of (robot, human, engagement, reward, desired direction) in the oracle's reading."""
    grid, human = Grid.with_walls(SIDE, SIDE, []), rules.Human.of(ODD.model_dump())
    cell, human_cell = (scene.robot_row, scene.robot_col), (scene.human_row, scene.human_col)
    if action == Action.GO_TO_HUMAN_VISION and scene.engagement == Engagement.NONE:
        place = rules.teleport_target(grid, human_cell, scene.human_heading)
        robots = {(place, heading): 1 / 8 for heading in range(8)}
    else:
        own = Action.STAY if action == Action.GO_TO_HUMAN_VISION else action
        angle = rules.geometry(cell, scene.robot_heading, human_cell, scene.human_heading).angle
        robots = {rules.robot_after(grid, cell, scene.robot_heading, own, angle): 1.0}
    humans = rules.human_step(
        grid, cell, scene.robot_heading, human_cell, scene.human_heading, scene.engagement, action, human
    )
    found = Counter()
    for (robot, p), (reaction, q), new in itertools.product(robots.items(), humans.items(), range(8)):
        reward = rules.social_reward(reaction.engagement, reaction.action, scene.desired_direction)
        r = direction_change / 8 + (1 - direction_change) * (new == scene.desired_direction)
        found[robot, reaction.cell, reaction.heading, reaction.engagement, reward, new] += p * q * r
    return found


def by_the_world(task, scene, action):
    found = Counter()
    for (after, reward, _), p in outcomes(step, task, scene, action).items():
        robot, human = (after.robot_row, after.robot_col), (after.human_row, after.human_col)
        place = (robot, after.robot_heading), human, after.human_heading
        found[(*place, after.engagement, int(reward), after.desired_direction)] += p
    return found


@pytest.mark.parametrize(
    "action",
    [Action.MOVE_2_NORTH_EAST, Action.LOOK, Action.HELLO, Action.COME, Action.POINT, Action.GO_TO_HUMAN_VISION],
)
def test_a_step_has_the_outcomes_that_the_oracle_gives_it(action):
    for task, scene in scenes(3 if action == Action.GO_TO_HUMAN_VISION else 8):
        ours, theirs = by_the_world(task, scene, int(action)), by_the_oracle(scene, int(action), task.direction_change)
        assert {outcome for outcome, p in theirs.items() if p > 0} == set(ours)
        assert dict(ours) == pytest.approx({outcome: p for outcome, p in theirs.items() if p > 0}, abs=1e-12)


def test_sampled_steps_fall_as_often_as_was_said():
    random = random_state(4)
    for task, scene in scenes(2):
        expected, n = outcomes(step, task, scene, Action.HELLO.value), 4000
        seen = Counter(step(task, scene, Action.HELLO.value, random) for _ in range(n))
        assert set(seen) <= set(expected)
        common = [outcome for outcome, p in expected.items() if p * n >= 5]
        for outcome in common:
            p = expected[outcome]
            assert abs(seen[outcome] - n * p) < 5 * np.sqrt(n * p * (1 - p)) + 1e-9
