"""The check of locks in every test finds wrong orders."""

from __future__ import annotations

import threading

from robowidgets.widget.observed import Observed

from ..lock_order import Checked, NotedLock, calls, edges, listed, problems_of
from ..pages import get_newest


def taken_by(*locks: NotedLock) -> None:
    """Make a thread take locks, each while it holds the previous ones."""

    def take() -> None:
        for lock in locks:
            lock.acquire()
        for lock in reversed(locks):
            lock.release()

    thread = threading.Thread(target=take, name="taker")
    thread.start()
    thread.join()


def test_locks_of_the_package_are_noted_by_the_names_of_the_page() -> None:
    from robowidgets import LaserWidget

    assert isinstance(get_newest(LaserWidget()).lock, NotedLock)
    assert "NewestSample.lock" in listed()


def test_locks_in_another_order_than_on_the_page_are_a_problem_for_one_test() -> None:
    checked, (first, *_, last) = Checked(), listed()
    checked.problems()
    taken_by(NotedLock(threading.RLock(), first), NotedLock(threading.RLock(), last))
    assert checked.problems() == []
    taken_by(NotedLock(threading.RLock(), last), NotedLock(threading.RLock(), first))
    assert checked.problems() == [f"taker takes {first} while it holds {last}"]
    assert checked.problems() == []
    del edges[last, first]


def test_a_lock_that_is_on_no_page_is_a_problem_once_another_is_taken_with_it() -> None:
    first = listed()[0]
    assert problems_of([("Other._lock", first, "taker")]) == [f"taker takes {first} while it holds Other._lock"]
    assert problems_of([(first, "Other._lock", "taker")]) == [f"taker takes Other._lock while it holds {first}"]


def test_observers_that_are_called_under_a_lock_are_a_problem() -> None:
    checked, lock, observed = Checked(), NotedLock(threading.RLock(), "Other._lock"), Observed()
    checked.problems()
    observed._call_observers()
    assert checked.problems() == []
    lock.acquire()
    observed._call_observers()
    lock.release()
    assert checked.problems() == ["MainThread calls observers of a Observed while it holds Other._lock"]
    del calls["Other._lock", "observers of a Observed"]
