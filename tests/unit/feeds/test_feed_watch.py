"""Conditions on all topics of a robot."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from typing import Any

import pytest

from robowidgets import conditions, feeds
from robowidgets.feeds import Feed, FeedError

from ..waiting import wait_for
from .scripted import IMU, ODOM, SCAN, Scripted

field = conditions.field


@pytest.fixture
def script() -> Scripted:
    return Scripted(IMU, ODOM, SCAN)


@pytest.fixture
def feed(script: Scripted) -> Iterator[Feed]:
    with Feed(script) as opened:
        yield opened


def imu(x: float) -> dict[str, Any]:
    return {"linear_acceleration": {"x": x}}


def odometry(x: float, y: float = 0.0) -> dict[str, Any]:
    pose = {"position": {"x": x, "y": y, "z": 0.0}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
    twist = {"linear": {"x": 0.1, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}
    return {"header": {}, "child_frame_id": "", "pose": {"pose": pose}, "twist": {"twist": twist}}


def scan(distance: float) -> dict[str, Any]:
    return {"angle_min": 0.0, "angle_increment": 0.1, "range_min": 0.1, "range_max": 9.0, "ranges": [distance]}


def test_it_is_judged_on_each_message_of_its_topics(feed: Feed, script: Scripted) -> None:
    watch = feed.watch(field("/imu.linear_acceleration.x") > 12)
    assert watch.value is None
    assert "waiting for /imu" in repr(watch)
    script.listener.on_message("/imu", imu(13.0))
    moment = watch.wait(120)
    assert moment.messages["/imu"] == imu(13.0)
    script.listener.on_message("/imu", imu(11.0))
    watch.wait(240, value=False)
    assert [change.value for change in watch.changes] == [False]  # the first verdict is not a change
    assert watch.verdict.text == "11.00 ≤ 12.00 m/s²"


def test_conditions_on_several_topics_are_joined(feed: Feed, script: Scripted) -> None:
    both = feed.watch((field("/imu.linear_acceleration.x") > 12) & conditions.nearest_below(0.5), "hit")
    either = feed.watch((field("/imu.linear_acceleration.x") > 12) | conditions.nearest_below(0.5), "one")
    script.listener.on_message("/imu", imu(13.0))
    either.wait(120)
    assert both.value is None
    script.listener.on_message("/scan", scan(0.4))
    both.wait(120)
    assert list(feed.watched) == ["hit", "one"]


def test_a_function_takes_what_a_program_takes(feed: Feed, script: Scripted) -> None:
    far = feed.watch(lambda driven, pose: driven > 1.0 and pose.y > 0.5, "far")
    hard = feed.watch(lambda imu: imu["linear_acceleration"]["x"] > 12, "hard", imu="/imu")
    any_of = feed.watch(lambda moment: moment["/imu"]["linear_acceleration"]["x"] > moment.pose.x, "any")
    for x, y in ((5.0, 0.0), (5.6, 0.3)):
        script.listener.on_message("/odom", odometry(x, y))
        wait_for(lambda x=x: far.sample is not None and far.sample.pose.x == x, "it was judged")

    def it_is_far() -> bool:  # the state of before may be old by now
        script.listener.on_message("/odom", odometry(6.2, 0.9))
        return far.value is True

    wait_for(it_is_far, "it is true")
    assert 1.0 < far.sample.driven < 2.0  # since the watch began, not since 0
    script.listener.on_message("/imu", imu(13.0))
    assert hard.wait(120).imu == imu(13.0)

    def both_come() -> bool:  # a moment attaches a topic when it is first read
        script.listener.on_message("/imu", imu(13.0))
        script.listener.on_message("/odom", odometry(6.2, 0.9))
        return any_of.value is True

    wait_for(both_come, "it is true")


def test_what_raises_is_switched_off_and_what_hangs_holds_nothing_up(feed: Feed, script: Scripted) -> None:
    bad = feed.watch(field("/imu.nothing") > 1, "bad")
    good = feed.watch(field("/imu.linear_acceleration.x") > 1, "good")
    script.listener.on_message("/imu", imu(2.0))
    wait_for(lambda: "no field 'nothing'" in bad.error, "it says why")
    good.wait(120)


def test_what_cannot_be_watched_is_refused(feed: Feed) -> None:
    with pytest.raises(TypeError, match="a lambda has no name"):
        feed.watch(lambda scan: bool(scan))
    with pytest.raises(TypeError, match="takes a, b"):
        feed.watch(lambda a, b: a is b, "x")
    with pytest.raises(TypeError, match=r"names a topic, but .*<lambda> has no such parameter"):
        feed.watch(lambda scan: bool(scan), "x", imu="/imu")
    with pytest.raises(TypeError, match="a gap lies between samples"):
        feed.watch(conditions.gap(1.0), "x")
    with pytest.raises(TypeError, match="expected a function"):
        feed.watch(3, "x")  # type: ignore[arg-type]
    with pytest.raises(KeyError, match="no watch 'x': there are none"):
        feed.unwatch("x")


def test_one_of_the_same_name_an_end_and_a_closed_feed_end_it(feed: Feed, script: Scripted) -> None:
    first = feed.watch(field("/imu.linear_acceleration.x") > 1, "x")
    second = feed.watch(field("/imu.linear_acceleration.x") > 2, "x")
    with pytest.raises(RuntimeError, match="another condition has its name now"):
        first.wait(1)
    third = feed.watch(field("/imu.linear_acceleration.x") > 3, "y")
    feed.unwatch("y")
    with pytest.raises(RuntimeError, match="it is no longer watched"):
        third.wait(1)
    feed.close()
    with pytest.raises(RuntimeError, match="its feed is closed"):
        second.wait(1)
    assert second.value is None
    with pytest.raises(FeedError, match="is closed"):
        feed.watch(field("/imu.linear_acceleration.x") > 1, "x")


def test_what_the_simulator_sends_is_watched_too() -> None:
    with feeds.simulator() as robot:
        watch = robot.watch((field("/odom.linear[0]") > 0.05) & conditions.nearest_below(9.0))
        assert watch.wait(120).messages["/odom"].linear[0] > 0.05


class Reads:
    """A condition that reads one topic first, and another one when a test allows it."""

    def __init__(self) -> None:
        self.began, self.goes_on, self.is_over = threading.Event(), threading.Event(), threading.Event()

    def __call__(self, moment: Any) -> bool:
        moment["/imu"]
        self.began.set()
        assert self.goes_on.wait(120)
        try:
            return bool(moment["/odom"])
        finally:
            self.is_over.set()


def test_what_a_condition_reads_after_the_end_of_its_watch_is_subscribed_no_more(feed: Feed, script: Scripted) -> None:
    reads = Reads()
    feed.watch(reads, "reads")
    while not reads.began.is_set():  # a moment attaches a topic when it is first read
        script.listener.on_message("/imu", imu(1.0))
    feed.unwatch("reads")
    reads.goes_on.set()
    assert reads.is_over.wait(120)
    wait_for(lambda: script.asked.count(("subscribe", "/odom")) == script.asked.count(("unsubscribe", "/odom")), "gone")
    assert feed.connection.connected == {}


def test_a_watch_can_end_while_its_condition_reads_another_topic(
    feed: Feed, script: Scripted, monkeypatch: pytest.MonkeyPatch
) -> None:
    reads = Reads()
    feed.watch(reads, "reads")
    while not reads.began.is_set():
        script.listener.on_message("/imu", imu(1.0))
    follow = script.follow

    def follow_and_read(topics: frozenset[str], each: frozenset[str] = frozenset()) -> None:
        follow(topics, each)
        if "/imu" not in topics and not reads.goes_on.is_set():  # in the middle of the end
            reads.goes_on.set()
            assert reads.is_over.wait(120)

    monkeypatch.setattr(script, "follow", follow_and_read)
    feed.unwatch("reads")
    wait_for(lambda: not feed.connection.connected, "nothing is subscribed")


def test_a_watch_that_cannot_begin_leaves_no_subscription(feed: Feed, monkeypatch: pytest.MonkeyPatch) -> None:
    attach = feed.connection.attach

    def attach_one(topic: str, *rest: Any) -> Any:
        if topic == "/odom":
            raise FeedError("no more of them")
        return attach(topic, *rest)

    monkeypatch.setattr(feed.connection, "attach", attach_one)
    with pytest.raises(FeedError, match="no more"):
        feed.watch((field("/imu.linear_acceleration.x") > 1) & (field("/odom.linear[0]") > 1))
    assert feed.connection.connected == {}


def test_while_a_thread_waits_for_it_the_robot_may_be_asked_under_any_lock(feed: Feed) -> None:
    watch = feed.watch(field("/imu.linear_acceleration.x") > 12)
    waits: list[bool] = []

    def why() -> str:
        other = threading.Thread(target=lambda: watch.changes)  # which takes the lock of the watch
        other.start()
        other.join(30)
        waits.append(other.is_alive())
        return "nothing came"

    watch._why_none = why
    watch._verdict = watch._verdict._replace(value=True)
    with pytest.raises(TimeoutError):
        watch.wait(0)
    assert waits[0] is False
