"""The contract of all middlewares, said once. A middleware passes it with an adapter, a `Source` or a `Robot`.

`test_contract.py` has the adapters, `tests/ros1/test_contract.py` the one for ROS 1. A new middleware writes its own::

    class TestZenoh(RobotContract):
        robot = fixture_of(ZenohRobot)
"""

from __future__ import annotations

import gc
import os
import threading
import weakref
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from typing import Any

import pytest

from robowidgets.feeds import Driving, Feed, FeedError
from robowidgets.feeds.middleware import Middleware

from ..waiting import wait_for
from .ears import Ears

SCAN, TWIST, STAMPED = "sensor_msgs/msg/LaserScan", "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
TIMES = 20


class Source:
    """A source of scans, for the part of the contract that holds for a recording, too."""

    scan, other = "/scan", "/other"
    """Its topics; the second one may be of any type."""
    spare = 0
    """Threads and open files that its libraries may keep."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.monkeypatch = monkeypatch

    def middleware(self) -> Middleware:
        """Make a middleware that connects to it."""
        raise NotImplementedError

    def send(self, topic: str, rays: int = 2) -> None:
        """Publish a scan, unless messages come anyway. It may be lost while no subscription is known."""

    def close(self) -> None:
        """End it."""


class Robot(Source):
    """A robot whose topics a test controls."""

    speed = "/cmd_vel"
    type = TWIST
    """The type of its speeds."""

    def send(self, topic: str, rays: int = 2) -> None:
        """Publish a scan, on a new topic if necessary."""
        raise NotImplementedError

    def send_other_type(self, topic: str) -> None:
        """Publish a message without ranges, on a new topic if necessary."""
        raise NotImplementedError

    def withdraw(self, topic: str) -> None:
        """End the publisher of a topic."""
        raise NotImplementedError

    def listen(self) -> None:
        """Subscribe to speeds."""
        raise NotImplementedError

    @property
    def speeds(self) -> list[float]:
        """The forward speeds that came."""
        raise NotImplementedError

    def die(self) -> None:
        """End without a farewell. The next `send` starts it again."""
        raise NotImplementedError


def fixture_of(make: Callable[[pytest.MonkeyPatch], Source]) -> Any:
    """Return the fixture of an adapter."""

    @pytest.fixture
    def robot(self: object, monkeypatch: pytest.MonkeyPatch) -> Iterator[Source]:
        made = make(monkeypatch)
        yield made
        made.close()

    return robot


class Listening:
    """An open middleware with what it reports."""

    def __init__(self, robot: Source, *topics: str) -> None:
        self.robot, self.ears = robot, Ears()
        self.middleware = robot.middleware()
        self.middleware.open(self.ears)
        self.middleware.follow(frozenset(topics))

    def __enter__(self) -> Listening:
        return self

    def __exit__(self, *_: object) -> None:
        self.middleware.close()

    def hear(self, topic: str, rays: int = 2, send: Callable[[], object] | None = None) -> Any:
        """Send until another message of a topic comes; return it."""
        count = len(self.ears.of(topic))
        send = send or (lambda: self.robot.send(topic, rays))
        wait_for(lambda: send() or len(self.ears.of(topic)) > count, f"a message of {topic} comes")
        return self.ears.of(topic)[-1]

    def type_of(self, topic: str) -> str | None:
        """The listed type of a topic that is offered, or None."""
        return next((advert.type for advert in self.ears.topics or () if advert.name == topic and advert.offered), None)


class SourceContract:
    """The contract of every middleware."""

    def test_a_message_comes_with_its_topic_and_type(self, robot: Source) -> None:
        with Listening(robot, robot.scan) as listening:
            assert len(listening.hear(robot.scan).ranges) > 0
            wait_for(lambda: listening.type_of(robot.scan) == SCAN, "it is listed")
            assert {topic for topic, _ in listening.ears.messages} == {robot.scan}
            assert (listening.ears.connected, listening.ears.lost) == (1, [])
            assert listening.ears.said == []

    def test_nothing_comes_after_unsubscribing(self, robot: Source) -> None:
        with Listening(robot, robot.scan, robot.other) as listening:
            listening.hear(robot.scan)
            listening.middleware.follow(frozenset({robot.other}))
            # What was on its way comes before a later message of another topic.
            for _ in range(2):
                listening.hear(robot.other)
            count = len(listening.ears.of(robot.scan))
            for _ in range(2):
                robot.send(robot.scan)
                listening.hear(robot.other)
            assert len(listening.ears.of(robot.scan)) == count

    def test_it_may_be_closed_twice_before_it_is_open_and_in_a_callback(self, robot: Source) -> None:
        before = threading.active_count()
        robot.middleware().close()
        listening = Listening(robot)
        listening.ears.then = lambda *_: listening.middleware.close()
        listening.middleware.follow(frozenset({robot.scan}))
        wait_for(lambda: robot.send(robot.scan) or listening.ears.messages, "a message comes")
        listening.middleware.close()
        listening.middleware.close()
        assert len(listening.ears.messages) == 1
        wait_for(lambda: threading.active_count() <= before + robot.spare, "its threads have ended")

    def test_opening_and_closing_many_times_leaves_nothing(self, robot: Source) -> None:
        made: list[weakref.ref[Any]] = []

        def once(waits: bool) -> None:
            with Listening(robot, robot.scan) as listening:
                if waits:
                    wait_for(lambda: listening.ears.connected, "it is connected")
                made.append(weakref.ref(listening.middleware))

        def in_use() -> tuple[int, int]:
            gc.collect()
            return threading.active_count(), len(os.listdir("/proc/self/fd")) if os.path.isdir("/proc/self/fd") else 0

        robot.send(robot.scan)
        once(True)
        before = in_use()
        for i in range(TIMES):
            once(i % 2 == 0)
        wait_for(
            lambda: all(now <= then + robot.spare for now, then in zip(in_use(), before, strict=True)),
            "all threads have ended, and all files are closed",
        )
        wait_for(lambda: gc.collect() is None or not any(one() for one in made), "nothing refers to them")


class RobotContract(SourceContract):
    """The contract of the middleware of a robot."""

    def test_a_topic_may_come_later_and_go(self, robot: Robot) -> None:
        with Listening(robot, robot.scan, robot.other) as listening:
            listening.hear(robot.other)
            assert listening.type_of(robot.scan) is None
            wait_for(lambda: len(listening.hear(robot.scan, rays=3).ranges) == 3, "it is heard")
            wait_for(lambda: listening.type_of(robot.scan) == SCAN, "it is listed")
            robot.withdraw(robot.scan)
            wait_for(lambda: listening.type_of(robot.scan) is None, "it is gone")
            assert listening.type_of(robot.other) == SCAN

    def test_a_topic_that_changes_its_type_is_read_as_the_new_one(self, robot: Robot) -> None:
        with Listening(robot, robot.scan) as listening:
            listening.hear(robot.scan)
            robot.withdraw(robot.scan)
            wait_for(lambda: listening.type_of(robot.scan) is None, "it is gone")
            other = partial(listening.hear, robot.scan, send=lambda: robot.send_other_type(robot.scan))
            wait_for(lambda: not hasattr(other(), "ranges"), "the other type is read, after scans on their way")
            wait_for(lambda: listening.type_of(robot.scan) not in (None, SCAN), "the new type is listed")

    def test_a_robot_that_died_is_heard_when_it_is_back(self, robot: Robot) -> None:
        with Listening(robot, robot.scan) as listening:
            listening.hear(robot.scan)
            robot.die()
            wait_for(
                lambda: (
                    listening.ears.lost or listening.type_of(robot.scan) is None or listening.ears.words(robot.scan)
                ),
                "it is reported",
            )
            wait_for(lambda: len(listening.hear(robot.scan, rays=5).ranges) == 5, "it is heard again")

    def test_a_robot_hears_the_speed_and_zero_once_its_feed_is_closed(self, robot: Robot) -> None:
        robot.listen()
        with Feed(robot.middleware()) as feed:
            feed.driving = Driving(robot.speed, hold=60.0)

            def drive() -> list[float]:
                with suppress(FeedError):  # until it is connected
                    feed.drive(0.25)
                return robot.speeds

            wait_for(lambda: 0.25 in drive(), "the speed comes")
            assert {*robot.speeds} <= {0.0, 0.25}, "zero comes first if this process stands still"
        wait_for(lambda: robot.speeds[-1] == 0.0, "zero comes")

    def test_without_a_connection_publishing_is_an_error_and_nothing_is_kept(self, robot: Robot) -> None:
        robot.listen()
        message = {"linear": {"x": 0.25}} if robot.type == TWIST else {"twist": {"linear": {"x": 0.25}}}
        with pytest.raises(FeedError):
            robot.middleware().publish(robot.speed, robot.type, message)
        with Listening(robot) as listening:
            wait_for(lambda: listening.ears.topics is not None, "it is connected")
        with pytest.raises(FeedError):
            listening.middleware.publish(robot.speed, robot.type, message)
        assert robot.speeds == []
