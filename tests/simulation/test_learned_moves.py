"""What a visit goes on to learn of moving: by hand, from the robot and from a human who follows."""

import numpy as np
import pytest

from tests.simulation.small_lab import model_of, played, two_rooms, visit_in
from visitlab_cli.simulation.learned_moves import LAST_SEEN, OWN, learn_moves, make_learning
from visitlab_cli.simulation.successors import make_successors
from visitlab_cli.world.enums import Action, Direction, InteractionLevel
from visitlab_cli.world.lab import make_lab, move
from visitlab_cli.world.scene import Scene

COLS = 6
EAST_2 = int(Action.MOVE_2_EAST)


@pytest.fixture
def lab():
    return make_lab(COLS, COLS, rooms=np.tile(np.arange(COLS) // 3, (COLS, 1)))


def known_of(lab, how):
    model = model_of(lab)
    known = make_successors(model, lab)
    return known, make_learning(how, model, known)


def step(robot, end, action, human=(5, 5), human_end=(5, 5), level=InteractionLevel.NOT_SEEN, angle=0):
    before = Scene(*robot, 0, *human, perceived_level=level, angle=angle, distance=2)
    return before, Scene(*end, 0, *human_end, executed_action=int(action), perceived_level=level)


def learned(known, learning, *scenes):
    return learn_moves(learning, known, *scenes, COLS)


def test_a_robot_that_is_blocked_says_so_once_where_the_last_counts(lab):
    known, learning = known_of(lab, LAST_SEEN)
    cell, blocked = 2 * COLS + 2, step((2, 2), (2, 2), EAST_2)
    assert known.after[cell, EAST_2] == cell + 2
    assert learned(known, learning, *blocked)
    assert known.after[cell, EAST_2] == cell
    assert not learned(known, learning, *blocked), "no news"
    assert learned(known, learning, *step((2, 2), (2, 4), EAST_2)), "it is open again"


def test_where_all_count_it_takes_as_often_as_it_was_seen_otherwise(lab):
    known, learning = known_of(lab, OWN)
    cell, blocked = 2 * COLS + 2, step((2, 2), (2, 2), EAST_2)
    before = int(learning.often[cell, EAST_2].sum())
    assert before == 1
    assert [learned(known, learning, *blocked) for _ in range(2)] == [False, True]
    assert known.after[cell, EAST_2] == cell


def test_a_human_who_follows_and_does_not_move_is_blocked_at_every_speed(lab):
    known, learning = known_of(lab, LAST_SEEN)
    cell, follows = 3 * COLS + 3, InteractionLevel.FOLLOWS
    still = step((3, 0), (3, 0), Action.STAY, (3, 3), (3, 3), follows, Direction.EAST)  # it would go west, to the robot
    assert learned(known, learning, *still)
    assert [known.after[cell, 8 * slower + Direction.WEST] for slower in range(3)] == [cell] * 3
    moved = step((3, 0), (3, 0), Action.STAY, (3, 3), (3, 1), follows, Direction.EAST)
    assert learned(known, learning, *moved)
    assert [known.after[cell, 8 * slower + Direction.WEST] for slower in range(3)] == [cell, cell - 2, cell]


@pytest.mark.parametrize("told", ["not following", "a gesture"])
def test_a_human_who_need_not_have_tried_to_move_tells_nothing(lab, told):
    known, learning = known_of(lab, LAST_SEEN)
    level = InteractionLevel.FOLLOWS if told == "a gesture" else InteractionLevel.BOTH_FACE
    action = Action.POINT if told == "a gesture" else Action.STAY
    still = step((3, 0), (3, 0), action, (3, 3), (3, 3), level, Direction.EAST)
    assert not learned(known, learning, *still)


@pytest.mark.parametrize("how", [None, LAST_SEEN, OWN])
def test_a_visit_finds_the_walls_that_its_model_does_not_have(how):
    lab, unwalled = two_rooms(), make_lab(COLS, COLS, rooms=np.tile(np.arange(COLS) // 3, (COLS, 1)))
    visit = visit_in(lab, "route", "mask", "plan", "lead", model=model_of(unwalled), learns=how)
    begun = visit.controller.known.after.copy()
    played(visit, 60)
    known = visit.controller.known
    changed = np.argwhere(known.after != begun)
    assert (len(changed) > 0) == (how is not None)
    for cell, action in changed.tolist():
        row, col = move(lab, *divmod(cell, COLS), action % 8, action // 8 + 1, -1)
        assert known.after[cell, action] == row * COLS + col
