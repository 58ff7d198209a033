"""Movement at borders and walls, by hypothesis, against the oracle's reading and by invariants."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.oracle import grid as oracle
from tests.oracle.rules import robot_after
from visitlab_cli.world.enums import Action, Direction
from visitlab_cli.world.lab import ALL_OPEN, COL_STEPS, ROW_STEPS, make_lab, move, paper_lab
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import NOWHERE, Body

SIZE = 5
EAST, NORTH_EAST = int(Direction.EAST), int(Direction.NORTH_EAST)
cells = st.tuples(st.integers(0, SIZE - 1), st.integers(0, SIZE - 1))


def at(robot, angle):
    """A scene with the robot there and the human in that direction."""
    row, col, heading = robot
    return NOWHERE._replace(robot_row=row, robot_col=col, robot_heading=heading, angle=angle)


@st.composite
def walls(draw):
    """Some walls between straight neighbours."""
    found = []
    for _ in range(draw(st.integers(0, 20))):
        row, col = draw(st.integers(0, SIZE - 2)), draw(st.integers(0, SIZE - 2))
        found.append(((row, col), (row + 1, col) if draw(st.booleans()) else (row, col + 1)))
    return found


@settings(max_examples=300, deadline=None)
@given(walls=walls(), cell=cells, action=st.integers(0, 28), heading=st.integers(0, 7), angle=st.integers(0, 7))
def test_every_action_ends_where_the_oracle_says(walls, cell, action, heading, angle):
    ours = acted(make_lab(SIZE, SIZE, walls), at(Body(*cell, heading), angle), action)
    theirs = robot_after(oracle.Grid.with_walls(SIZE, SIZE, walls), cell, heading, action, angle)
    assert ((ours.row, ours.col), ours.heading) == theirs


@settings(max_examples=200, deadline=None)
@given(walls=walls(), cell=cells, direction=st.integers(0, 7), speed=st.integers(1, 3))
def test_a_move_is_a_straight_line_that_walls_only_shorten(walls, cell, direction, speed):
    free = move(make_lab(SIZE, SIZE), *cell, direction, speed, ALL_OPEN)
    walled = move(make_lab(SIZE, SIZE, walls), *cell, direction, speed, ALL_OPEN)
    steps = [max(abs(end[0] - cell[0]), abs(end[1] - cell[1])) for end in (walled, free)]
    assert steps[0] <= steps[1] <= speed
    assert walled == (cell[0] + steps[0] * ROW_STEPS[direction], cell[1] + steps[0] * COL_STEPS[direction])
    back = move(make_lab(SIZE, SIZE, walls), *walled, (direction + 4) % 8, steps[0], ALL_OPEN)
    assert back == cell


def test_a_diagonal_never_slides_along_a_wall():
    grid = make_lab(SIZE, SIZE, [((2, 2), (1, 2))])
    assert move(grid, 2, 2, NORTH_EAST, 3, ALL_OPEN) == (2, 2)
    assert move(grid, 2, 1, NORTH_EAST, 1, ALL_OPEN) == (2, 1)
    assert move(grid, 2, 2, EAST, 1, ALL_OPEN) == (2, 3)


def test_a_wall_lies_between_straight_neighbours():
    with pytest.raises(ValueError, match="straight neighbours"):
        make_lab(SIZE, SIZE, [((0, 0), (1, 1))])


def test_rooms_are_numbered_row_by_row_from_the_north_west():
    rooms = paper_lab().rooms
    assert rooms[0, 0] == 0
    assert rooms[0, 23] == 2
    assert rooms[23, 0] == 6
    assert (np.bincount(rooms.ravel()) == 64).all()


def test_a_blocked_mover_turns_and_who_stays_does_not():
    grid = make_lab(SIZE, SIZE)
    before = at(Body(0, 0, Direction.EAST.value), 5)
    assert acted(grid, before, Action.MOVE_3_NORTH) == Body(0, 0, Direction.NORTH.value)
    assert acted(grid, before, Action.STAY) == Body(0, 0, Direction.EAST.value)
    assert acted(grid, before, Action.LOOK) == Body(0, 0, Direction.SOUTH_WEST.value)


@settings(max_examples=200, deadline=None)
@given(
    data=st.data(),
    doors=st.lists(walls(), max_size=4),
    cell=cells,
    direction=st.integers(0, 7),
    speed=st.integers(1, 3),
)
def test_a_shut_door_is_a_wall_and_an_open_one_is_none(doors, cell, direction, speed, data):
    shut = data.draw(st.sets(st.sampled_from(range(len(doors)))) if doors else st.just(set()))
    open_doors = ALL_OPEN & ~sum(1 << number for number in shut)
    walled = make_lab(SIZE, SIZE, [wall for number in shut for wall in doors[number]])
    with_doors = make_lab(SIZE, SIZE, doors=doors)
    assert move(with_doors, *cell, direction, speed, open_doors) == move(walled, *cell, direction, speed, ALL_OPEN)


def test_the_last_of_64_doors_can_be_shut_and_a_65th_is_refused():
    doors = [[((0, 0), (0, 1))] if number == 63 else [((3, 3), (3, 4))] for number in range(64)]
    lab = make_lab(SIZE, SIZE, doors=doors)
    shut = int(np.int64(np.uint64(2**64 - 1 - 2**63)))
    assert move(lab, 0, 0, EAST, 1, shut) == (0, 0)
    assert move(lab, 0, 0, EAST, 1, ALL_OPEN) == (0, 1)
    assert move(lab, 3, 3, EAST, 1, shut) == (3, 4)
    with pytest.raises(ValueError, match="at most 64"):
        make_lab(SIZE, SIZE, doors=[*doors, []])
