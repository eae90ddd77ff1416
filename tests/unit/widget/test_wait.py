"""What all widgets share: a program waits for the first sample."""

from __future__ import annotations

import asyncio
import threading
import time
from math import inf, nan
from typing import Any

import pytest

from robowidgets import LaserWidget, SpeedWidget, TouchWidget
from robowidgets.feeds import Feed

from ..feeds.scripted import ODOM, SCAN, Scripted, scan, twist
from ..waiting import wait_for
from .number_widget import NumberWidget, in_a_thread


def test_what_has_come_is_given_at_once_and_newest_though_the_widget_is_frozen(widget: NumberWidget) -> None:
    widget.update(1)
    assert widget.wait(0).value == 1
    widget.paused = True
    widget.update(2)
    assert widget.wait(0).value == 2


def test_all_who_wait_get_the_first_one_and_nobody_spins_meanwhile(widget: NumberWidget) -> None:
    got: list[Any] = []
    busy: list[float] = []

    def wait() -> None:
        began = time.thread_time()
        got.append(widget.wait(20.0))
        busy.append(time.thread_time() - began)

    threads = [threading.Thread(target=wait) for _ in range(3)]
    for thread in threads:
        thread.start()
    wait_for(lambda: widget._waiting == 3, "all wait")
    in_a_thread(widget.update, 7)
    for thread in threads:
        thread.join(20.0)
    assert [number.value for number in got] == [7, 7, 7]
    assert max(busy) < 0.05
    assert widget._waiting == 0


def test_a_busy_main_thread_gets_the_first_scan_of_a_feed() -> None:
    laser = LaserWidget()
    script = Scripted(SCAN)
    with Feed(script) as feed:
        feed.connect("/scan", laser)
        threading.Timer(0.05, lambda: script.listener.on_message("/scan", scan(1.5))).start()
        assert laser.wait().nearest().range == 1.5


def test_a_commanded_speed_is_none_that_was_measured() -> None:
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


def test_where_none_comes_it_says_why() -> None:
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


def test_the_thread_that_hands_on_what_is_waited_for_goes_on_when_the_time_is_over() -> None:
    laser, got, script = LaserWidget(), [], Scripted(SCAN)
    with Feed(script) as feed:
        feed.connect("/scan", lambda _: laser.wait(0.05), laser, got.append)
        in_a_thread(script.listener.on_message, "/scan", scan(1.5))
        assert len(got) == 1
        words = "a message of /scan could not be used: TimeoutError: LaserWidget /scan had nothing to show in 0.05 s: "
        assert laser._source["words"].startswith(words)
        assert laser.wait(0).ranges[0] == 1.5


def test_a_loop_that_waits_for_what_it_hands_on_itself_goes_on_when_the_time_is_over(widget: NumberWidget) -> None:
    async def wait() -> None:
        asyncio.get_running_loop().call_soon(widget.update, 1)
        with pytest.raises(TimeoutError, match=r"^NumberWidget had nothing to show in 0.05 s"):
            widget.wait(0.05)
        await asyncio.sleep(0)
        assert widget.wait(0).value == 1

    asyncio.run(wait())


@pytest.mark.parametrize(
    ("timeout", "error", "words"),
    [
        (-1, ValueError, "timeout: expected seconds, 0 or more, got -1"),
        (nan, ValueError, "timeout: expected a finite number of seconds, got nan"),
        (inf, ValueError, "timeout: expected a finite number of seconds, got inf"),
        ("long", TypeError, "timeout: expected a number, got 'long'"),
    ],
)
def test_a_timeout_is_a_number_of_seconds(
    widget: NumberWidget, timeout: Any, error: type[Exception], words: str
) -> None:
    with pytest.raises(error, match=f"^{words}"):
        widget.wait(timeout)
