"""The oracle's rules on situations worked out by hand from TASK.md, cells as (row, column)."""

from pathlib import Path

import pytest

from visitlab_cli.world.enums import Action, Direction, Engagement

from . import mutations, rules
from .rules import Grid, Human, Outcome, geometry, human_step, interaction_level

E, NE, N, NW, W, SW, S, SE = range(8)
STAY, LOOK, HELLO, COME, POINT = 24, 25, 26, 27, 28
NONE, GREETED, CALLED, FOLLOWING = range(4)

GRID = Grid()
HUMAN = Human(p_S=(0.2, 0.3, 0.5), p_H=0.3, p_M=0.2, p_O=0.16, p_A=0.1, p_P=0.4)
SURE = Human(p_S=(1.0, 0.0, 0.0), p_H=0.0, p_M=0.0, p_O=0.0, p_A=0.0, p_P=0.0)


def fact(outcomes, **wanted):
    """The probability that an outcome has the given values."""
    return sum(p for o, p in outcomes.items() if all(getattr(o, name) == v for name, v in wanted.items()))


# ---------------------------------------------------------------------------------------------- movement


@pytest.mark.parametrize(
    ("cell", "speed", "direction", "target"),
    [
        ((5, 5), 1, E, (5, 6)),
        ((5, 5), 1, NE, (4, 6)),
        ((5, 5), 1, N, (4, 5)),
        ((5, 5), 1, NW, (4, 4)),
        ((5, 5), 1, W, (5, 4)),
        ((5, 5), 1, SW, (6, 4)),
        ((5, 5), 1, S, (6, 5)),
        ((5, 5), 1, SE, (6, 6)),
        ((5, 5), 3, SE, (8, 8)),
        ((1, 0), 3, N, (0, 0)),  # the border ends the move, after one step
        ((2, 22), 3, NE, (1, 23)),
        ((0, 10), 2, NE, (0, 10)),  # a diagonal never slides along the border
        ((0, 0), 3, NW, (0, 0)),
        ((0, 0), 3, SW, (0, 0)),
        ((23, 23), 1, NE, (23, 23)),
    ],
)
def test_a_move_is_unit_steps_that_the_border_ends(cell, speed, direction, target):
    assert GRID.move(cell, speed, direction) == target
    assert GRID.after(cell, rules.move_action(speed, direction)) == target


@pytest.mark.parametrize(
    "wall",
    [((5, 5), (4, 5)), ((5, 5), (5, 6)), ((4, 5), (4, 6)), ((5, 6), (4, 6))],
    ids=["north of it", "east of it", "then east", "then north"],
)
def test_a_diagonal_needs_both_ways_round(wall):
    grid = Grid.with_walls(24, 24, [wall])
    assert grid.move((5, 5), 1, NE) == (5, 5)
    assert grid.move((4, 6), 1, SW) == (4, 6)
    assert grid.move((6, 4), 3, NE) == (5, 5)
    assert GRID.move((5, 5), 1, NE) == (4, 6)


def test_a_wall_stops_straight_moves_from_both_sides_and_no_others():
    grid = Grid.with_walls(24, 24, [((5, 6), (5, 5))])
    assert grid.move((5, 3), 3, E) == (5, 5)
    assert grid.move((5, 7), 3, W) == (5, 6)
    assert grid.move((5, 5), 1, N) == (4, 5)
    assert grid.move((4, 5), 1, E) == (4, 6)


def test_a_wall_stands_between_straight_neighbours_only():
    with pytest.raises(ValueError, match="straight neighbours"):
        Grid.with_walls(24, 24, [((5, 5), (6, 6))])


@pytest.mark.parametrize(
    ("cell", "room"),
    [
        ((0, 0), 0),
        ((7, 7), 0),
        ((7, 8), 1),
        ((0, 23), 2),
        ((8, 7), 3),
        ((12, 12), 4),
        ((23, 0), 6),
        ((23, 23), 8),
    ],
)
def test_rooms_are_numbered_row_by_row(cell, room):
    assert GRID.room(cell) == room


def test_actions_are_numbered_by_speed_then_direction():
    assert rules.move_action(1, E) == Action.MOVE_1_EAST == 0
    assert rules.move_action(3, SE) == Action.MOVE_3_SOUTH_EAST == 23
    assert rules.move_parts(Action.MOVE_2_NORTH_WEST) == (2, NW)
    assert not rules.is_move(Action.STAY)


def test_the_robot_heads_where_it_moves_and_turns_only_to_look():
    assert rules.robot_after(GRID, (0, 0), E, Action.MOVE_2_NORTH, angle=S) == ((0, 0), N)  # blocked
    assert rules.robot_after(GRID, (5, 5), E, Action.MOVE_2_WEST, angle=S) == ((5, 3), W)
    assert rules.robot_after(GRID, (5, 5), E, STAY, angle=S) == ((5, 5), E)
    assert rules.robot_after(GRID, (5, 5), E, LOOK, angle=S) == ((5, 5), S)
    for gesture in (HELLO, COME, POINT):
        assert rules.robot_after(GRID, (5, 5), E, gesture, angle=S) == ((5, 5), E)


# ---------------------------------------------------------------------------------------------- geometry


def test_distance_categories_and_the_appropriate_ones():
    assert [rules.distance_category(d) for d in range(8)] == [0, 0, 1, 2, 2, 3, 4, 4]
    assert [rules.distance_category(d, (0, 2, 3, 6)) for d in range(8)] == [0, 1, 1, 2, 3, 3, 3, 4]
    appropriate = [geometry((10, 10), E, (10, 10 + d), W).appropriate for d in range(7)]
    assert appropriate == [False, False, True, True, True, True, False]
    assert geometry((10, 10), E, (13, 11), W).distance == 2  # the larger of 3 and 1


@pytest.mark.parametrize(
    ("human", "b"),
    [
        ((10, 10), 0),
        ((10, 13), 0),
        ((7, 13), 100),
        ((7, 10), 200),
        ((7, 7), 300),
        ((10, 7), 400),
        ((13, 7), 500),
        ((13, 10), 600),
        ((13, 13), 700),
        ((9, 12), 59),  # atan(1/2) is 26.565 degrees: 0.5903 of 45
        ((8, 11), 141),
        ((11, 12), 741),
    ],
)
def test_the_bearing_is_counter_clockwise_from_east(human, b):
    assert rules.bearing((10, 10), human) == b


def test_a_bearing_that_rounds_to_a_full_turn_is_none():
    assert rules.bearing((0, 0), (1, 400)) == 0  # 359.857 degrees: 7.997
    assert rules.bearing((0, 0), (1, 119)) == 799


@pytest.mark.parametrize(
    ("angle", "bearings"),
    [
        (0, (0, 49, 50, 750, 799)),
        (1, (51, 149)),
        (2, (150, 250)),
        (3, (251, 349)),
        (4, (350, 450)),
        (6, (550, 650)),
        (7, (651, 749)),
    ],
)
def test_the_angle_is_nearest_and_a_tie_goes_to_the_even_one(angle, bearings):
    assert {rules.angle_of(b) for b in bearings} == {angle}


def test_a_tie_at_real_cells():
    # 12 up and 29 right: atan(12/29) is 22.48 degrees, 0.4995 of 45, so 0.50 and 0; 5 and 12: 22.62, 0.50.
    assert rules.bearing((12, 0), (0, 29)) == 50
    assert geometry((12, 0), E, (0, 29), W).angle == E
    assert rules.bearing((5, 0), (0, 12)) == 50
    # Turned by 45 degrees: 17 up and 7 right, 67.62 degrees, 1.50: 2, the even one.
    assert rules.bearing((17, 0), (0, 7)) == 150
    assert geometry((17, 0), E, (0, 7), W).angle == N


def test_who_sees_and_faces_whom_bounds_included():
    # The human three cells east of the robot: b = 0, from the human 4.
    seen = [geometry((10, 10), E, (10, 13), heading).seen for heading in Direction]
    faces = [geometry((10, 10), E, (10, 13), heading).human_faces for heading in Direction]
    robot = [geometry((10, 10), heading, (10, 13), W).robot_faces for heading in Direction]
    assert [h for h in Direction if seen[h]] == [N, NW, W, SW, S]
    assert [h for h in Direction if faces[h]] == [NW, W, SW]
    assert [h for h in Direction if robot[h]] == [E, NE, SE]
    # One up, two right: b = 0.59; the bearing, not the angle, counts.
    robot = [geometry((10, 10), heading, (9, 12), W).robot_faces for heading in Direction]
    assert [h for h in Direction if robot[h]] == [E, NE]
    seen = [geometry((10, 10), E, (9, 12), heading).seen for heading in Direction]
    assert [h for h in Direction if seen[h]] == [NW, W, SW, S]  # within 2 of 4.59: 3, 4, 5, 6
    # In one cell b = 0 as well.
    assert geometry((10, 10), SE, (10, 10), W) == (0, 0, True, True, True)
    assert geometry((10, 10), S, (10, 10), NE) == (0, 0, False, False, False)


@pytest.mark.parametrize(
    ("robot_heading", "human_heading", "level"),
    [(E, E, 0), (W, E, 0), (W, N, 1), (W, NW, 2), (W, W, 2), (E, N, 3), (SE, S, 3), (NE, SW, 4), (E, W, 4)],
)
def test_levels_of_geometry(robot_heading, human_heading, level):
    assert interaction_level(geometry((10, 10), robot_heading, (10, 13), human_heading)) == level


def test_levels_of_engagement_do_not_depend_on_geometry():
    nothing_seen = geometry((10, 10), W, (10, 20), E)
    assert [interaction_level(nothing_seen, e) for e in Engagement] == [0, 5, 6, 7]
    assert [rules.engagement_of(level) for level in range(8)] == [0, 0, 0, 0, 0, 1, 2, 3]


# --------------------------------------------------------------------------------------- the human's step


def step(e, action, human=HUMAN, robot=((10, 10), E), person=((10, 13), W), grid=GRID):
    outcomes = human_step(grid, *robot, *person, e, action, human)
    assert sum(outcomes.values()) == pytest.approx(1)
    return outcomes


def test_hello_succeeds_for_sure_where_the_human_faces_the_robot():
    assert fact(step(NONE, HELLO), engagement=GREETED) == pytest.approx(1)


def test_hello_may_fail_where_it_only_sees_the_robot():
    assert fact(step(NONE, HELLO, person=((10, 13), N)), engagement=GREETED) == pytest.approx(0.7)
    assert fact(step(NONE, HELLO, person=((10, 13), N)), engagement=NONE) == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("robot", "person"),
    [
        (((10, 10), E), ((10, 13), E)),  # not seen
        (((10, 10), N), ((10, 13), W)),  # the robot faces elsewhere
        (((10, 12), E), ((10, 13), W)),  # too close
        (((10, 7), E), ((10, 13), W)),  # too far
    ],
)
def test_hello_is_lost_elsewhere(robot, person):
    assert fact(step(NONE, HELLO, robot=robot, person=person), engagement=NONE) == pytest.approx(1)


def test_hello_wins_back_who_was_just_lost_and_lowers_nobody():
    assert fact(step(FOLLOWING, HELLO), engagement=FOLLOWING) == pytest.approx(0.9)
    assert fact(step(FOLLOWING, HELLO), engagement=GREETED) == pytest.approx(0.1)
    assert fact(step(CALLED, HELLO), engagement=CALLED) == pytest.approx(0.9)
    assert fact(step(GREETED, HELLO), engagement=GREETED) == pytest.approx(1)
    seen = step(GREETED, HELLO, person=((10, 13), N))
    assert fact(seen, engagement=NONE) == pytest.approx(0.1 * 0.3)


def test_come_calls_or_makes_follow():
    outcomes = step(GREETED, COME)
    assert fact(outcomes, engagement=NONE) == pytest.approx(0.1)
    assert fact(outcomes, engagement=FOLLOWING) == pytest.approx(0.9 * 0.6)
    assert fact(outcomes, engagement=CALLED) == pytest.approx(0.9 * 0.4)
    assert fact(step(CALLED, COME), engagement=CALLED) == pytest.approx(0.9)
    assert fact(step(NONE, COME), engagement=NONE) == pytest.approx(1)
    # A greeted human neither needs to see the robot nor to be faced by it.
    turned = step(GREETED, COME, robot=((10, 10), W), person=((10, 13), E), human=SURE)
    assert fact(turned, engagement=FOLLOWING) == 1


def test_point_makes_the_called_follow():
    assert fact(step(CALLED, POINT), engagement=FOLLOWING) == pytest.approx(0.9)
    assert fact(step(CALLED, POINT), engagement=NONE) == pytest.approx(0.1)
    assert fact(step(FOLLOWING, POINT), engagement=FOLLOWING) == pytest.approx(0.9)
    assert fact(step(GREETED, POINT), engagement=GREETED) == pytest.approx(0.9)
    assert fact(step(NONE, POINT), engagement=NONE) == pytest.approx(1)


@pytest.mark.parametrize("cell", [(10, 10), (10, 11), (10, 16), (4, 10)])
def test_engagement_ends_at_an_inappropriate_distance(cell):
    for e in (GREETED, CALLED, FOLLOWING):
        for action in (STAY, COME, POINT):
            assert fact(step(e, action, SURE, person=(cell, W)), engagement=NONE) == 1


@pytest.mark.parametrize("action", [STAY, LOOK, Action.MOVE_3_WEST, Action.GO_TO_HUMAN_VISION])
def test_a_follower_moves_towards_where_the_robot_was(action):
    outcomes = step(FOLLOWING, action)
    for speed, p in ((1, 0.2), (2, 0.3), (3, 0.5)):
        wanted = Outcome(FOLLOWING, rules.move_action(speed, W), (10, 13 - speed), W)
        assert outcomes[wanted] == pytest.approx(0.9 * p)


@pytest.mark.parametrize("action", [HELLO, COME, POINT])
def test_a_follower_stays_at_a_gesture(action):
    assert step(FOLLOWING, action, SURE) == {Outcome(FOLLOWING, STAY, (10, 13), W): 1.0}


def test_who_was_lost_no_longer_follows():
    outcomes = step(FOLLOWING, STAY)
    lost = {o: p for o, p in outcomes.items() if o.engagement == NONE}
    assert sum(lost.values()) == pytest.approx(0.1)
    assert fact(lost, action=STAY) == pytest.approx(0.1 * 0.8)


def test_come_makes_follow_but_only_from_the_next_step():
    assert step(GREETED, COME, SURE) == {Outcome(FOLLOWING, STAY, (10, 13), W): 1.0}


@pytest.mark.parametrize("e", [GREETED, CALLED])
def test_the_greeted_and_called_follow_with_their_gaze_only(e):
    # The robot five up and right of the human: angle SW, so the human looks NE, from wherever it looked.
    outcomes = step(e, STAY, SURE, robot=((5, 15), N), person=((10, 10), W))
    assert outcomes == {Outcome(e, STAY, (10, 10), NE): 1.0}


def test_gaze_and_movement_take_the_rounded_angle_of_the_perceived_positions():
    # The human one up and two right of the robot: b = 0.59, angle 1, so it moves south-west, off the line.
    outcomes = step(FOLLOWING, Action.MOVE_3_NORTH, SURE, robot=((10, 10), E), person=((9, 12), E))
    assert outcomes == {Outcome(FOLLOWING, rules.move_action(1, SW), (10, 11), SW): 1.0}


def test_random_movement_and_gaze():
    outcomes = step(NONE, STAY)
    assert fact(outcomes, action=STAY) == pytest.approx(0.8)
    assert fact(outcomes, action=rules.move_action(2, N), cell=(8, 13)) == pytest.approx(0.2 * 0.3 / 8)
    # Standing: the same heading, or any of eight, the same one among them.
    assert outcomes[Outcome(NONE, STAY, (10, 13), W)] == pytest.approx(0.8 * (0.84 + 0.02))
    assert outcomes[Outcome(NONE, STAY, (10, 13), E)] == pytest.approx(0.8 * 0.02)
    # Having moved: the heading of the move, or any of eight.
    moved = rules.move_action(2, N)
    assert outcomes[Outcome(NONE, moved, (8, 13), N)] == pytest.approx(0.2 * 0.3 / 8 * (0.84 + 0.02))
    assert outcomes[Outcome(NONE, moved, (8, 13), W)] == pytest.approx(0.2 * 0.3 / 8 * 0.02)


def test_a_blocked_human_still_moves_and_heads_there():
    follower = step(FOLLOWING, STAY, SURE, robot=((0, 0), E), person=((2, 0), N))
    assert follower == {Outcome(FOLLOWING, rules.move_action(1, N), (1, 0), N): 1.0}
    # The robot two up and three right, in sight past the end of a wall that the diagonal step may not slide along.
    grid = Grid.with_walls(24, 24, [((2, 0), (1, 0))])
    blocked = step(FOLLOWING, STAY, SURE, robot=((0, 3), E), person=((2, 0), S), grid=grid)
    assert blocked == {Outcome(FOLLOWING, rules.move_action(1, NE), (2, 0), NE): 1.0}


def test_the_teleport_leads_two_cells_before_the_human_or_to_the_border():
    assert rules.teleport_target(GRID, (10, 10), NW) == (8, 8)
    assert rules.teleport_target(GRID, (10, 22), E) == (10, 23)
    assert rules.teleport_target(GRID, (10, 23), NE) == (10, 23)


# --------------------------------------------------------------------------------- state numbers, rewards


def test_state_numbers():
    assert rules.navigation_state(GRID, 8, (23, 23)) == 5183
    assert rules.navigation_state(GRID, 2, (3, 5)) == 2 * 576 + 3 * 24 + 5
    assert rules.go_to_human_state(angle=7, human_heading=7, distance=4) == 319
    assert rules.go_to_human_state(angle=3, human_heading=5, distance=2) == 3 + 40 + 128
    assert rules.social_state(level=7, distance=4, desired_direction=7, angle=7) == 2559
    assert rules.social_state(level=5, distance=2, desired_direction=6, angle=3) == 5 + 16 + 240 + 960


def test_navigation_pays_in_the_goal_room():
    assert [rules.navigation_reward(GRID, 4, cell) for cell in ((8, 8), (15, 15), (7, 8), (8, 16))] == [
        1,
        1,
        0,
        0,
    ]


def test_go_to_human_pays_when_faced_at_an_appropriate_distance():
    behind = geometry((10, 10), W, (10, 13), NW)  # level 2: the robot turns its back
    assert rules.go_to_human_reward(behind) == 1
    assert rules.go_to_human_reward(geometry((10, 10), E, (10, 13), W)) == 1
    assert rules.go_to_human_reward(geometry((10, 10), E, (10, 13), N)) == 0  # seen only
    assert rules.go_to_human_reward(geometry((10, 10), E, (10, 13), N), "seen") == 1
    assert rules.go_to_human_reward(geometry((10, 10), E, (10, 13), E), "seen") == 0
    for too_near_or_far in ((10, 11), (10, 16)):
        assert rules.go_to_human_reward(geometry((10, 10), E, too_near_or_far, W)) == 0


def test_social_pays_a_followers_move_in_the_desired_direction():
    for speed in (1, 2, 3):
        assert rules.social_reward(FOLLOWING, rules.move_action(speed, W), W) == 1
        assert rules.social_reward(FOLLOWING, rules.move_action(speed, W), SW) == 0
        assert rules.social_reward(NONE, rules.move_action(speed, W), W) == 0
    assert rules.social_reward(FOLLOWING, STAY, E) == 0


def test_the_visit_pays_the_human_in_the_goal_room():
    assert rules.visit_reward(GRID, 4, (12, 12)) == 1
    assert rules.visit_reward(GRID, 4, (7, 12)) == 0


# ------------------------------------------------------------------------------------------- mutations


def test_a_mutation_replaces_one_line_of_the_copy(tmp_path: Path):
    (tmp_path / "a.py").write_text("x = 1\ny = 1\n")
    mutations.apply(mutations.Mutation("x", "a.py", "x = 1", "x = 2", "social"), tmp_path)
    assert (tmp_path / "a.py").read_text() == "x = 2\ny = 1\n"
    for old in ("= 3", "\n"):
        with pytest.raises(AssertionError, match="not once"):
            mutations.apply(mutations.Mutation("x", "a.py", old, "", "social"), tmp_path)
