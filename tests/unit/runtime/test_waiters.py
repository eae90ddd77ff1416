"""The waiting primitives for threads of users."""

from __future__ import annotations

import threading
from typing import Any

from robowidgets.runtime.waiters import LOOK, Waiters

from ..clocks import ManualClock


def test_one_that_waits_is_given_what_there_is_when_it_is_woken() -> None:
    clock, lock, there, given = ManualClock(), threading.RLock(), [], []
    waiters = Waiters(lock, clock)
    thread = clock.beside(lambda: given.append(waiters.wait_for(lambda: there[-1] if there else None, 10.0)))
    clock.settle()
    assert len(waiters) == 1
    with lock:
        waiters.wake()  # for nothing
    clock.settle()
    assert len(waiters) == 1
    with lock:
        there.append("one")
        waiters.wake()
    thread.join(120)
    assert (given, len(waiters)) == (["one"], 0)


def test_it_waits_for_its_time_and_no_longer() -> None:
    clock, given = ManualClock(), []
    waiters = Waiters(threading.RLock(), clock)
    clock.beside(lambda: given.append(waiters.wait_for(lambda: None, 10.0)))
    clock.advance(10.0 - 1 / 1024)
    assert given == []
    clock.advance(1 / 1024)
    assert given == [None]


def test_it_looks_often_for_an_interrupt_since_one_may_come_just_before_it_sleeps() -> None:
    class Sleeper(ManualClock):
        def signal(self) -> Any:
            return self

        def wait_until(self, when: float) -> None:
            slept.append(when - self.now())
            self.set(when)

    slept: list[float] = []
    assert Waiters(threading.RLock(), Sleeper()).wait_for(lambda: None, 10.0) is None
    assert slept == [LOOK] * 40
