"""What is estimated of a human: it comes out as it is, from nothing but what can be seen."""

import numpy as np
import pytest

from tests.simulation.small_lab import HUMAN, model_of, played, two_rooms, visit_in
from visitlab_cli.simulation.estimates import RECENT, make_estimates, notice
from visitlab_cli.simulation.successors import make_successors
from visitlab_cli.world.enums import Action
from visitlab_cli.world.geometry import make_geometry
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.scene import NOWHERE

LAB, COLS = paper_lab(), 24
KNOWN = make_successors(model_of(LAB), LAB)
GEOMETRY = make_geometry(24, 24)
FOLLOWS, SEEN = 7, 1


def steps(count, speeds, loss, seed=0, action=int(Action.STAY)):
    """Scenes before and after `count` steps in which a human follows a robot, anywhere in the lab."""
    draw = np.random.default_rng(seed)
    for _ in range(count):
        human = draw.integers(24, size=2)
        robot = np.clip(human + draw.integers(-5, 6, size=2), 0, 23)
        place = robot[0] - human[0] + 23, human[1] - robot[1] + 23
        angle, distance = int(GEOMETRY.angle[place]), int(GEOMETRY.distance[place])
        if not 1 <= distance <= 3:
            continue
        before = NOWHERE._replace(
            robot_row=robot[0], robot_col=robot[1], human_row=human[0], human_col=human[1],
            interaction_level=FOLLOWS, perceived_level=FOLLOWS, angle=angle, distance=distance,
        )  # fmt: skip
        lost = draw.random() < loss
        end = human
        if not lost:
            move = 8 * draw.choice(3, p=speeds) + (angle + 4) % 8
            end = np.array(divmod(KNOWN.after[human[0] * COLS + human[1], move], COLS))
        yield (
            before,
            before._replace(
                human_row=end[0], human_col=end[1], perceived_level=SEEN if lost else FOLLOWS, executed_action=action
            ),
        )


def estimated(scenes, window=0):
    estimates = make_estimates(window)
    for before, after in scenes:
        notice(estimates, KNOWN, before, after, COLS)
    return estimates


@pytest.mark.parametrize("speeds", [(0.2, 0.3, 0.5), (1, 0, 0), (0, 0.5, 0.5)])
def test_known_parameters_are_recovered_though_moves_are_cut_short(speeds):
    found = estimated(steps(6000, speeds, 0.15))
    np.testing.assert_allclose(found.speeds, speeds, atol=0.03)
    assert found.speeds.sum() == pytest.approx(1)
    assert found.loss[0] == pytest.approx(0.15, abs=0.02)


def test_fresh_estimates_and_what_they_weigh():
    fresh = make_estimates()
    assert fresh.speeds.tolist() == [1 / 3] * 3
    assert fresh.loss.tolist() == [0.1]
    lost = [(before, after) for before, after in steps(200, (1, 0, 0), 1.0)][:10]
    assert estimated(lost).loss[0] == pytest.approx((10 * 0.1 + 10) / 20)
    assert estimated(lost).speeds.tolist() == [1 / 3] * 3


def test_a_hello_is_no_chance_to_see_attention_lost():
    found = estimated(steps(500, (1, 0, 0), 1.0, action=int(Action.HELLO)))
    assert found.loss.tolist() == [0.1]
    assert found.seen[1] == 0


def test_a_blocked_move_is_shared_out_by_how_likely_each_speed_was():
    estimates = make_estimates()
    corner = NOWHERE._replace(
        robot_row=3,
        robot_col=0,
        human_row=0,
        human_col=0,
        interaction_level=FOLLOWS,
        perceived_level=FOLLOWS,
        angle=2,
        distance=2,
    )
    assert KNOWN.after[0, 6] == COLS  # southwards, towards the robot
    estimates.speeds[:] = 0.2, 0.3, 0.5
    blocked = corner._replace(robot_row=0, robot_col=3, human_row=0, human_col=22, angle=4)  # it goes east
    notice(estimates, KNOWN, blocked, blocked._replace(human_col=23, executed_action=24), COLS)
    np.testing.assert_allclose(estimates.moves, (0.2, 0.3, 0.5))
    near = blocked._replace(human_col=21)
    estimates = make_estimates()
    estimates.speeds[:] = 0.2, 0.3, 0.5
    notice(estimates, KNOWN, near, near._replace(human_col=23, executed_action=24), COLS)
    np.testing.assert_allclose(estimates.moves, (0, 0.375, 0.625))


def test_over_the_last_chances_another_human_is_soon_known():
    one, other = list(steps(4000, (1, 0, 0), 0.0)), list(steps(900, (0, 0, 1), 0.3, seed=1))
    found, slow = estimated(one + other, RECENT), estimated(one + other)
    assert found.speeds[2] > 0.9 > 0.3 > slow.speeds[2]
    assert found.loss[0] == pytest.approx(0.3, abs=0.08)
    assert found.losses.sum() == pytest.approx(RECENT)
    last = estimated([*other], RECENT)
    np.testing.assert_allclose(found.losses, last.losses)  # nothing of the first human is left


def test_told_estimates_stay_as_they_are():
    told = make_estimates(told=((0.1, 0.2, 0.7), 0.05))
    for before, after in steps(300, (1, 0, 0), 0.5):
        notice(told, KNOWN, before, after, COLS)
    assert (told.speeds.tolist(), told.loss.tolist()) == ([0.1, 0.2, 0.7], [0.05])


def test_only_what_can_be_seen_is_looked_at():
    """Neither the speed that the human drew nor its engagement, but the cells and the interaction level."""
    scenes = list(steps(500, (0.2, 0.3, 0.5), 0.2))
    hidden = {"human_action": 3, "engagement": 1, "human_memory": 9}
    blind = [(before._replace(**hidden), after._replace(**hidden)) for before, after in scenes]
    true, found = estimated(scenes), estimated(blind)
    assert true.speeds.tolist() == found.speeds.tolist()
    assert true.loss.tolist() == found.loss.tolist()


@pytest.mark.slow
def test_in_a_visit_the_human_is_known_in_the_end():
    visit = visit_in(two_rooms(8, 16), "mask", "plan", "lead")
    played(visit, 200)
    found = visit.controller.estimates
    np.testing.assert_allclose(found.speeds, HUMAN["p_S"], atol=0.05)
    assert found.loss[0] == pytest.approx(HUMAN["p_A"], abs=0.02)
