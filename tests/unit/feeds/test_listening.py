"""The rates and values of a feed for the list of topics while a page looks, and their low cost."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from robowidgets import LaserWidget, MessageWidget
from robowidgets.feeds import Advert, Feed
from robowidgets.feeds._listening import PROBE_PAUSE_S, PROBE_TIMEOUT_S, PROBED_RATE_HZ, UPDATE_PERIOD_S, Listening
from robowidgets.feeds._subscription import RARE, SOON
from robowidgets.feeds._wires import FeedWires
from robowidgets.runtime.clock import Threads
from robowidgets.samples.staleness import LISTED, SEEN_FOR
from robowidgets.wires_widget import Wire

from ..clocks import ManualClock
from ..pages import from_page
from ..waiting import wait_for
from .scripted import IMU, SCAN, Scripted, scan

NUMBER = Advert("/temperature", "std_msgs/msg/Float64")
LEFT, RIGHT = Advert("/left", "sensor_msgs/msg/Image"), Advert("/right", "sensor_msgs/msg/Image")
MAP = Advert("/map", "nav_msgs/msg/OccupancyGrid")
PICTURE = {"height": 480, "width": 640}


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def script() -> Scripted:
    return Scripted(SCAN, IMU, NUMBER, LEFT, RIGHT, MAP)


@pytest.fixture
def feed(script: Scripted, clock: ManualClock) -> Iterator[Feed]:
    with Feed(script, clock=clock) as opened:
        opened.connection.listening = Listening(opened.connection, Threads(clock))
        yield opened


class Looking:
    """A page that shows the list of topics of a robot."""

    def __init__(self, feed: Feed, monkeypatch: pytest.MonkeyPatch, *shown: str) -> None:
        self.view = feed.show(*shown)
        self.told: list[dict[str, Any]] = []
        monkeypatch.setattr(self.view.topic_list, "send", self.told.append)

    def look(self, *names: str) -> None:
        from_page(self.view.topic_list, {"look": [*names]})

    def says(self, name: str) -> dict[str, Any]:
        """The last report of a topic to the page: its text, its rate, its count."""
        last = self.told[-1]
        return {"value": last["values"].get(name), **last["now"].get(name, {})}


@pytest.fixture
def page(feed: Feed, monkeypatch: pytest.MonkeyPatch) -> Iterator[Looking]:
    looking = Looking(feed, monkeypatch, "/scan")
    yield looking
    looking.view.close()


def send(script: Scripted, clock: ManualClock, name: str, message: Any, times: int, every: float) -> None:
    for _ in range(times):
        script.listener.on_message(name, message)
        clock.advance(every)


def test_rates_and_values_come_of_the_topics_that_a_page_looks_at_and_of_no_others(
    script: Scripted, page: Looking, clock: ManualClock
) -> None:
    clock.advance(60)
    assert (script.followed, page.told) == ({"/scan"}, [])
    page.look("/scan", "/temperature")
    clock.advance()
    assert script.followed == {"/scan", "/temperature"}
    assert page.says("/temperature") == {"value": "nothing yet", "rate": None, "messages": None}
    for _ in range(4):
        script.listener.on_message("/temperature", {"data": 21.5})
        send(script, clock, "/scan", scan(0.5), 5, 0.1)
    assert page.says("/temperature") == {"value": "21.5", "rate": 2.0, "messages": 4}
    assert page.says("/scan")["value"] == "nearest 0.5 m, 1 ray"
    assert page.says("/scan")["rate"] == pytest.approx(10, abs=0.2)
    assert page.says("/imu") == {"value": None}


def test_a_list_that_is_folded_and_a_page_that_has_gone_cost_nothing(
    script: Scripted, page: Looking, clock: ManualClock
) -> None:
    page.look("/temperature")
    clock.advance()
    assert "/temperature" in script.followed
    page.look()
    clock.advance(1)
    assert (script.followed, page.told[-1]) == ({"/scan"}, {"values": {}, "now": {}})
    page.look("/temperature")
    clock.advance(SEEN_FOR - 1)
    page.look("/temperature")
    clock.advance(SEEN_FOR - 1)
    assert "/temperature" in script.followed
    clock.advance(2)
    assert script.followed == {"/scan"}
    told = len(page.told)
    clock.advance(60)
    assert len(page.told) == told
    page.look("/temperature")
    page.view.close()
    clock.advance(1)
    assert script.followed == frozenset()


def test_two_views_of_a_list_each_have_what_they_show(script: Scripted, page: Looking, clock: ManualClock) -> None:
    def look(view: str, *names: str) -> None:
        from_page(page.view.topic_list, {"look": [*names], "view": view})

    look("one", "/scan", "/temperature")
    look("other", "/scan")
    clock.advance()
    script.listener.on_message("/temperature", {"data": 21.5})
    clock.advance(UPDATE_PERIOD_S)
    assert page.says("/temperature")["value"] == "21.5"
    look("other")
    clock.advance(UPDATE_PERIOD_S)
    assert page.says("/temperature")["value"] == "21.5", "also if the other is scrolled out of view"
    look("one", "/scan")
    clock.advance(UPDATE_PERIOD_S)
    assert page.says("/temperature") == {"value": None}
    look("one")
    clock.advance(UPDATE_PERIOD_S)
    assert page.told[-1] == {"values": {}, "now": {}}
    look("one", "/temperature")
    clock.advance(SEEN_FOR / 2)
    look("other", "/scan")
    clock.advance(UPDATE_PERIOD_S)
    assert page.says("/temperature")["value"] == "nothing yet"
    clock.advance(SEEN_FOR / 2)
    look("other", "/scan")
    clock.advance(UPDATE_PERIOD_S)
    assert page.says("/temperature") == {"value": None}, "a closed page no longer looks"


def test_large_topics_are_glanced_at_one_after_the_other_for_a_few_messages(
    script: Scripted, page: Looking, clock: ManualClock
) -> None:
    page.look("/left", "/right")
    clock.advance()
    assert script.followed == {"/scan", "/left"}
    send(script, clock, "/left", PICTURE, 8, 0.04)
    assert script.followed == {"/scan"}
    clock.advance(UPDATE_PERIOD_S)
    assert page.says("/left") == {"value": "height 480, width 640", "rate": 25.0, "messages": None}
    assert script.followed == {"/scan", "/right"}  # which is silent
    clock.advance(PROBE_TIMEOUT_S + UPDATE_PERIOD_S)
    assert script.followed == {"/scan"}
    assert page.says("/right") == {"value": "", "rate": None, "messages": None}
    clock.advance(PROBE_PAUSE_S)
    assert script.asked.count(("subscribe", "/left")) == 2


def test_a_topic_that_is_very_fast_is_glanced_at_once_its_rate_is_known(
    script: Scripted, page: Looking, clock: ManualClock
) -> None:
    page.look("/imu")
    clock.advance()
    send(script, clock, "/imu", {"data": 1.0}, 400, 0.005)
    assert page.says("/imu")["rate"] == pytest.approx(2 * PROBED_RATE_HZ, rel=0.02)
    assert script.followed == {"/scan"}
    clock.advance(PROBE_PAUSE_S)
    assert script.followed == {"/scan", "/imu"}
    send(script, clock, "/imu", {"data": 1.0}, 150, 0.01)
    assert page.says("/imu")["rate"] == pytest.approx(PROBED_RATE_HZ, rel=0.02)


def test_a_large_topic_that_is_shown_anyway_is_counted_in_full(
    feed: Feed, script: Scripted, page: Looking, clock: ManualClock
) -> None:
    feed.connect("/left", MessageWidget())
    page.look("/left")
    clock.advance()
    send(script, clock, "/left", PICTURE, 20, 0.1)
    assert page.says("/left")["messages"] == 20
    clock.advance(PROBE_TIMEOUT_S + 1)
    assert "/left" in script.followed


def test_a_topic_that_is_silent_says_so(script: Scripted, page: Looking, clock: ManualClock) -> None:
    page.look("/temperature")
    clock.advance()
    send(script, clock, "/temperature", {"data": 21.5}, 20, 0.1)
    assert "silent" not in page.says("/temperature")
    clock.advance(LISTED.shortest + 1)
    silent = page.says("/temperature")
    assert (silent["value"], silent["rate"], silent["silent"]) == ("21.5", 0.0, 4)


def test_a_large_topic_is_silent_once_a_whole_glance_has_missed_it(
    script: Scripted, page: Looking, clock: ManualClock, feed: Feed
) -> None:
    def wire() -> Wire:
        return next(wire for wire in FeedWires(feed.connection).wiring.wires if wire.name == "/left")

    page.look("/left")
    clock.advance()
    send(script, clock, "/left", PICTURE, 8, 0.04)
    clock.advance(PROBE_PAUSE_S - 1)
    assert ("silent" in page.says("/left"), page.says("/left")["rate"]) == (False, 25.0)
    assert (wire().is_glanced_at, wire().rate, wire().age) == (True, 25.0, pytest.approx(PROBE_PAUSE_S - 1, abs=0.1))
    clock.advance(1 + PROBE_TIMEOUT_S + UPDATE_PERIOD_S)
    assert (page.says("/left")["rate"], page.says("/left")["silent"]) == (
        0.0,
        pytest.approx(PROBE_PAUSE_S + PROBE_TIMEOUT_S, abs=1),
    )
    assert (wire().is_glanced_at, wire().age) == (False, pytest.approx(PROBE_PAUSE_S + PROBE_TIMEOUT_S, abs=1))
    clock.advance(PROBE_PAUSE_S + UPDATE_PERIOD_S)
    script.listener.on_message("/left", PICTURE)
    clock.advance(UPDATE_PERIOD_S)
    assert "silent" not in page.says("/left")


def test_a_late_subscriber_gets_kept_messages_and_nothing_old_of_a_sensor(
    feed: Feed, script: Scripted, clock: ManualClock
) -> None:
    """The list listens to everything, so that a later connection is not the first to ask."""
    grid = {"info": {"width": 2, "height": 1}, "data": [0, 100]}
    for name in ("/map", "/scan", "/temperature"):
        feed.connect(name, MessageWidget())
    clock.advance(SOON / 2)
    script.listener.on_message("/map", grid)
    script.listener.on_message("/scan", scan(0.5))
    clock.advance(SOON)
    script.listener.on_message("/temperature", {"data": 21.5})
    clock.advance(60)
    kept, scanned, warm = (MessageWidget() for _ in range(3))
    got: list[Any] = []
    for name, widget in (("/scan", scanned), ("/temperature", warm), ("/map", kept)):
        feed.connect(name, widget, got.append, raw=True)
    wait_for(lambda: bool(got), "the function is called")
    assert (got, kept["data"], scanned.message, warm.message) == ([grid], [0, 100], None, None)

    for _ in range(3):  # another map now and then is kept, too; many are not maps that a program needs
        script.listener.on_message("/map", {"data": [100]})
        clock.advance(RARE * 2)
    late = MessageWidget()
    feed.connect("/map", late)
    assert late["data"] == [100]
    send(script, clock, "/map", grid, 100, 0.1)
    later = MessageWidget()
    feed.connect("/map", later)
    assert later.message is None


def test_what_was_kept_before_the_robot_was_lost_is_not_passed_on(
    feed: Feed, script: Scripted, clock: ManualClock
) -> None:
    feed.connect("/map", MessageWidget())
    script.listener.on_message("/map", {"data": [100]})
    script.lose()
    script.connect()
    late = MessageWidget()
    feed.connect("/map", late)
    assert late.message is None


def test_an_observer_that_raises_is_called_again_and_delays_no_other(
    feed: Feed, clock: ManualClock, caplog: pytest.LogCaptureFixture
) -> None:
    failed: list[bool] = []
    told: list[bool] = []

    def fail(is_seen: bool) -> None:
        failed.append(is_seen)
        raise ValueError("no number")

    feed.connection.listening.look(fail, lambda: ["/temperature"])
    feed.connection.listening.look(told.append, lambda: ["/temperature"])
    clock.advance(2 * UPDATE_PERIOD_S)
    assert failed[:2] == told[:2] == [True, True]
    assert len([one for one in caplog.records if "ValueError: no number" in one.message]) == 1


def test_the_topics_to_look_at_are_asked_for_again_after_an_error(feed: Feed, clock: ManualClock) -> None:
    told: list[bool] = []
    wanted = iter([ValueError("no names")])

    def names() -> list[str]:
        for error in wanted:
            raise error
        return ["/temperature"]

    feed.connection.listening.look(told.append, names)
    clock.advance(2 * UPDATE_PERIOD_S)
    assert told


def test_messages_that_newer_ones_replaced_count_for_the_rates_of_list_and_card(
    feed: Feed, script: Scripted, page: Looking, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.widget.newest_sample.time", SimpleNamespace(monotonic=clock.now))
    card = LaserWidget()
    feed.connect("/scan", card)
    page.look("/scan", "/imu")
    clock.advance()
    for _ in range(100):  # each has replaced four others: 200 per second
        for name, message in (("/scan", scan(0.5)), ("/imu", {"data": 1.0})):
            script.listener.on_message(name, message, replaced=4)
        clock.advance(0.025)
        rate = card.rate
    clock.advance(UPDATE_PERIOD_S)
    assert page.says("/scan")["rate"] == pytest.approx(200, rel=0.02)
    assert page.says("/imu")["rate"] == pytest.approx(200, rel=0.02)
    assert rate == pytest.approx(200, rel=0.02)
    assert page.says("/scan")["messages"] == 5 * 100 - 4, "all but those before the first"


def test_a_burst_of_a_large_topic_is_not_a_rate(script: Scripted, page: Looking, clock: ManualClock) -> None:
    page.look("/left")
    clock.advance()
    for _ in range(12):
        send(script, clock, "/left", PICTURE, 2, 0.001)
        clock.advance(0.1)
    assert page.says("/left")["rate"] == pytest.approx(20, abs=3)
