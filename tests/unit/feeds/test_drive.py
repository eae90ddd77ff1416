"""Driving: limits, types, and the zero that follows."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Mapping
from math import inf, nan
from typing import Any

import pytest

from robowidgets.behaviors import Drive
from robowidgets.driving.command_watchdog import RETRY, SETTLE, RefusedError, Velocity
from robowidgets.feeds import Advert, Driving, Feed, FeedError
from robowidgets.feeds._guard.link import GuardLink
from robowidgets.feeds._open_feeds import _close_all as close_at_end
from robowidgets.feeds.middleware import NotConnectedYetError
from robowidgets.runtime.clock import Clock, scheduler

from ..clocks import ManualClock
from ..driving.test_drive_widget import Pad
from ..waiting import wait_for
from .scripted import CMD_VEL, ODOM, SCAN, Scripted, set_connect_timeout, set_discovery_timeout, twist

STAMPED = CMD_VEL._replace(type="geometry_msgs/msg/TwistStamped")

Driven = Callable[..., tuple[Feed, Scripted]]


@pytest.fixture
def driven(monkeypatch: pytest.MonkeyPatch) -> Iterator[Driven]:
    """Opens feeds on a script, with a short wait for subscribers, and closes them.

    Their speeds hold long, unless a test names a hold: a busy machine may send one late.
    """
    set_discovery_timeout(monkeypatch, 0.02)
    there: list[Feed] = []

    def open_one(
        *topics: Advert, connected: bool = True, clock: Clock = scheduler.clock, **driving: float
    ) -> tuple[Feed, Scripted]:
        script = Scripted(*topics, connected=connected)
        there.append(Feed(script, clock=clock))
        there[-1].driving = Driving(**{"hold": 60.0, **driving})  # type: ignore[arg-type]
        return there[-1], script

    yield open_one
    for feed in there:
        clock = feed.connection.clock
        if isinstance(clock, ManualClock):
            closing = clock.beside(feed.close)
            wait_for(lambda: clock.advance(0.1) or not closing.is_alive(), "it is closed")  # noqa: B023
            clock.advance(1.0)  # its thread ends a moment later
        feed.close()


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


def test_a_speed_is_cut_to_the_limits(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, max_linear=0.3, max_angular=0.8, hold=60.0)
    for given, sent in (((0.2, -0.5), (0.2, -0.5)), ((5.0, -5.0), (0.3, -0.8)), ((-5.0,), (-0.3, 0.0))):
        feed.drive(*given)
        wait_for(lambda sent=sent: script.speeds[-1:] == [sent], "it is sent")  # type: ignore[misc]
    topic, kind, message = script.sent[0]
    assert (topic, kind) == ("/cmd_vel", "geometry_msgs/msg/Twist")
    assert message == {"linear": {"x": 0.2, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": -0.5}}


@pytest.mark.parametrize("there", [CMD_VEL, STAMPED])
def test_a_robot_that_moves_sideways_gets_speeds_within_its_limit(driven: Driven, there: Advert) -> None:
    feed, script = driven(there, max_lateral=0.3, hold=60.0)
    for given, sent in ((0.07, 0.07), (-5.0, -0.3)):
        feed.drive(0.1, lateral=given)
        wait_for(lambda sent=sent: sidewards(script)[-1:] == [sent], "it is sent")  # type: ignore[misc]
    assert feed.drive_status == "-5 m/s sideways is cut to -0.3"
    assert feed.watchdog.sent.as_speed.linear == (0.1, -0.3, 0.0)
    feed.stop()
    assert (script.speeds[-1], sidewards(script)[-1]) == ((0.0, 0.0), 0.0)
    with pytest.raises(ValueError, match="lateral: expected a finite number of m/s, got nan"):
        feed.drive(lateral=nan)


def test_a_robot_that_is_not_known_to_move_sideways_refuses_in_words_and_gets_nothing(driven: Driven) -> None:
    feed, script = driven(CMD_VEL)
    words = (
        r"^cannot drive: lateral is 0.07 m/s, but this robot is not known to move sideways; "
        r"if it does, set its limit: feed.driving = feeds.Driving\(max_lateral=0.3\)$"
    )
    with pytest.raises(FeedError, match=words):
        feed.drive(0.2, 0.1, lateral=0.07)
    assert script.sent == []
    feed.drive(0.2, 0.1, lateral=0)
    assert script.speeds == [(0.2, 0.1)]


def sidewards(script: Scripted) -> list[float]:
    """Linear y of the speeds that were published."""
    return [message.get("twist", message)["linear"]["y"] for _, _, message in script.sent]


@pytest.mark.parametrize(
    ("there", "kind"),
    [
        ([CMD_VEL], "Twist"),
        ([STAMPED], "TwistStamped"),
        ([CMD_VEL._replace(wanted=False), STAMPED], "TwistStamped"),
        ([STAMPED._replace(wanted=None), CMD_VEL], "Twist"),
        ([STAMPED._replace(wanted=None)], "TwistStamped"),
        ([SCAN], "Twist"),
    ],
)
def test_the_message_is_the_one_that_the_robot_listens_to(driven: Driven, there: list[Advert], kind: str) -> None:
    feed, script = driven(*there)
    feed.drive(0.1, 0.2)
    assert script.sent[0][1] == f"geometry_msgs/msg/{kind}"


def taking(script: Scripted, kind: str, error: Exception) -> Callable[..., None]:
    """Return a `publish` of the script that takes this type only."""
    publish = script.publish

    def picky(topic: str, given: str, message: Mapping[str, Any]) -> None:
        if given != kind:
            raise error
        publish(topic, given, message)

    return picky


@pytest.mark.parametrize(("kind", "other"), [(CMD_VEL.type, STAMPED.type), (STAMPED.type, CMD_VEL.type)])
def test_subscribers_of_both_types_get_each_speed_and_one_that_cannot_get_it_is_reported(
    driven: Driven, monkeypatch: pytest.MonkeyPatch, kind: str, other: str
) -> None:
    feed, script = driven(CMD_VEL, STAMPED, hold=60.0)
    with monkeypatch.context() as patch:
        patch.setattr(script, "publish", taking(script, kind, FeedError(f"no {other} here")))
        feed.drive(0.1)
        feed.stop()
        assert [sent for _, sent, _ in script.sent] == [kind, kind]
        assert feed.drive_status == f"no {other} here"
    feed.drive(0.1)
    wait_for(lambda: {sent for _, sent, _ in script.sent[-2:]} == {kind, other}, "both get the next one")
    assert script.speeds == [(0.1, 0.0), (0.0, 0.0), (0.1, 0.0), (0.1, 0.0)]
    assert feed.drive_status == ""
    with monkeypatch.context() as patch:
        patch.setattr(script, "publish", taking(script, kind, FeedError(f"no {other} any more")))
        with pytest.raises(FeedError, match=f"no {other} any more"):
            feed.stop()


def test_zero_follows_for_both_types_if_one_may_have_arrived(
    driven: Driven, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = driven(CMD_VEL, STAMPED, hold=60.0, clock=clock)
    with monkeypatch.context() as patch:
        patch.setattr(script, "publish", taking(script, STAMPED.type, TimeoutError("the network hangs")))
        with pytest.raises(FeedError, match="the network hangs"):
            feed.drive(0.1)
    clock.advance(RETRY)
    assert script.speeds[-2:] == [(0.0, 0.0)] * 2


def test_a_stamped_speed_does_not_carry_the_clock_of_this_machine(driven: Driven) -> None:
    feed, script = driven(STAMPED)
    feed.drive(0.1, 0.2)
    assert script.sent[0][2]["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}
    assert script.speeds[0] == (0.1, 0.2)


def test_each_subscriber_of_a_speed_gets_its_end_even_if_others_came_since(driven: Driven) -> None:
    feed, script = driven(STAMPED, hold=60.0)
    feed.drive(0.3)
    script.listener.on_topics([CMD_VEL, STAMPED])
    feed.stop()
    assert {kind for _, kind, _ in script.sent[1:]} == {STAMPED.type, CMD_VEL.type}
    assert set(script.speeds[1:]) == {(0.0, 0.0)}
    feed.drive(0.3)
    script.listener.on_topics([CMD_VEL._replace(type="std_msgs/msg/String")])
    feed.stop()
    assert {kind for _, kind, _ in script.sent[-2:]} == {STAMPED.type, CMD_VEL.type}
    assert script.speeds[-2:] == [(0.0, 0.0)] * 2


def test_what_one_type_raises_keeps_zero_from_no_other(driven: Driven, monkeypatch: pytest.MonkeyPatch) -> None:
    feed, script = driven(STAMPED, hold=60.0)
    feed.drive(0.3)
    script.listener.on_topics([CMD_VEL, STAMPED])
    feed.drive(0.3)
    wait_for(lambda: len(script.sent) == 3, "both types were sent")
    publish = script.publish

    def picky(topic: str, kind: str, message: Mapping[str, Any]) -> None:
        if kind == CMD_VEL.type:
            raise FeedError("no Twist any more")
        publish(topic, kind, message)

    with monkeypatch.context() as patch:
        patch.setattr(script, "publish", picky)
        with pytest.raises(FeedError, match="no Twist"):
            feed.stop()
    assert (script.sent[-1][1], script.speeds[-1]) == (STAMPED.type, (0.0, 0.0))


def test_another_topic_may_be_driven(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, topic="/base/cmd_vel")
    feed.drive(0.1)
    assert script.sent[0][0] == "/base/cmd_vel"


def test_zero_follows_a_speed_that_is_not_renewed(driven: Driven, clock: ManualClock) -> None:
    feed, script = driven(CMD_VEL, hold=0.5, clock=clock)
    feed.drive(0.3, 0.0)
    clock.advance(0.25)
    assert script.speeds == [(0.3, 0.0)]
    clock.advance(0.25)
    assert script.speeds == [(0.3, 0.0), (0.0, 0.0)]
    wait_for(lambda: clock.advance(0.1) or _driving_threads() == [], "the thread ends with it")
    feed.drive(0.2, 0.0)
    clock.advance(0.5)
    assert script.speeds[2:] == [(0.2, 0.0), (0.0, 0.0)], "it all works again"


def test_zero_follows_a_speed_though_the_program_is_interrupted_while_it_waits_for_it(
    driven: Driven, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = driven(CMD_VEL, hold=0.2)

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(feed.watchdog, "sent_in_time", interrupted)
        with pytest.raises(KeyboardInterrupt):
            feed.drive(0.3)
    wait_for(lambda: script.speeds == [(0.3, 0.0), (0.0, 0.0)], "zero is sent")


def test_a_speed_that_could_not_be_sent_leaves_the_zero_that_was_owed(driven: Driven, clock: ManualClock) -> None:
    feed, script = driven(CMD_VEL, hold=0.5, clock=clock)
    feed.drive(0.3)
    script.broken = "the script is read only"
    clock.advance(0.25)
    assert refused(feed)
    assert feed.watchdog.owes_zero
    script.broken = ""
    clock.advance(0.25)
    assert script.speeds == [(0.3, 0.0), (0.0, 0.0)]


def refused(feed: Feed) -> bool:
    """Return True if a speed is refused. Just after another one it is not: it waits."""
    try:
        feed.drive(0.2)
    except FeedError:
        return True
    return False


def test_a_speed_that_is_renewed_holds(driven: Driven, clock: ManualClock) -> None:
    feed, script = driven(CMD_VEL, hold=1.0, clock=clock)
    for _ in range(5):
        feed.drive(0.3, 0.0)
        clock.advance(0.999)
    assert set(script.speeds) == {(0.3, 0.0)}
    clock.advance(0.001)
    assert script.speeds == [*5 * [(0.3, 0.0)], (0.0, 0.0)]


def test_stopping_sends_zero_at_once_and_once(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, hold=60.0)
    feed.drive(0.3, 0.1)
    feed.stop()
    assert script.speeds == [(0.3, 0.1), (0.0, 0.0)]
    wait_for(lambda: _driving_threads() == [], "the thread ends")
    assert len(script.sent) == 2


def test_closing_sends_zero_first_if_a_speed_still_holds(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, hold=60.0)
    closed_before = []
    feed.drive(0.3, 0.0)
    script.close = lambda: closed_before.append(list(script.speeds))  # type: ignore[method-assign]
    feed.close()
    assert closed_before == [[(0.3, 0.0), (0.0, 0.0)]]
    wait_for(lambda: _driving_threads() == [], "the thread ends")
    feed.stop()
    with pytest.raises(FeedError, match="the feed of the script is closed: open it again"):
        feed.drive(0.1)


def test_driving_by_other_settings_first_stops_the_robot_on_the_previous_topic(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, hold=60.0)
    feed.drive(0.3)
    feed.driving = Driving(topic="/other")
    feed.drive(0.2)
    wait_for(lambda: len(script.sent) == 3, "all is sent")
    assert [topic for topic, _, _ in script.sent] == ["/cmd_vel", "/cmd_vel", "/other"]
    assert script.speeds == [(0.3, 0.0), (0.0, 0.0), (0.2, 0.0)]
    with pytest.raises(TypeError, match=r"driving: expected feeds.Driving\(topic=..., max_linear=...\), got 0.5"):
        feed.driving = 0.5  # type: ignore[assignment]


def test_a_speed_that_comes_while_it_closes_is_not_sent(driven: Driven) -> None:
    feed, script = driven(CMD_VEL)
    said = []

    def drive_while_closing() -> None:
        with pytest.raises(RefusedError, match="it is closed") as error:
            feed.watchdog.drive(Velocity(0.3))
        said.append(error)

    script.close = drive_while_closing  # type: ignore[method-assign]
    feed.close()
    assert len(said) == 1
    assert script.sent == []


def test_closing_a_feed_that_does_not_drive_sends_nothing(driven: Driven) -> None:
    feed, script = driven(CMD_VEL)
    feed.drive(0.0, 0.0)
    feed.close()
    assert script.speeds == [(0.0, 0.0)]


def test_a_robot_that_was_lost_while_it_drove_is_stopped_when_it_is_back(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, hold=0.3)
    feed.drive(0.3, 0.0)
    script.lose()
    lost = "connection lost, trying again in 1 s: no route to host"
    with pytest.raises(FeedError, match=f"cannot drive: {lost}"):
        feed.drive(0.1)
    with pytest.raises(FeedError, match=f"cannot stop: {lost}; zero follows when it can be sent"):
        feed.stop()
    assert script.speeds == [(0.3, 0.0)]
    script.connect()
    wait_for(lambda: len(script.sent) == 2, "zero is sent")
    assert script.speeds[-1] == (0.0, 0.0)
    wait_for(lambda: _driving_threads() == [], "nothing is owed any more")


def test_zero_is_sent_to_a_robot_that_may_hear_it_though_the_connection_counts_as_lost(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, hold=0.2)
    feed.drive(0.3, 0.0)
    script.listener.on_lost("no ROS master", 1.0)
    wait_for(lambda: len(script.sent) == 2, "zero follows the speed all the same")
    feed.stop()
    assert script.speeds[1:] == [(0.0, 0.0)] * 2
    count = len(script.sent)
    script.listener.on_connected()
    wait_for(lambda: len(script.sent) > count, "it is sent once more when the connection is back")
    assert set(script.speeds[1:]) == {(0.0, 0.0)}
    wait_for(lambda: _driving_threads() == [], "then nothing is owed any more")


def test_closing_while_the_connection_counts_as_lost_sends_zero_all_the_same(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, hold=60.0)
    feed.drive(0.3, 0.0)
    script.listener.on_lost("no ROS master", 1.0)
    feed.close()
    assert script.speeds[-1] == (0.0, 0.0)
    wait_for(lambda: _driving_threads() == [], "the thread ends")


def test_a_zero_into_a_dead_connection_is_sent_again_when_it_is_back(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, hold=0.2)
    feed.drive(0.3, 0.0)
    script.deaf = True
    wait_for(lambda: script.unheard and _driving_threads() == [], "zero was sent, and no node received it")
    script.listener.on_lost("the robot did not answer for 10 s", 1.0)
    script.deaf = False
    script.listener.on_connected()
    wait_for(lambda: len(script.sent) == 2, "zero is sent")
    assert script.speeds == [(0.3, 0.0), (0.0, 0.0)]


def test_a_robot_that_was_not_driven_lately_is_left_alone_when_it_is_back(
    driven: Driven, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("driving.command_watchdog", "feeds._twist"):
        monkeypatch.setattr(f"robowidgets.{module}.RECENT", 0.0)
    feed, script = driven(CMD_VEL, hold=60.0)
    feed.drive(0.3, 0.0)
    feed.stop()
    script.listener.on_lost("no route to host", 1.0)
    script.listener.on_connected()
    assert not feed.watchdog.owes_zero
    assert script.speeds == [(0.3, 0.0), (0.0, 0.0)]


def test_driving_otherwise_does_not_forget_the_zero_that_another_topic_is_owed(driven: Driven) -> None:
    feed, script = driven(CMD_VEL, hold=60.0)
    feed.drive(0.3)
    script.deaf = True
    script.listener.on_lost("no route to host", 1.0)
    feed.driving = Driving(topic="/other")
    script.deaf = False
    script.listener.on_connected()
    wait_for(lambda: len(script.sent) == 3, "zero is sent")
    assert [topic for topic, _, _ in script.sent] == ["/cmd_vel", "/cmd_vel", "/other"], "first while it moves"
    assert set(script.speeds[1:]) == {(0.0, 0.0)}


def test_stopping_waits_a_moment_for_the_robot_and_for_a_subscriber(
    driven: Driven, monkeypatch: pytest.MonkeyPatch
) -> None:
    set_discovery_timeout(monkeypatch, 240.0)
    feed, script = driven(connected=False)
    heard = threading.Timer(0.1, lambda: script.listener.on_topics([SCAN, STAMPED]))
    listed = threading.Timer(0.05, lambda: (script.listener.on_topics([SCAN]), heard.start()))
    reached = threading.Timer(0.05, lambda: (script.connect(), listed.start()))
    reached.start()
    feed.stop()
    assert [kind for _, kind, _ in script.sent] == [STAMPED.type]
    assert script.speeds == [(0.0, 0.0)]


def test_stopping_a_robot_that_cannot_be_reached_says_so(driven: Driven) -> None:
    feed, script = driven(connected=False)
    with pytest.raises(FeedError, match="cannot stop: connecting to the script; zero follows when it can be sent"):
        feed.stop()
    assert script.sent == []
    script.connect()
    script.listener.on_topics([CMD_VEL])
    wait_for(lambda: script.speeds == [(0.0, 0.0)], "zero is sent")


def test_an_error_of_any_kind_does_not_keep_the_next_zero_from_being_sent(
    driven: Driven, clock: ManualClock, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    feed, script = driven(CMD_VEL, hold=0.2, clock=clock)

    def cut(*_: object) -> None:
        raise OSError("the wire is cut")

    feed.drive(0.3)
    with monkeypatch.context() as patch:
        patch.setattr(script, "publish", cut)
        clock.advance(0.2)
        wait_for(lambda: caplog.records, "it is logged")
        assert caplog.records[0].message == "sending zero to the robot failed: the wire is cut"
    clock.advance(RETRY)
    assert script.speeds[-1] == (0.0, 0.0)
    wait_for(lambda: clock.advance(0.1) or _driving_threads() == [], "the thread ends")


def test_stopping_a_feed_that_was_closed_without_a_zero_says_so(driven: Driven) -> None:
    feed, script = driven(CMD_VEL)
    feed.close()
    feed.stop()
    feed, script = driven(CMD_VEL)
    feed.drive(0.3)
    script.broken = "no route"
    feed.close()
    with pytest.raises(FeedError, match="cannot stop: zero could not be sent when the feed was closed: no route"):
        feed.stop()


def test_the_middleware_is_closed_whatever_keeps_zero_from_being_sent(
    driven: Driven, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = driven(CMD_VEL)

    def interrupted() -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(feed.watchdog, "close", interrupted)
        with pytest.raises(KeyboardInterrupt):
            feed.close()
    assert script.closed == 1


def test_driving_waits_two_seconds_for_the_robot_and_no_longer(
    driven: Driven, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    set_discovery_timeout(monkeypatch, 2.0)
    feed, script = driven(connected=False, clock=clock)
    driving = clock.beside(lambda: feed.drive(0.1))
    clock.advance(1.999)
    assert script.sent == []
    script.connect()
    script.listener.on_topics([STAMPED])
    driving.join()
    assert script.sent[0][1] == STAMPED.type
    other, _ = driven(connected=False, clock=clock)
    refused: list[str] = []
    driving = clock.beside(lambda: refused.append(words_of(other)))
    clock.advance(1.999)
    assert refused == []
    clock.advance(0.001)
    driving.join()
    assert refused[0].startswith("cannot drive: connecting to the script")


def words_of(feed: Feed) -> str:
    """Return the reason why a speed is not sent, or an empty text."""
    try:
        feed.drive(0.3)
    except FeedError as error:
        return str(error)
    return ""


def connects_after(
    attempts: int, script: Scripted, monkeypatch: pytest.MonkeyPatch, now: Callable[[], float] = time.monotonic
) -> list[float]:
    """Make a subscriber connect only after so many attempts to publish; return the times of all attempts."""
    publish, tried = script.publish, []

    def publish_later(topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        tried.append(now())
        if len(tried) <= attempts:
            raise NotConnectedYetError("/robot listens to it, but has not connected")
        publish(topic, message_type, message)

    monkeypatch.setattr(script, "publish", publish_later)
    return tried


def test_the_first_speed_is_tried_again_while_its_subscriber_connects(
    driven: Driven, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = driven(CMD_VEL, hold=60.0)
    connects_after(3, script, monkeypatch)
    feed.drive(0.3)
    assert script.speeds == [(0.3, 0.0)]


def test_a_subscriber_that_does_not_connect_is_named_after_two_seconds(
    driven: Driven, clock: ManualClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.feeds._driver.RETRY_PAUSE", 1 / 16)  # sixteenths are added without rounding
    feed, script = driven(CMD_VEL, clock=clock)
    tried = connects_after(1000, script, monkeypatch, clock.now)
    refused: list[str] = []
    driving = clock.beside(lambda: refused.append(words_of(feed)))
    clock.advance(1.999)
    assert refused == []
    clock.advance(0.001)
    driving.join()
    assert refused[0].startswith("cannot drive: /robot listens to it, but has not connected")
    assert tried == [1000.0 + i / 16 for i in range(33)]
    for _ in range(2):  # later speeds are not tried again
        tried.clear()
        with pytest.raises(FeedError, match="has not connected"):
            feed.drive(0.3)
        assert len(tried) == 1


def test_a_speed_is_not_tried_again_after_a_stop(driven: Driven, monkeypatch: pytest.MonkeyPatch) -> None:
    set_connect_timeout(monkeypatch, 20.0)
    monkeypatch.setattr("robowidgets.driving.command_watchdog.RETRY", 0.02)
    feed, script = driven(CMD_VEL)
    tried = connects_after(3, script, monkeypatch)
    stop = threading.Thread(target=lambda: (wait_for(lambda: tried, "it is tried"), feed.watchdog.stop()))
    stop.start()
    with pytest.raises(FeedError, match="cannot drive: another call or Stop has stopped the robot"):
        feed.drive(0.3)
    stop.join()
    wait_for(lambda: script.speeds, "zero is sent")
    assert set(script.speeds) == {(0.0, 0.0)}


def test_driving_on_after_the_computer_slept_is_refused_until_older_requests_are_too_old(
    user_limits: None, driven: Driven, clock: ManualClock
) -> None:
    feed, script = driven(CMD_VEL, clock=clock)
    feed.drive(0.0)
    clock.advance(0.1)
    clock.asleep += 3600.0
    for _ in range(2):
        assert words_of(feed).startswith(
            "cannot drive: the computer has slept, and the speed may be based on data from before that"
        )
        feed.drive(0.0)
        clock.advance(0.9)
    assert {speed for speed, _ in script.speeds} == {0.0}
    clock.advance(0.2)
    feed.drive(0.2)
    feed.stop()
    clock.advance(SETTLE)
    clock.asleep += 3600.0
    feed.drive(0.3)  # no program drove before the sleep
    assert [speed for speed, _ in script.speeds if speed] == [0.2, 0.3]


def loses_zeros(attempts: float, script: Scripted, monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Make a robot confirm zero only after so many attempts; return the forward speeds of all attempts."""
    publish, tried = script.publish, []

    def publish_unconfirmed(topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        tried.append(message["linear"]["x"])
        publish(topic, message_type, message)
        if not tried[-1] and tried.count(0.0) <= attempts:
            raise TimeoutError("a subscriber of /cmd_vel has not confirmed zero")

    monkeypatch.setattr(script, "publish", publish_unconfirmed)
    return tried


def test_on_closing_zero_is_sent_again_until_it_is_confirmed(driven: Driven, monkeypatch: pytest.MonkeyPatch) -> None:
    set_connect_timeout(monkeypatch, 1000.0)
    feed, script = driven(CMD_VEL)
    tried = loses_zeros(5, script, monkeypatch)
    feed.drive(0.3)
    feed.close()
    assert tried == [0.3, *[0.0] * 6]
    feed.stop()  # raises nothing, as zero has arrived


def test_a_zero_that_is_not_confirmed_before_the_process_ends_is_logged(
    driven: Driven, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    set_connect_timeout(monkeypatch, 0.2)
    feed, script = driven(CMD_VEL)
    tried = loses_zeros(inf, script, monkeypatch)
    feed.drive(0.3)
    close_at_end()
    assert tried.count(0.0) > 2
    assert (
        "the script: zero may not have reached the robot before the process ended: "
        "a subscriber of /cmd_vel has not confirmed zero" in caplog.messages
    )


class Guarded(Scripted):
    """A robot that is reached through a guard that is about to start."""

    def __init__(self) -> None:
        super().__init__(CMD_VEL)
        self.guard = GuardLink(self.where)


def test_a_stop_while_a_speed_waits_for_the_guard_refuses_it(clock: ManualClock) -> None:
    script = Guarded()
    feed = Feed(script, clock=clock)
    refused: list[str] = []
    driving = clock.beside(lambda: refused.append(words_of(feed)))
    clock.advance(0.3)
    clock.beside(feed.stop)
    clock.advance(0.3)
    assert (script.speeds, refused) == ([(0.0, 0.0)], [])
    script.guard._on_up()
    clock.advance(0.3)
    driving.join()
    assert (script.speeds, refused) == (
        [(0.0, 0.0)],
        ["cannot drive: another call or Stop has stopped the robot meanwhile"],
    )
    clock.beside(feed.close)
    clock.advance(2.0)


def test_a_latched_stop_ends_the_attempts(driven: Driven, monkeypatch: pytest.MonkeyPatch) -> None:
    set_connect_timeout(monkeypatch, 1000.0)
    feed, script = driven(CMD_VEL)
    tried = connects_after(1_000_000, script, monkeypatch)
    latch = threading.Thread(target=lambda: (wait_for(lambda: tried, "it is tried"), setattr(feed, "stopped", True)))
    latch.start()
    with pytest.raises(FeedError, match=r"has not connected|Stop is pressed"):
        feed.drive(0.3)
    latch.join()
    set_connect_timeout(monkeypatch, 0.1)  # closing would wait as long for the robot


def test_words_for_what_cannot_be_driven(driven: Driven) -> None:
    feed, script = driven(CMD_VEL._replace(type="std_msgs/msg/String"))
    with pytest.raises(FeedError, match="cannot drive: /cmd_vel is std_msgs/msg/String, expected geometry_msgs"):
        feed.drive(0.1)
    assert not feed.watchdog.owes_zero
    for bad in (nan, inf):
        with pytest.raises(ValueError, match="linear: expected a finite number of m/s, got"):
            feed.drive(bad)
    with pytest.raises(TypeError, match="angular"):
        feed.drive(0.1, "left")  # type: ignore[arg-type]
    with pytest.raises(
        TypeError, match=r"expected numbers, as in feed.drive\(0\.2, 0\.5\); got Drive\(linear=0\.1, ang"
    ):
        feed.drive(Drive(0.1))  # type: ignore[arg-type]
    script.listener.on_topics([CMD_VEL])
    script.broken = "the script is read only"
    with pytest.raises(FeedError, match="the script is read only"):
        feed.drive(0.1)


def test_a_zero_that_cannot_be_sent_is_logged(driven: Driven, caplog: pytest.LogCaptureFixture) -> None:
    feed, script = driven(CMD_VEL, hold=60.0)
    feed.drive(0.1)
    script.broken = "the script is read only"
    with pytest.raises(FeedError, match="cannot stop: the script is read only; zero follows when it can be sent"):
        feed.stop()
    text = "sending zero to the robot failed: the script is read only"
    wait_for(lambda: [record.message for record in caplog.records] == [text], "it is logged")


def test_a_topic_without_a_subscriber_is_reported_once(driven: Driven, caplog: pytest.LogCaptureFixture) -> None:
    feed, _ = driven(SCAN)
    feed.drive(0.1)
    feed.drive(0.1)
    assert feed.drive_status == "/cmd_vel has no subscriber"
    assert [r.message for r in caplog.records] == ["the script: /cmd_vel has no subscriber"]


def test_a_stop_without_a_subscriber_is_reported_once(driven: Driven, caplog: pytest.LogCaptureFixture) -> None:
    feed, _ = driven(SCAN)
    feed.stop()
    feed.stop()
    assert [r.message for r in caplog.records] == ["the script: /cmd_vel has no subscriber"]


def test_a_missing_subscriber_is_not_reported_while_nothing_is_connected(
    driven: Driven, caplog: pytest.LogCaptureFixture
) -> None:
    feed, script = driven(connected=False)
    with pytest.raises(FeedError, match="cannot drive: connecting to the script"):
        feed.drive(0.1)
    assert feed.drive_status == "connecting to the script"
    script.connect()  # and no topic is listed yet
    feed.drive(0.1)
    assert (feed.drive_status, caplog.records) == ("", [])
    script.listener.on_topics([SCAN])
    assert feed.drive_status == "/cmd_vel has no subscriber"


def test_driving_and_stopping_without_a_robot_report_what_to_compare(
    driven: Driven, caplog: pytest.LogCaptureFixture
) -> None:
    feed, script = driven()
    script.listener.on_nobody("no robot in domain 79. Is 79 the robot's ROS_DOMAIN_ID?")
    for do in (lambda: feed.drive(0.1), feed.stop):
        with pytest.raises(FeedError, match=r"cannot (drive|stop): no robot in domain 79"):
            do()
    assert feed.drive_status == feed.status == "no robot in domain 79. Is 79 the robot's ROS_DOMAIN_ID?"
    assert caplog.records == []
    script.listener.on_nobody("")
    script.listener.on_topics([CMD_VEL])
    feed.drive(0.1)
    feed.stop()
    assert (feed.status, feed.drive_status, script.speeds[-2:]) == ("", "", [(0.1, 0.0), (0.0, 0.0)])


# -- which topic -------------------------------------------------------------------------------------------------------

ROBOT_1, ROBOT_2 = (CMD_VEL._replace(name=f"/robot{number}/cmd_vel") for number in (1, 2))
NAME_IT = r"; name the topic of your robot: feed.driving = feeds.Driving\(topic='/robot1/cmd_vel'\)"
TAKEN = (
    "the script: /cmd_vel has no subscriber; sending speeds to /robot1/cmd_vel, the only velocity topic that has one"
)


def test_the_only_topic_of_speeds_with_a_subscriber_is_driven_and_that_is_reported_once(
    driven: Driven, caplog: pytest.LogCaptureFixture
) -> None:
    feed, script = driven(SCAN, ROBOT_1, ODOM, hold=60.0)
    assert feed.driving.topic is None
    feed.drive(0.1)
    feed.drive(0.2)
    feed.stop()
    assert {topic for topic, _, _ in script.sent} == {"/robot1/cmd_vel"}
    assert feed.driving.topic == "/robot1/cmd_vel"
    assert (feed.drive_status, [r.message for r in caplog.records]) == ("", [TAKEN])


@pytest.mark.parametrize("how", ["stop", "latch", "pad", "program"])
def test_stop_pads_and_programs_take_the_only_topic_that_is_heard_as_drive_does(driven: Driven, how: str) -> None:
    feed, script = driven(SCAN, ROBOT_1, hold=60.0)
    wait_for(lambda: feed.connection.is_settled, "the topics are known")
    if how == "stop":
        feed.stop()
    elif how == "latch":
        feed.stopped = True
    elif how == "pad":
        pad = Pad(send=None)
        pad.connect(feed)
        pad.hold(forward=0.2)
        wait_for(lambda: pad.title == "/robot1/cmd_vel", "it has the name")
    else:
        feed.program(lambda: Drive(0.1))
    wait_for(lambda: script.sent, "it is sent")
    assert {topic for topic, _, _ in script.sent} == {"/robot1/cmd_vel"}


def test_of_several_topics_that_are_heard_none_is_driven_and_all_are_named(driven: Driven) -> None:
    feed, script = driven(SCAN, ROBOT_1, ROBOT_2)
    words = f"/cmd_vel has no subscriber, unlike /robot1/cmd_vel and /robot2/cmd_vel{NAME_IT}"
    with pytest.raises(FeedError, match=f"cannot drive: {words}"):
        feed.drive(0.1)
    with pytest.raises(FeedError, match=f"cannot stop: {words}"):
        feed.stop()
    assert set(script.speeds) == {(0.0, 0.0)}
    pad = Pad(send=None)
    pad.connect(feed)
    pad.from_page("hold", token=pad.press(), forward=0.2)
    wait_for(lambda: "unlike /robot1/cmd_vel and /robot2/cmd_vel" in pad.told["error"], "the pad says so")
    pad.from_page("release")
    program = feed.program(lambda: Drive(0.1))
    wait_for(lambda: "unlike /robot1/cmd_vel and /robot2/cmd_vel" in program.waiting, "the program says so")
    assert set(script.speeds) == {(0.0, 0.0)}
    feed.driving = Driving(topic="/robot2/cmd_vel")
    feed.drive(0.1)
    assert script.sent[-1][0] == "/robot2/cmd_vel"


def test_a_set_topic_stays_and_stopping_without_a_subscriber_names_the_subscribed_topics(driven: Driven) -> None:
    feed, script = driven(SCAN, ROBOT_1, topic="/cmd_vel")
    feed.drive(0.1)
    with pytest.raises(FeedError, match=f"cannot stop: /cmd_vel has no subscriber, unlike /robot1/cmd_vel{NAME_IT}"):
        feed.stop()
    assert {topic for topic, _, _ in script.sent} == {"/cmd_vel"}


def test_a_driven_topic_is_driven_on_even_if_others_get_subscribers(driven: Driven) -> None:
    for first, other in ((CMD_VEL, ROBOT_1), (ROBOT_1, CMD_VEL)):
        feed, script = driven(SCAN, first, hold=60.0)
        feed.drive(0.1)
        script.listener.on_topics([SCAN, other])
        feed.drive(0.2)
        wait_for(lambda script=script: script.speeds[-1] == (0.2, 0.0), "it is sent")  # type: ignore[misc]
        assert [topic for topic, _, _ in script.sent] == [first.name, first.name]
        feed.driving = Driving()
        feed.drive(0.1)
        wait_for(
            lambda script=script, other=other: script.sent[-1][0] == other.name,  # type: ignore[misc]
            "other settings choose again",
        )


def test_no_topic_is_chosen_before_the_usual_one_had_time_to_be_found(
    driven: Driven, monkeypatch: pytest.MonkeyPatch
) -> None:
    set_discovery_timeout(monkeypatch, 60.0)
    feed, script = driven(ROBOT_1)
    feed.stopped = True
    wait_for(lambda: script.sent, "zero is sent")
    feed.stopped = False
    script.listener.on_topics([ROBOT_1, CMD_VEL])
    feed.drive(0.1)
    assert {topic for topic, _, _ in script.sent} == {"/cmd_vel"}


def test_a_bridge_that_does_not_know_the_type_of_a_topic_with_subscribers_only_is_driven_too(driven: Driven) -> None:
    feed, script = driven(SCAN, ROBOT_1._replace(type=""), Advert("/gripper/command", "", False, True))
    feed.drive(0.1)
    assert script.sent[0][:2] == ("/robot1/cmd_vel", CMD_VEL.type)


@pytest.mark.parametrize(
    ("speed", "words"),
    [
        ((0, 90), "90 rad/s is cut to 1; in degrees? math.radians() makes them of degrees"),
        ((0, -6.3), "-6.3 rad/s is cut to -1; in degrees? math.radians() makes them of degrees"),
        ((0, 6.2), "6.2 rad/s is cut to 1"),
        ((100, 0), "100 m/s is cut to 0.5"),
        ((-1, 2.5), "-1 m/s is cut to -0.5; 2.5 rad/s is cut to 1"),
        ((100, 0.3), "100 m/s is cut to 0.5"),
        ((0.5, -1), ""),
        ((0.1 + 0.4 + 1e-12, 0), ""),
    ],
)
def test_a_speed_that_is_cut_is_reported_until_one_is_not(
    driven: Driven, speed: tuple[float, float], words: str
) -> None:
    feed, _ = driven(CMD_VEL, hold=60.0)
    feed.drive(*speed)
    assert feed.drive_status == words
    feed.drive(0.1)
    assert feed.drive_status == ""
    feed.drive(*speed)
    feed.stop()
    assert feed.drive_status == ""
    feed.drive(*speed)
    feed.driving = Driving(max_linear=1000.0, max_angular=1000.0)
    assert feed.drive_status == ""
    feed.drive(*speed)
    assert feed.drive_status == ""


def test_that_speeds_are_cut_is_logged_once_whatever_the_numbers(
    driven: Driven, caplog: pytest.LogCaptureFixture
) -> None:
    feed, _ = driven(CMD_VEL, hold=60.0)
    for i in range(40):
        feed.drive(1 + i / 100, 90)
    words = "1 m/s is cut to 0.5; 90 rad/s is cut to 1; in degrees? math.radians() makes them of degrees"
    assert [record.message for record in caplog.records] == [f"the script: {words}"]


@pytest.mark.parametrize(
    ("given", "error", "words"),
    [
        ({"max_linear": 0}, ValueError, "max_linear: expected a limit above 0, got 0"),
        ({"max_lateral": -0.1}, ValueError, "max_lateral: expected a limit of 0 or more, got -0.1"),
        ({"hold": -1.0}, ValueError, "hold: expected a limit above 0, got -1.0"),
        ({"max_angular": inf}, ValueError, "max_angular: expected"),
        ({"max_angular": "fast"}, TypeError, "max_angular"),
        ({"topic": " "}, ValueError, "topic: expected the name of a topic, such as /cmd_vel, got ' '"),
        ({"topic": 3}, TypeError, "topic: expected the name of a topic as text, or None, got 3"),
    ],
)
def test_limits_must_make_sense(given: dict[str, object], error: type[Exception], words: str) -> None:
    with pytest.raises(error, match=words):
        Driving(**given)  # type: ignore[arg-type]


def test_a_hold_of_minutes_is_told_as_it_may_be_meant_in_milliseconds(caplog: pytest.LogCaptureFixture) -> None:
    assert Driving(hold=60.0).hold == 60.0
    assert not caplog.records
    assert Driving(hold=500).hold == 500
    [record] = caplog.records
    assert record.message == (
        "hold: each speed is valid for 500 s, so a robot drives on for 500 s after the program that sent it; "
        "it is in seconds: 0.5 is half a second"
    )


def _driving_threads() -> list[threading.Thread]:
    return [thread for thread in threading.enumerate() if thread.name == "robowidgets-drive"]


def test_if_subscribers_are_unknown_nothing_is_reported(driven: Driven, caplog: pytest.LogCaptureFixture) -> None:
    feed, script = driven(SCAN._replace(wanted=None))
    feed.drive(0.1)
    assert (feed.drive_status, caplog.records) == ("", [])
    assert script.speeds == [(0.1, 0.0)]


def test_a_hand_on_a_pad_outranks_a_program_which_gets_an_error(driven: Driven) -> None:
    feed, script = driven(CMD_VEL)
    feed.drive(0.3)
    feed.watchdog.take("press")
    with pytest.raises(FeedError, match="cannot drive: a hand drives from a pad"):
        feed.drive(0.2)
    feed.driver.drive_by_hand(Velocity(5.0), "press")
    wait_for(
        lambda: script.speeds == [(0.3, 0.0), (0.0, 0.0), (0.5, 0.0)], "the hand's speed is sent, cut to the limits"
    )
    assert feed.drive_status == "5 m/s is cut to 0.5"
    feed.watchdog.let_go("press")
    wait_for(lambda: feed.drive_status == "", "what was reported of the hand's speed ends with it")
    with pytest.raises(FeedError, match="cannot drive: the press on the pad is over"):
        feed.driver.drive_by_hand(Velocity(0.1), "press")
    feed.drive(0.2)


def test_stop_latches_until_it_is_released(driven: Driven) -> None:
    feed, script = driven(CMD_VEL)
    feed.drive(0.3)
    feed.stopped = True
    wait_for(lambda: script.speeds == [(0.3, 0.0), (0.0, 0.0)], "zero is sent")
    assert feed.stopped
    with pytest.raises(FeedError, match="cannot drive: Stop is pressed: press Allow driving"):
        feed.drive(0.2)
    feed.stop()
    feed.stopped = False
    feed.drive(0.2)
    wait_for(lambda: script.speeds[-1] == (0.2, 0.0), "it drives again")


def test_a_robot_that_needs_a_page_is_not_driven_without_one(driven: Driven, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robowidgets.feeds._driver.PAGE_SILENCE", 0.2)
    feed, script = driven(CMD_VEL)
    feed.driving = Driving(needs_page=True)
    with pytest.raises(FeedError, match="cannot drive: no page that shows this feed or its pad answers"):
        feed.drive(0.2)
    feed.driver.page_seen()
    feed.drive(0.2)
    wait_for(lambda: refused(feed), "the page is gone")
    wait_for(lambda: script.speeds[-1] == (0.0, 0.0), "the robot stops")
    feed.drive(0, 0)  # zero needs no subscriber
    with pytest.raises(TypeError, match="needs_page: expected True or False, got 1"):
        Driving(needs_page=1)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("others", "words"),
    [
        (("/teleop",), "/teleop publishes /cmd_vel, too"),
        (("/nav", "/teleop"), "/nav, /teleop publishes /cmd_vel, too"),
        ((), "another node publishes /cmd_vel, too"),
    ],
)
def test_another_publisher_of_speeds_is_named(driven: Driven, others: tuple[str, ...], words: str) -> None:
    feed, _ = driven(CMD_VEL._replace(offered=True, publishers=others))
    assert feed.drive_status == words


def test_an_unreached_subscriber_is_reported_and_logged_once_and_again_when_it_is_reached(
    driven: Driven, caplog: pytest.LogCaptureFixture
) -> None:
    feed, script = driven(CMD_VEL)
    feed.drive(0.1)
    script.listener.on_unheard("/cmd_vel", "a subscriber of /cmd_vel is not compatible")
    assert feed.drive_status == "a subscriber of /cmd_vel is not compatible"
    for _ in range(2):
        feed.drive(0.1)
    assert [record.message for record in caplog.records] == [f"{feed.where}: {feed.drive_status}"]
    script.listener.on_unheard("/cmd_vel", "")
    assert feed.drive_status == ""


def test_the_driven_topic_is_shown_as_commanded_if_it_is_unknown_too(driven: Driven) -> None:
    for there in ((ODOM, CMD_VEL), (ODOM,)):
        feed, _ = driven(*there, hold=60.0)
        speed = feed.show().widgets["/odom"]
        feed.drive(0.3, 0.5)
        wait_for(lambda speed=speed: speed.commanded, "it is shown")  # type: ignore[misc]
        assert speed.commanded.values[::5] == (0.3, 0.5)
        assert speed.command_title == "/cmd_vel"
        feed.stop()
        wait_for(lambda speed=speed: speed.commanded.values[::5] == (0.0, 0.0), "and zero")  # type: ignore[misc]


def test_speeds_that_others_publish_are_not_covered_by_our_own(driven: Driven) -> None:
    feed, script = driven(ODOM, CMD_VEL._replace(offered=True))
    speed = feed.show().widgets["/odom"]
    script.listener.on_message("/cmd_vel", twist(0.1))
    feed.drive(0.3)
    wait_for(lambda: script.speeds == [(0.3, 0.0)], "it is sent")
    assert speed.commanded.linear[0] == 0.1
