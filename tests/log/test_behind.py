"""A thread that does what it is handed, one piece behind."""

import threading
import time

import pytest

from visitlab_cli.log.behind import Behind


@pytest.fixture
def behind():
    threads = threading.active_count()
    behind = Behind()
    yield behind
    behind.end()
    behind.end()
    assert threading.active_count() == threads


def fail():
    raise ValueError("in the thread")


def test_in_order_and_one_behind_at_most(behind):
    done, here = [], threading.get_ident()

    def piece(number):
        time.sleep(0.001)
        done.append((number, threading.get_ident()))

    for number in range(20):
        behind.hand(lambda number=number: piece(number))
        assert len(done) >= number, "what came before is done"
    behind.wait()
    assert [number for number, _ in done] == list(range(20))
    (thread,) = {ident for _, ident in done}
    assert thread != here


def test_the_one_who_hands_over_does_not_wait_for_it(behind):
    go_on = threading.Event()
    behind.hand(lambda: go_on.wait(10) or fail())
    go_on.set()
    behind.wait()


def after_all(behind):
    behind.end()
    behind.wait()


@pytest.mark.parametrize("next_call", [Behind.wait, lambda behind: behind.hand(fail), after_all])
def test_what_a_piece_raises_comes_out_of_the_next_call_once(behind, next_call):
    behind.hand(fail)
    with pytest.raises(ValueError, match="in the thread"):
        next_call(behind)
    behind.wait()
    done = []
    behind.hand(lambda: done.append(1))
    behind.wait()
    assert done == [1]


def test_no_thread_where_nothing_is_handed(behind):
    threads = threading.active_count()
    behind.wait()
    assert threading.active_count() == threads


def test_where_no_thread_can_be_had_it_is_done_at_once(behind, monkeypatch):
    def refused(self):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", refused)
    done = []
    behind.hand(lambda: done.append(threading.get_ident()))
    assert done == [threading.get_ident()]
    with pytest.raises(ValueError, match="in the thread"):
        behind.hand(fail)
    behind.wait()
