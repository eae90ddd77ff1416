"""`StopWidget`: the driver, the latch, and the messages that reach it while a cell runs."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from robowidgets.driving.command_watchdog import PROGRAM, ZERO, CommandWatchdog, Velocity
from robowidgets.feeds import Driving, Feed, FeedError
from robowidgets.stop_widget import StopWidget

from ..feeds.scripted import Scripted
from ..pages import Page, from_page, get_observers
from ..waiting import wait_for


@pytest.fixture
def feed(script: Scripted) -> Iterator[Feed]:
    with Feed(script) as opened:
        yield opened


@pytest.fixture
def bar(feed: Feed) -> Iterator[StopWidget]:
    made = StopWidget(feed)
    yield made
    made.close()


def hear(bar: StopWidget, act: str, **more: Any) -> None:
    """Send a message of the page."""
    from_page(bar, {"act": act, "press": "view", **more})


def test_it_shows_the_driver_and_the_warnings_about_it(feed: Feed, bar: StopWidget) -> None:
    page = Page(bar)
    feed.driving = Driving(topic="/base/cmd_vel")
    feed.drive(0.2, 0.5)
    wait_for(lambda: page.state["_state"]["speed"] == (0.2, 0.5, 0.0), "the speed is reported")
    state = page.state["_state"]
    assert (state["driver"], state["topic"]) == (PROGRAM, "/base/cmd_vel")
    assert state["status"] == "/base/cmd_vel has no subscriber, unlike /cmd_vel"
    wait_for(lambda: page.state["_state"]["driver"] == "", "the speed's time is over")
    feed.watchdog.take("hand")
    wait_for(lambda: page.state["_state"]["driver"] == "hand", "a hand holds a pad")
    wait_for(lambda: page.state["_state"]["driver"] == "", "the page of the hand is gone")
    bar.close()
    assert get_observers(feed.connection) == []


def test_stop_latches_and_closing_the_bar_releases_nothing(feed: Feed, script: Scripted, bar: StopWidget) -> None:
    feed.drive(0.2, 0.5)
    hear(bar, "stop")
    wait_for(lambda: script.speeds == [(0.2, 0.5), (0.0, 0.0)], "it stops")
    assert bar.stopped is feed.stopped is True
    bar.close()
    with pytest.raises(FeedError, match="Stop is pressed"):
        feed.drive(0.2, 0.5)


def test_a_bare_watchdog_will_do() -> None:
    heard: list[tuple[float, ...]] = []
    watchdog = CommandWatchdog(lambda *speed: heard.append(speed))
    bar = StopWidget(watchdog)
    assert bar.get_state()["_state"]["ready"] is True
    watchdog.drive(Velocity(0.1), 3600.0)
    wait_for(lambda: heard, "it drives")
    bar.stopped = True
    wait_for(lambda: heard == [Velocity(0.1), ZERO], "it stops")
    bar.stopped = False
    watchdog.drive(Velocity(0.1), 3600.0)
    bar.close()
    watchdog.close()


def test_of_a_feed_that_is_closed_it_says_so_and_stops_nothing(feed: Feed, script: Scripted, bar: StopWidget) -> None:
    feed.close()
    state = bar.get_state()["_state"]
    assert (state["ready"], state["cause"]) == (False, "the feed is closed")
    hear(bar, "stop")
    assert script.speeds == []


def test_each_message_tells_the_feed_that_a_page_is_there(feed: Feed, bar: StopWidget) -> None:
    feed.driving = Driving(needs_page=True)
    with pytest.raises(FeedError, match="no page"):
        feed.drive(0.1)
    hear(bar, "beat")
    feed.drive(0.1)


def test_a_zero_that_fails_is_reported_until_it_was_sent(feed: Feed, script: Scripted, bar: StopWidget) -> None:
    page = Page(bar)
    feed.drive(0.2, 0.5)
    script.broken = "no room"
    bar.stopped = True
    text = "Sending zero to the robot failed: no room"
    wait_for(lambda: page.state["_state"]["error"] == text, "it is reported")
    assert page.state["_state"]["speed"] == (0.2, 0.5, 0.0), "it is assumed to move"
    script.broken = ""
    wait_for(lambda: page.state["_state"]["error"] == "", "the zero was sent after all")
    assert page.state["_state"]["speed"] == ZERO


def test_a_bar_has_no_press(bar: StopWidget, caplog: pytest.LogCaptureFixture) -> None:
    hear(bar, "press")
    wait_for(lambda: "act: expected stop, allow or beat for a Stop, got press" in caplog.text, "it is logged")


@pytest.mark.parametrize("robot", [None, 3, print, SimpleNamespace(watchdog=3)])
def test_what_has_no_watchdog_is_refused(robot: Any) -> None:
    with pytest.raises(TypeError, match=r"^StopWidget\(\): expected a feed or a watchdog, got "):
        StopWidget(robot)
