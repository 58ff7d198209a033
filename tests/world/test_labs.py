"""Walls, sight and doors: by hand, and as geometry has them."""

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from visitlab_cli.random_numbers import random_state
from visitlab_cli.world.enums import Direction
from visitlab_cli.world.lab import (
    ALL_OPEN,
    Box,
    Wall,
    box_of,
    goals_of,
    is_box,
    move,
    open_at_first,
    sees,
    shut_doors,
    starts_of,
    toggled,
    walls_of,
)
from visitlab_cli.world.layout import Layout, rooms_in_rows

MAPS = Path(__file__).parents[2] / "configs" / "beyond" / "labs"
SMALL = Layout("AAAAA\nAAaAA\nBBbBB\nBBBBB")
"""One doorway, below the middle of two rooms."""


def test_a_move_ends_at_a_wall_and_goes_through_a_doorway():
    lab = SMALL.lab()
    south = int(Direction.SOUTH)
    assert move(lab, 0, 2, south, 3, ALL_OPEN) == (3, 2)
    assert move(lab, 0, 1, south, 3, ALL_OPEN) == (1, 1)
    for direction in (Direction.SOUTH_EAST, Direction.SOUTH_WEST):  # past the corner of the doorway
        assert move(lab, 1, 2, int(direction), 1, ALL_OPEN) == (1, 2)


def test_sight_ends_at_walls_and_corners():
    lab = SMALL.lab()
    assert sees(lab, 0, 2, 3, 2, ALL_OPEN)
    assert not sees(lab, 1, 1, 2, 1, ALL_OPEN)
    assert not sees(lab, 1, 1, 2, 2, ALL_OPEN), "it meets the corner of the doorway"
    assert sees(lab, 0, 1, 3, 3, ALL_OPEN) == sees(lab, 3, 3, 0, 1, ALL_OPEN) == by_fractions(lab, (0, 1), (3, 3))


def by_fractions(lab, here, there):
    """Whether the segment between two cells' middles meets no wall, its ends included: a second way."""
    walls = walls_of(lab)
    (row, col), (end_row, end_col) = ([Fraction(2 * each + 1, 2) for each in cell] for cell in (here, there))
    for wall in walls:
        if wall.row == wall.end_row and row != end_row:
            part = (wall.row - row) / (end_row - row)
            if 0 <= part <= 1 and wall.col <= col + part * (end_col - col) <= wall.end_col:
                return False
        if wall.col == wall.end_col and col != end_col:
            part = (wall.col - col) / (end_col - col)
            if 0 <= part <= 1 and wall.row <= row + part * (end_row - row) <= wall.end_row:
                return False
    return True


@pytest.mark.parametrize("name", ["corridor", "twenty_rooms", "nine", "solid"])
def test_sight_is_that_of_the_straight_line_for_all_pairs_both_ways(name):
    layouts = {
        "nine": rooms_in_rows(3, 3, 8, 8, True, 2),
        "solid": Layout("AA#BB\nAAabB\naa#BB\ncc#CC"),
    }
    layout = layouts.get(name) or Layout((MAPS / f"{name}.txt").read_text().strip())
    lab = layout.lab()
    visible = lab.walls.visible
    assert (visible == visible.T).all()
    assert visible.diagonal().all()
    picks = random_state(0, "pairs", name) % np.uint64(lab.rows * lab.cols)
    rng = np.random.default_rng(picks)
    pairs = rng.integers(lab.rows * lab.cols, size=(400, 2))
    near = np.clip(
        pairs[:, :1] + rng.integers(-3, 4, (400, 1)) * lab.cols + rng.integers(-3, 4, (400, 1)), 0, len(visible) - 1
    )
    for here, there in [*pairs.tolist(), *np.hstack([pairs[:, :1], near]).tolist()]:
        cells = divmod(here, lab.cols), divmod(there, lab.cols)
        assert visible[here, there] == by_fractions(lab, *cells), cells


def test_a_shut_door_is_a_wall_to_moves_and_to_sight():
    with_door, walled = SMALL.lab(toggling={"AB": 0.5}), SMALL.lab(closed=["AB"], toggling=None)
    for row in range(4):
        for col in range(5):
            for direction in range(8):
                moved = move(with_door, row, col, direction, 3, 0)
                assert moved == move(walled, row, col, direction, 3, ALL_OPEN)
            for other in range(20):
                assert sees(with_door, row, col, *divmod(other, 5), 0) == sees(walled, row, col, *divmod(other, 5), -1)
                opened = sees(with_door, row, col, *divmod(other, 5), 1)
                assert opened == sees(SMALL.lab(), row, col, *divmod(other, 5), ALL_OPEN)
    assert shut_doors(with_door, 0) == [Wall(2, 2, 2, 3)]
    assert shut_doors(with_door, 1) == []


def test_doors_are_opened_and_shut_as_often_as_they_should():
    lab = rooms_in_rows(2, 2, 4, 4, True, 2).lab(closed=["CD"], toggling={"AB": 0.25, "CD": 0.0})
    assert open_at_first(lab) == 0b01
    random, now, changes = random_state(3), open_at_first(lab), 0
    for _ in range(4000):
        after = toggled(lab, now, random)
        assert after & 2 == now & 2, "one that is never toggled"
        changes += after != now
        now = after
    assert abs(changes / 4000 - 0.25) < 4 * (0.25 * 0.75 / 4000) ** 0.5


def test_trials_begin_and_goals_are_where_everybody_can_get():
    layout = Layout("AabB\nAACC\nAACC")
    assert goals_of(layout.lab()) == (0, 1)
    assert len(starts_of(layout.lab())) == 8
    assert goals_of(layout.lab(toggling={"AB": 0.1})) == (0,)
    assert len(starts_of(layout.lab("B"))) == 8
    assert goals_of(layout.lab("B")) == (0,)


def test_of_a_room_that_is_no_rectangle_the_largest_is_told():
    lab = Layout("AABB\nAABB\nAAAA").lab()
    assert box_of(lab, 0) == Box(0, 0, 3, 2)
    assert not is_box(lab, 0)
    assert is_box(lab, 1)
    assert walls_of(lab) == [Wall(0, 2, 2, 2), Wall(2, 2, 2, 4)]


def test_a_lab_without_walls_costs_no_tables():
    assert type(rooms_in_rows(3, 3, 8, 8, False, 2).lab().walls).__name__ == "NoWalls"
