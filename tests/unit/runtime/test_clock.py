"""Turns and timers by a clock that the test moves, and by the real one."""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator

import pytest

from robowidgets.runtime.clock import Detached, Threads
from robowidgets.widget.pacer import Pacer

from ..clocks import ManualClock, end_timers
from ..senders import Sender
from ..waiting import wait_for


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def threads(clock: ManualClock) -> Iterator[Threads]:
    threads = Threads(clock)
    yield threads
    end_timers(threads)


def test_a_turn_is_done_at_once_when_it_is_due_and_when_it_is_woken(clock: ManualClock, threads: Threads) -> None:
    times: list[float] = []

    def turn() -> float | None:
        times.append(clock.now())
        return clock.now() + 0.5 if len(times) < 3 else None

    ticket = threads.start(turn, "robowidgets-test")
    clock.advance(10.0)
    assert times == [1000.0, 1000.5, 1001.0]
    ticket.wake()
    clock.settle()
    assert times[3:] == [1010.0]
    ticket.detach()


def test_a_turn_that_was_left_is_done_no_more(clock: ManualClock, threads: Threads) -> None:
    times: list[float] = []
    ticket = threads.start(lambda: times.append(clock.now()) or clock.now() + 1.0, "robowidgets-test")
    clock.advance(2.0)
    ticket.detach()
    clock.advance(5.0)
    assert times == [1000.0, 1001.0, 1002.0]
    assert not ticket.is_alive()


def test_left_ends_the_thread_of_a_turn(clock: ManualClock, threads: Threads) -> None:
    def turn() -> None:
        raise Detached

    ticket = threads.start(turn, "robowidgets-test")
    clock.settle()
    assert not ticket.is_alive()


def test_a_turn_that_raises_is_logged_and_done_again_when_it_is_woken(
    clock: ManualClock, threads: Threads, caplog: pytest.LogCaptureFixture
) -> None:
    turns: list[int] = []

    def turn() -> None:
        turns.append(1)
        if len(turns) == 1:
            raise ValueError("a fault of ours")

    with caplog.at_level(logging.ERROR, "robowidgets"):
        ticket = threads.start(turn, "robowidgets-test")
        clock.settle()
    assert "a fault of ours" in caplog.text
    ticket.wake()
    clock.settle()
    assert len(turns) == 2
    ticket.detach()


def test_timers_are_called_in_the_order_of_their_times_each_at_its_time(clock: ManualClock, threads: Threads) -> None:
    called: list[tuple[str, float]] = []
    for name, after in (("late", 2.0), ("soon", 0.25), ("now", 0.0)):
        threads.call_at(clock.now() + after, lambda name=name: called.append((name, clock.now())))
    clock.advance(1.0)
    threads.call_at(clock.now() + 0.5, lambda: called.append(("between", clock.now())))
    clock.advance(5.0)
    assert called == [("now", 1000.0), ("soon", 1000.25), ("between", 1001.5), ("late", 1002.0)]


def test_a_timer_that_raises_is_logged_and_loses_no_other(
    clock: ManualClock, threads: Threads, caplog: pytest.LogCaptureFixture
) -> None:
    called: list[float] = []

    def fail() -> None:
        raise ValueError("a fault of ours")

    with caplog.at_level(logging.ERROR, "robowidgets"):
        threads.call_at(clock.now() + 1.0, fail)
        threads.call_at(clock.now() + 1.0, lambda: called.append(clock.now()))
        clock.advance(1.0)
    assert called == [1001.0]
    assert "a fault of ours" in caplog.text


def test_a_pacer_keeps_an_appointment_to_the_moment(clock: ManualClock, threads: Threads) -> None:
    pacer, sender = Pacer(threads), Sender(clock.now)
    pacer.mark_at(sender, clock.now() + 0.5)
    clock.advance(0.499)
    assert sender.times == []
    clock.advance(0.001)
    assert sender.times == [1000.5]
    assert pacer._thread is not None
    pacer._thread.detach()


def test_real_time_wakes_threads_and_calls_timers_too() -> None:
    threads, called, turned = Threads(), threading.Event(), threading.Event()
    threads.call_at(threads.clock.now() + 0.02, called.set)
    ticket = threads.start(lambda: None if turned.is_set() else turned.set() or None, "robowidgets-test")
    assert called.wait(120)
    assert turned.wait(120)
    turned.clear()
    ticket.wake()
    assert turned.wait(120)
    ticket.detach()
    end_timers(threads)
    wait_for(lambda: not ticket.is_alive(), "its thread ended")
