"""The belief about hidden engagement: against the world's own rules run in all ways, and EM against what is true."""

import numpy as np
import pytest

from tests.exact.test_draws import ODD, scenes
from tests.world.package_log import HUMAN, make_agent
from visitlab_cli.exact.draws import outcomes
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.random_numbers import random_state
from visitlab_cli.simulation.loop import START, play
from visitlab_cli.world.belief import (
    EVENTS,
    LOSSES,
    MOVES,
    P_A,
    P_H,
    P_M,
    P_O,
    P_P,
    begin,
    follow,
    learn_parameters,
    make_belief,
    transition,
)
from visitlab_cli.world.columns import empty_columns
from visitlab_cli.world.enums import Action
from visitlab_cli.world.geometry import is_appropriate
from visitlab_cli.world.human import react
from visitlab_cli.world.perception import Sights, level_in_sight
from visitlab_cli.world.scene import Body, next_scene
from visitlab_cli.world.social import make_social, parts_of

GIVEN = [*ODD.p_S, ODD.p_H, ODD.p_M, ODD.p_O, ODD.p_A, ODD.p_P]
ACTIONS = [Action.HELLO, Action.COME, Action.POINT, Action.STAY, Action.LOOK, Action.MOVE_2_EAST]


def by_the_world(task, scene, action, seen):
    """P(e', what was seen | e), shape (4, 4), of the world's own human, in all ways that its draws can fall."""
    found = np.zeros((4, 4))
    for engagement in range(4):
        of_it = scene._replace(engagement=engagement)
        for reaction, chance in outcomes(react, task.human, task.lab, task.geometry, of_it, int(action)).items():
            if (reaction.human_row, reaction.human_col, reaction.human_heading) == seen:
                found[engagement, reaction.engagement] += chance
    return found


def steps(n):
    """Random scenes, an action in each, and one of the ways in which the human may react to it."""
    rng = np.random.default_rng(11)
    for number, (task, scene) in enumerate(scenes(n)):
        action = int(ACTIONS[number % len(ACTIONS)])
        ways = outcomes(react, task.human, task.lab, task.geometry, scene, action)
        reaction = list(ways)[int(rng.integers(len(ways)))]
        robot = Body(scene.robot_row, scene.robot_col, scene.robot_heading)
        yield task, scene, action, reaction, next_scene(task.lab, task.geometry, scene, robot, action, reaction)


def test_a_step_of_the_filter_is_bayes_rule_with_the_worlds_own_human():
    rng = np.random.default_rng(3)
    for task, scene, action, reaction, after in steps(24):
        belief = make_belief(GIVEN)
        belief.now[:] = rng.dirichlet(np.ones(4))
        seen = reaction.human_row, reaction.human_col, reaction.human_heading
        expected = belief.now @ by_the_world(task, scene, action, seen)
        follow(belief, task.lab, scene, after, level_in_sight(task.lab, task.geometry, scene))
        np.testing.assert_allclose(belief.now, expected / expected.sum(), atol=1e-12)


def test_transitions_are_chances():
    for level in range(5):
        for action in ACTIONS:
            for near in (True, False):
                for engagement in range(4):
                    ways = [transition(np.array(GIVEN), engagement, to, int(action), near, level) for to in range(4)]
                    assert sum(chance for chance, _ in ways) == pytest.approx(1)
                    assert all(0 <= lost <= chance for chance, lost in ways)


def test_the_expected_number_of_losses_is_that_over_all_pasts():
    """An episode of a few steps, each past of engagements told apart, weighed by the world's own human."""
    episode = [each for each in steps(120) if is_appropriate(each[1].distance)][:5]
    belief = make_belief(GIVEN)._replace(learns=True)
    begin(belief)
    pasts = {(0,): 1.0}
    for task, scene, action, reaction, after in episode:
        seen = reaction.human_row, reaction.human_col, reaction.human_heading
        joint = by_the_world(task, scene, action, seen)
        pasts = {
            (*past, to): weight * joint[past[-1], to]
            for past, weight in pasts.items()
            for to in range(4)
            if joint[past[-1], to] > 0
        }
        follow(belief, task.lab, scene, after, level_in_sight(task.lab, task.geometry, scene))
    total = sum(pasts.values())
    ends = [sum(weight for past, weight in pasts.items() if past[-1] == end) / total for end in range(4)]
    np.testing.assert_allclose(belief.now, ends, atol=1e-12)
    chances = sum(weight * sum(each > 0 for each in past[:-1]) for past, weight in pasts.items()) / total
    assert belief.now @ belief.sums[:, LOSSES + 1] == pytest.approx(chances, abs=1e-12)
    idle = sum(weight * sum(each == 0 for each in past[1:]) for past, weight in pasts.items()) / total
    assert belief.now @ belief.sums[:, MOVES + 1] == pytest.approx(idle, abs=1e-12)


def played(perception, steps_played, human=HUMAN, seed=0):
    task = make_social(SixParameters(**human).create(), perception=perception)
    trials = steps_played // task.trial_steps
    columns = empty_columns(steps_played + trials)
    play(task, make_agent("social"), START, steps_played, random_state(seed), columns, np.zeros(trials))
    return columns


def test_em_finds_the_parameters_from_what_is_seen():
    belief = make_belief()
    columns = played(belief, 200_000)
    learn_parameters(belief)
    true = [*HUMAN["p_S"], *(HUMAN[f"p_{name}"] for name in "HMOAP")]
    np.testing.assert_allclose(belief.parameters, true, atol=0.03)
    assert (P_H, P_M, P_O, P_A, P_P) == (3, 4, 5, 6, 7)
    now = np.stack([columns.belief_none, columns.belief_greeted, columns.belief_called, columns.belief_following])
    np.testing.assert_allclose(now.sum(axis=0), 1, atol=1e-5)
    engagement = np.maximum(columns.interaction_level.astype(int) - 4, 0)
    assert (now.argmax(axis=0) == engagement).mean() > 0.9


def test_a_trial_begins_with_nobody_engaged_and_keeps_what_was_counted():
    belief = make_belief()
    belief.now[:] = (0.5, 0.25, 0.25, 0)
    belief.sums[:] = np.arange(4)[:, None] * np.ones(EVENTS)
    begin(belief)
    assert belief.now.tolist() == [1, 0, 0, 0]
    assert (belief.sums == 0.75).all()


def test_without_memory_the_state_has_the_level_of_geometry_whatever_the_engagement():
    columns = played(Sights(), 4_000)
    level = parts_of(columns.state).level
    assert level.max() <= 4
    assert (columns.interaction_level > 4).any()
    free = columns.interaction_level <= 4
    assert (level[free] == columns.interaction_level[free]).all()


def test_with_a_belief_the_state_has_the_likeliest_engagement():
    columns = played(make_belief([*HUMAN["p_S"], *(HUMAN[f"p_{name}"] for name in "HMOAP")]), 4_000)
    now = np.stack([columns.belief_none, columns.belief_greeted, columns.belief_called, columns.belief_following])
    level = parts_of(columns.state).level
    likeliest = now.argmax(axis=0)
    assert (level[likeliest > 0] == likeliest[likeliest > 0] + 4).all()
    assert (level[likeliest == 0] <= 4).all()
