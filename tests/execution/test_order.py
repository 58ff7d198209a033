"""Cells start as soon as what they need is there: there are no waves."""

import pytest

from tests.program import TINY
from visitlab_cli.config.loading import load
from visitlab_cli.execution.order import Order
from visitlab_cli.plan.cells import plan


@pytest.fixture
def cells():
    return {cell.path: cell for cell in plan(load(TINY, ["seeds=2"]))}


def test_a_visit_comes_before_trainings_once_its_modules_are_there(cells):
    order = Order(list(cells.values()))
    visit = cells["visit/fast/seed-0001"]
    begun = set()
    while not begun >= set(visit.modules.values()):
        begun.add(order.next().path)
    for path in sorted(visit.modules.values())[1:]:
        order.done(path)
    assert not order.next().settings.assembled
    order.done(sorted(visit.modules.values())[0])
    assert order.next() == visit
    assert order.next().path == "visit/slow/seed-0001"
    assert not order.next().settings.assembled


def test_each_cell_is_given_once_and_after_what_it_needs(cells):
    order, done = Order(list(cells.values())), []
    while (cell := order.next()) is not None:
        assert set(cell.modules.values()) <= set(done)
        done.append(cell.path)
        order.done(cell.path)
        order.done(cell.path)
    assert sorted(done) == sorted(cells)
    assert not order


def test_what_needs_a_cell_that_failed_is_given_no_more(cells):
    order = Order(list(cells.values()))
    failed = order.failed("social/mb/fast/seed-0001")
    assert [cell.path for cell in failed] == ["visit/fast/seed-0001", "visit/slow/seed-0001"]
    assert order.failed("go_to_human/mb/seed-0001") == [cells["visit_scripted/fast_pointing/seed-0001"]]
    given = set()
    while (cell := order.next()) is not None:
        given.add(cell.path)
        order.done(cell.path)
    assert given == set(cells) - {
        "visit/fast/seed-0001",
        "visit/slow/seed-0001",
        "visit_scripted/fast_pointing/seed-0001",
    }
    assert not order


def test_what_nobody_makes_is_not_waited_for(cells):
    order = Order([cells["visit/fast/seed-0000"]])
    assert order.next() == cells["visit/fast/seed-0000"]
