"""A middleware without a robot: a test scripts its events, and sees its requests."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest

from robowidgets.feeds import Advert, FeedError, Listener

SCAN = Advert("/scan", "sensor_msgs/msg/LaserScan", wanted=False)
ODOM = Advert("/odom", "nav_msgs/msg/Odometry", wanted=False)
CMD_VEL = Advert("/cmd_vel", "geometry_msgs/msg/Twist", offered=False, wanted=True)
IMU = Advert("/imu", "sensor_msgs/msg/Imu", wanted=False)


def set_discovery_timeout(patch: pytest.MonkeyPatch, seconds: float) -> None:
    """Set the seconds for which a new feed waits for topics and for subscribers."""
    patch.setattr("robowidgets.feeds._subscriptions.DISCOVERY_TIMEOUT_S", seconds)


def set_connect_timeout(patch: pytest.MonkeyPatch, seconds: float) -> None:
    """Set the seconds for which the first speed, and the last zero, wait for a subscriber to connect."""
    patch.setattr("robowidgets.feeds._driver.CONNECT_TIMEOUT", seconds)


class Scripted:
    """A test talks to its `listener`, as an adapter would.

    While it is ``deaf``, what is published is lost; while it is not ``reachable``, publishing fails.
    """

    where = "the script"

    def __init__(self, *topics: Advert, connected: bool = True) -> None:
        self.asked: list[tuple[str, str]] = []
        self.followed: frozenset[str] = frozenset()
        self.sent: list[tuple[str, str, Mapping[str, Any]]] = []
        self.closed = 0
        self.asks_for_nodes = False
        self.broken = ""
        self.deaf = False
        self.unheard = 0
        self.listener: Listener
        self._topics = topics
        self.reachable = connected

    def open(self, listener: Listener) -> None:
        self.listener = listener
        if self.reachable:
            listener.on_connected()
            listener.on_topics(self._topics)

    def follow(self, topics: frozenset[str], each: frozenset[str] = frozenset()) -> None:
        self.each = each
        self.asked += [("subscribe", topic) for topic in topics - self.followed]
        self.asked += [("unsubscribe", topic) for topic in self.followed - topics]
        self.followed = topics

    def ask_for_nodes(self, wanted: bool) -> None:
        self.asks_for_nodes = wanted

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        if self.broken or not self.reachable:
            raise FeedError(self.broken or "there is no connection to the script")
        if self.deaf:
            self.unheard += 1
            return
        self.sent.append((topic, message_type, message))

    def close(self) -> None:
        self.closed += 1

    def connect(self) -> None:
        """Connect, for the first time or again."""
        self.reachable = True
        self.listener.on_connected()

    def lose(self, why: str = "no route to host") -> None:
        """Lose the connection."""
        self.reachable = False
        self.listener.on_lost(why, 1.0)

    @property
    def speeds(self) -> list[tuple[float, float]]:
        """Linear x and angular z of the published speeds."""
        twists = [message.get("twist", message) for _, _, message in self.sent]
        return [(twist["linear"]["x"], twist["angular"]["z"]) for twist in twists]


def scan(*ranges: float, angle_min: float = 0.0, angle_increment: float = 0.1) -> dict[str, Any]:
    """A LaserScan as a dictionary."""
    return {
        "ranges": list(ranges or (1.0, 2.0)),
        "angle_min": angle_min,
        "angle_increment": angle_increment,
        "range_min": 0.1,
        "range_max": 10.0,
    }


def twist(linear: float) -> dict[str, Any]:
    """A Twist as a dictionary."""
    return {"linear": {"x": linear, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}
