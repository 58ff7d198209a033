"""Shards: every cell is in one, chains stay together where that costs nothing, and none does much more than another."""

import pytest

from tests.program import TINY
from visitlab_cli.config.loading import load
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.estimate import seconds_of
from visitlab_cli.plan.shards import Shard, shards

PAPER = "paper"


def costs(parts):
    return [sum(map(seconds_of, cells)) for cells in parts]


@pytest.fixture(scope="module")
def cells():
    return plan(load(TINY, ["seeds=8"]))


@pytest.mark.parametrize("total", [1, 2, 3, 4, 7, 50, 1000])
def test_each_cell_is_in_one_shard_in_the_order_of_the_plan(cells, total):
    parts = shards(cells, total)
    assert len(parts) == total
    assert sorted(cell.path for part in parts for cell in part) == sorted(cell.path for cell in cells)
    order = {cell.path: number for number, cell in enumerate(cells)}
    for part in parts:
        assert [order[cell.path] for cell in part] == sorted(order[cell.path] for cell in part)


def test_every_machine_finds_the_same_ones(cells):
    again = plan(load(TINY, ["seeds=8"]))
    assert [[cell.path for cell in part] for part in shards(cells, 4)] == [
        [cell.path for cell in part] for part in shards(again, 4)
    ]


@pytest.mark.parametrize("total", [2, 4, 8])
def test_whole_chains_stay_together_where_there_is_one_for_each(cells, total):
    for part in shards(cells, total):
        there = {cell.path for cell in part}
        assert all(path in there for cell in part for path in cell.modules.values())


def test_the_paper_is_divided_evenly_and_its_visits_stay_with_their_dearest_module():
    cells = plan(load(PAPER, ["seeds=2"]))
    by_path = {cell.path: cell for cell in cells}
    parts = shards(cells, 4)
    assert max(costs(parts)) <= 1.1 * sum(costs(parts)) / 4
    for part in parts:
        there = {cell.path for cell in part}
        for cell in part:
            if cell.modules:
                dearest = max(cell.modules.values(), key=lambda path: seconds_of(by_path[path]))
                assert dearest in there


@pytest.mark.parametrize("total", [3, 4])
def test_a_shard_also_has_what_it_needs_of_others_and_that_last(total):
    cells = plan(load(TINY))
    parts = shards(cells, total)
    for number, part in enumerate(parts, 1):
        found = Shard.from_words(f"{number}/{total}").of(cells)
        assert found[: len(part)] == part
        there = {cell.path for cell in found}
        assert len(there) == len(found)
        assert all(path in there for cell in found for path in cell.modules.values())
        needed = {path for cell in found for path in cell.modules.values()}
        assert {cell.path for cell in found[len(part) :]} <= needed
