"""Movement at borders and walls, by hypothesis, against the oracle's reading and by invariants."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.oracle import grid as oracle
from tests.oracle.rules import robot_after
from visitlab_cli.world.enums import Action, Direction
from visitlab_cli.world.grid import COL_STEPS, ROW_STEPS, make_grid, move, room_of
from visitlab_cli.world.robot import acted
from visitlab_cli.world.scene import Body

SIZE = 5
cells = st.tuples(st.integers(0, SIZE - 1), st.integers(0, SIZE - 1))


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
    ours = acted(make_grid(SIZE, SIZE, walls), Body(*cell, heading), action, angle)
    theirs = robot_after(oracle.Grid.with_walls(SIZE, SIZE, walls), cell, heading, action, angle)
    assert ((ours.row, ours.col), ours.heading) == theirs


@settings(max_examples=200, deadline=None)
@given(walls=walls(), cell=cells, direction=st.integers(0, 7), speed=st.integers(1, 3))
def test_a_move_is_a_straight_line_that_walls_only_shorten(walls, cell, direction, speed):
    free = move(make_grid(SIZE, SIZE), *cell, direction, speed)
    walled = move(make_grid(SIZE, SIZE, walls), *cell, direction, speed)
    steps = [max(abs(end[0] - cell[0]), abs(end[1] - cell[1])) for end in (walled, free)]
    assert steps[0] <= steps[1] <= speed
    assert walled == (cell[0] + steps[0] * ROW_STEPS[direction], cell[1] + steps[0] * COL_STEPS[direction])
    back = move(make_grid(SIZE, SIZE, walls), *walled, (direction + 4) % 8, steps[0])
    assert back == cell


def test_a_diagonal_never_slides_along_a_wall():
    grid = make_grid(SIZE, SIZE, [((2, 2), (1, 2))])
    assert move(grid, 2, 2, Direction.NORTH_EAST, 3) == (2, 2)
    assert move(grid, 2, 1, Direction.NORTH_EAST, 1) == (2, 1)
    assert move(grid, 2, 2, Direction.EAST, 1) == (2, 3)


def test_a_wall_lies_between_straight_neighbours():
    with pytest.raises(ValueError, match="straight neighbours"):
        make_grid(SIZE, SIZE, [((0, 0), (1, 1))])


def test_rooms_are_numbered_row_by_row_from_the_north_west():
    rooms = np.array([[room_of(row, col) for col in range(24)] for row in range(24)])
    assert rooms[0, 0] == 0
    assert rooms[0, 23] == 2
    assert rooms[23, 0] == 6
    assert (np.bincount(rooms.ravel()) == 64).all()


def test_a_blocked_mover_turns_and_who_stays_does_not():
    grid = make_grid(SIZE, SIZE)
    assert acted(grid, Body(0, 0, Direction.EAST.value), Action.MOVE_3_NORTH, 5) == Body(0, 0, Direction.NORTH.value)
    assert acted(grid, Body(0, 0, Direction.EAST.value), Action.STAY, 5) == Body(0, 0, Direction.EAST.value)
    assert acted(grid, Body(0, 0, Direction.EAST.value), Action.LOOK, 5) == Body(0, 0, Direction.SOUTH_WEST.value)
