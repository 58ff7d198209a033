"""Who sees whom in the package's labs: all pairs of cells as by the oracle's fractions, a doorway by hand."""

from pathlib import Path

import numpy as np
import pytest

from tests.oracle.lab import Lab
from tests.world.package_log import LABS, NINE_ROOMS, make_lab
from visitlab_cli.world.lab import ALL_OPEN, SOLID, sees
from visitlab_cli.world.layout import Layout, rooms_in_rows

MAPS = sorted((Path(__file__).parents[2] / "configs/beyond/labs").glob("*.txt"))
TEXTS = {"nine_rooms": NINE_ROOMS} | {file.stem: file.read_text().strip() for file in MAPS}


def table(lab, open_doors=-1):
    """Who sees whom by the oracle, over the cells that are not solid; both ways round are asked."""
    grid = lab.grid(open_doors)
    cells = list(grid.cells())
    return np.array([[grid.sees(here, there) for there in cells] for here in cells])


@pytest.mark.parametrize("text", TEXTS.values(), ids=TEXTS)
def test_all_pairs_see_each_other_as_in_exact_fractions_and_both_ways(text):
    expected, visible = table(Lab(text)), Layout(text).lab().walls.visible
    np.testing.assert_array_equal(expected, expected.T)
    np.testing.assert_array_equal(visible, expected)
    assert expected.diagonal().all()
    assert 0.03 < expected.mean() < 0.3


def test_the_nine_rooms_of_a_config_are_those_of_the_map():
    assert rooms_in_rows(3, 3, 8, 8, True, 2).text == NINE_ROOMS


def test_all_pairs_see_each_other_while_some_doors_are_shut():
    lab, package = Lab(**LABS["small"]), make_lab("small")
    cells = np.argwhere(package.rooms != SOLID).tolist()
    for open_doors in range(8):
        expected = table(lab, open_doors)
        got = [[sees(package, *here, *there, open_doors) for there in cells] for here in cells]
        np.testing.assert_array_equal(np.array(got), expected)


@pytest.mark.parametrize(
    ("here", "there", "seen"),
    [
        ((6, 11), (9, 11), True),  # straight through the doorway between B and E, columns 11 and 12
        ((6, 10), (10, 12), True),  # the rooms' border at 11.25
        ((6, 10), (8, 12), True),  # at 12.0, the corner between the doorway's cells, where no wall ends
        ((6, 10), (9, 11), False),  # at 11.0, where one does
        ((7, 11), (8, 10), False),  # there, too, from inside the doorway
        ((6, 9), (9, 11), False),  # at 10.5, the wall
        ((7, 10), (8, 10), False),  # beside the doorway
        ((7, 8), (7, 15), True),  # along a wall
    ],
)
def test_a_doorway_by_hand(here, there, seen):
    lab = Layout(NINE_ROOMS).lab()
    assert sees(lab, *here, *there, ALL_OPEN) == sees(lab, *there, *here, ALL_OPEN) == seen
