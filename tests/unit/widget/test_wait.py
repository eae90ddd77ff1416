"""Common to all widgets: a program waits for the next sample, and never gets an old one."""

from __future__ import annotations

import asyncio
import signal
import threading
import time
from collections.abc import Callable
from math import inf, nan
from typing import Any

import pytest

from robowidgets import LaserWidget, SpeedWidget, Touch, TouchMode, TouchWidget
from robowidgets.feeds import Feed
from robowidgets.runtime.waiters import Waiters

from ..feeds.scripted import ODOM, SCAN, Scripted, scan, twist
from ..pages import get_newest
from ..waiting import Clock, wait_for
from .number_widget import NumberWidget, in_a_thread


def feed_at(rate: float, clock: Clock, update: Callable[[], object]) -> None:
    """Give a widget samples until its rate is known."""
    for _ in range(20):
        clock.now += 1 / rate
        update()


class Waits(Waiters):
    """The waits for a widget; records the time-outs, and skips the waiting."""

    def __init__(self, lock: Any) -> None:
        super().__init__(lock)
        self.timeouts: list[float] = []

    def wait_for(self, find: Callable[[], Any], seconds: float) -> Any:
        self.timeouts.append(seconds)
        return find()


def timeouts_of(widget: Any) -> Waits:
    """Return the time-outs with which threads wait for samples of a widget from now on."""
    newest = get_newest(widget)
    newest.waiters = waits = Waits(newest.lock)
    return waits


def waiting(widget: Any) -> int:
    """Return the number of threads that wait for a sample of a widget."""
    return len(get_newest(widget).waiters)


class TestTheNextOne:
    def test_what_has_come_is_given_at_once_and_newest_though_the_widget_is_frozen(self, widget: NumberWidget) -> None:
        widget.update(1)
        assert widget.wait(0).value == 1
        widget.paused = True
        widget.update(2)
        widget.update(3)
        assert widget.wait(0).value == 3

    def test_no_sample_is_given_twice_to_one_thread(self, widget: NumberWidget) -> None:
        widget.update(1)
        assert widget.wait(0).value == 1
        with pytest.raises(TimeoutError, match=r"^NumberWidget had no new number for \d+\.\d+ s$"):
            widget.wait(0.02)
        threading.Timer(0.05, widget.update, [2]).start()
        assert widget.wait(240.0).value == 2

    def test_each_thread_is_given_each_one(self, widget: NumberWidget) -> None:
        widget.update(1)
        assert widget.wait(0).value == 1
        got: list[int] = []
        in_a_thread(lambda: got.append(widget.wait(0).value))
        assert got == [1]
        with pytest.raises(TimeoutError):
            widget.wait(0)

    def test_a_thread_that_has_the_number_of_one_that_ended_has_been_given_nothing(self, widget: NumberWidget) -> None:
        widget.update(1)
        given: list[tuple[int, int]] = []
        for _ in range(50):
            in_a_thread(lambda: given.append((threading.get_ident(), widget.wait(0).value)))
        assert len({ident for ident, _ in given}) < 50, "the system reused the number"
        assert [value for _, value in given] == [1] * 50

    def test_a_sample_shown_again_is_not_the_next_one(self) -> None:
        laser, speed = LaserWidget(), SpeedWidget()
        laser.update(scan(1.5))
        speed.update(twist(0.25))
        laser.wait(0)
        speed.wait(0)
        laser.angle_offset = 0.5
        speed.reset_peaks()
        speed.command(twist(0.5))
        for widget in (laser, speed):
            with pytest.raises(TimeoutError):
                widget.wait(0)

    def test_an_old_one_is_given_to_no_caller(self, widget: NumberWidget, clock: Clock) -> None:
        feed_at(10, clock, lambda: (widget.update(1), widget.rate))
        clock.now += 0.99
        got: list[int] = []
        in_a_thread(lambda: got.append(widget.wait(0).value))
        assert got == [1]
        clock.now += 0.02
        with pytest.raises(TimeoutError, match=r"^NumberWidget had no new number for 1.0 s$"):
            widget.wait(0)

    def test_what_was_filled_by_hand_is_given_for_ten_seconds(self, widget: NumberWidget, clock: Clock) -> None:
        widget.update(1)
        clock.now += 9.9
        assert widget.wait(0).value == 1
        widget.update(2)
        clock.now += 10.1
        with pytest.raises(TimeoutError, match=r"^NumberWidget had no new number for 10.1 s$"):
            widget.wait(0)

    def test_the_player_of_a_recording_is_asked_what_it_shows(self, widget: NumberWidget, clock: Clock) -> None:
        widget.has_rate, widget.driven_by_player = False, True
        widget.update(1)
        clock.now += 3600
        assert [widget.wait(0).value for _ in range(3)] == [1, 1, 1]


class TestTheTimeout:
    @pytest.mark.parametrize(
        ("rate", "seconds"), [(40, 1), (3.1, 1), (2, 1.5), (1, 3), (0.5, 6), (0.2, 10), (0.05, 10)]
    )
    def test_is_three_periods_from_one_second_to_ten(
        self, widget: NumberWidget, clock: Clock, rate: float, seconds: float
    ) -> None:
        waits = timeouts_of(widget)
        feed_at(rate, clock, lambda: (widget.update(1), widget.wait()))
        with pytest.raises(TimeoutError):
            widget.wait()
        assert waits.timeouts[0] == 10, "a first sample has no rate"
        assert waits.timeouts[-1] == pytest.approx(seconds)

    def test_is_ten_seconds_before_the_first(self, widget: NumberWidget) -> None:
        waits = timeouts_of(widget)
        with pytest.raises(TimeoutError, match=r"^NumberWidget had nothing to show in 10 s: no feed is connected"):
            widget.wait()
        assert waits.timeouts == [10]

    def test_is_ten_seconds_where_a_source_speaks_in_events(self, clock: Clock) -> None:
        touch = TouchWidget()
        waits = timeouts_of(touch)
        for mode, seconds in ((TouchMode.EVENT, 10), (TouchMode.LEVEL, 1)):
            feed_at(10, clock, lambda mode=mode: (touch.update(Touch({"left": True}, mode)), touch.wait()))
            with pytest.raises(TimeoutError):
                touch.wait()
            assert waits.timeouts[-1] == seconds

    def test_is_the_given_value(self, widget: NumberWidget, clock: Clock) -> None:
        waits = timeouts_of(widget)
        feed_at(40, clock, lambda: (widget.update(1), widget.wait(7)))
        for seconds in (0, 0.25, 30, 1e300):
            with pytest.raises(TimeoutError):
                widget.wait(seconds)
        assert waits.timeouts == [7] * 20 + [0, 0.25, 30, 1e300]

    def test_ends_a_loop_when_the_scanner_dies(self) -> None:
        laser, driven = LaserWidget(), 0

        def scanner() -> None:
            for _ in range(12):
                laser.update(scan(1.5))
                time.sleep(0.05)

        def drive() -> None:
            nonlocal driven
            while laser.wait().nearest().range > 0.7:
                driven += 1

        threading.Thread(target=scanner).start()
        with pytest.raises(TimeoutError, match=r"^LaserWidget had no new scan for \d+\.\d s$"):
            drive()
        assert 0 < driven <= 12

    def test_an_interrupt_ends_it_at_once(self, widget: NumberWidget) -> None:
        main = threading.main_thread().ident

        def interrupt() -> None:
            wait_for(lambda: waiting(widget), "it waits")
            signal.pthread_kill(main, signal.SIGINT)

        thread = threading.Thread(target=interrupt)
        thread.start()
        with pytest.raises(KeyboardInterrupt):
            widget.wait(1000.0)
        assert waiting(widget) == 0
        thread.join()

    @pytest.mark.parametrize(
        ("timeout", "error", "words"),
        [
            (-1, ValueError, "timeout: expected seconds, 0 or more, got -1"),
            (nan, ValueError, "timeout: expected a finite number of seconds, got nan"),
            (inf, ValueError, "timeout: expected a finite number of seconds, got inf"),
            ("long", TypeError, "timeout: expected a number, got 'long'"),
        ],
    )
    def test_is_a_number_of_seconds(
        self, widget: NumberWidget, timeout: Any, error: type[Exception], words: str
    ) -> None:
        with pytest.raises(error, match=f"^{words}"):
            widget.wait(timeout)


def test_all_waiting_threads_get_the_first_one_and_none_spins_meanwhile(widget: NumberWidget) -> None:
    got: list[Any] = []
    busy: list[float] = []

    def wait() -> None:
        began = time.thread_time()
        got.append(widget.wait(240.0))
        busy.append(time.thread_time() - began)

    threads = [threading.Thread(target=wait) for _ in range(3)]
    for thread in threads:
        thread.start()
    wait_for(lambda: waiting(widget) == 3, "all wait")
    in_a_thread(widget.update, 7)
    for thread in threads:
        thread.join()
    assert [number.value for number in got] == [7, 7, 7]
    assert max(busy) < 0.05
    assert waiting(widget) == 0


def test_a_busy_main_thread_gets_the_first_scan_of_a_feed() -> None:
    laser = LaserWidget()
    script = Scripted(SCAN)
    with Feed(script) as feed:
        feed.connect("/scan", laser)
        threading.Timer(0.05, lambda: script.listener.on_message("/scan", scan(1.5))).start()
        assert laser.wait(240.0).nearest().range == 1.5


def test_a_commanded_speed_is_not_a_measured_one() -> None:
    speed = SpeedWidget()
    speed.command(twist(0.5))
    with pytest.raises(TimeoutError, match=r"^SpeedWidget had nothing to show in 0.01 s: no feed is connected to it"):
        speed.wait(0.01)
    speed.update(twist(0.25))
    assert speed.wait().linear[0] == 0.25


def test_a_touch_is_given_as_it_came() -> None:
    touch = TouchWidget()
    touch.update(left=True)
    assert touch.wait().touched == {"left": True}


def test_if_none_comes_the_error_has_the_reason() -> None:
    laser, script = LaserWidget(), Scripted(SCAN, ODOM)

    def why() -> str:
        with pytest.raises(TimeoutError) as error:
            laser.wait(0.01)
        return str(error.value)

    alone = "no feed is connected to it; feed.connect(topic, widget) does that"
    assert why() == f"LaserWidget had nothing to show in 0.01 s: {alone}"
    feed = Feed(script)
    feed.connect("/scna", laser)
    missing = "no such topic /scna; there are /scan, /odom; did you mean /scan?"
    assert why() == f"LaserWidget /scna had nothing to show in 0.01 s: {missing}"
    feed.disconnect("/scna")
    feed.connect("/odom", laser)
    in_a_thread(script.listener.on_message, "/odom", twist(1.0))
    assert why().startswith(
        "LaserWidget /odom had nothing to show in 0.01 s: what came could not be shown: expected a message"
    )
    feed.close()
    assert why().startswith(
        "LaserWidget /odom had nothing to show in 0.01 s: the feed is closed; what came could not be shown"
    )


def test_if_no_next_one_comes_the_error_has_the_age_of_the_last_and_the_reason() -> None:
    laser, script = LaserWidget(), Scripted(SCAN)
    feed = Feed(script)
    feed.connect("/scan", laser)
    in_a_thread(script.listener.on_message, "/scan", scan(1.5))
    assert laser.wait(0).ranges[0] == 1.5
    feed.close()
    with pytest.raises(TimeoutError, match=r"^LaserWidget /scan had no new scan for \d+\.\d+ s: the feed is closed$"):
        laser.wait(0.01)


def test_a_function_that_is_connected_may_wait_for_what_comes_next() -> None:
    laser, got, script = LaserWidget(), [], Scripted(SCAN)
    with Feed(script) as feed:
        feed.connect("/scan", laser)
        feed.connect("/scan", lambda _: got or got.append([laser.wait(240.0).ranges[0] for _ in range(2)]))
        script.listener.on_message("/scan", scan(1.5))
        wait_for(lambda: waiting(laser), "the function waits for the next one")
        script.listener.on_message("/scan", scan(2.5))
        wait_for(lambda: got and got[0] == [1.5, 2.5], "it was given both")


def test_a_loop_that_waits_for_what_it_hands_on_itself_goes_on_when_the_time_is_over(widget: NumberWidget) -> None:
    async def wait() -> None:
        asyncio.get_running_loop().call_soon(widget.update, 1)
        with pytest.raises(TimeoutError, match=r"^NumberWidget had nothing to show in 0.05 s"):
            widget.wait(0.05)
        await asyncio.sleep(0)
        assert widget.wait(0).value == 1

    asyncio.run(wait())
