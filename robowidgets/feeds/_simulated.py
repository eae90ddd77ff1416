"""The simulated robot in real time, in a thread of this process."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any

from ..messages import to_speed
from ..messages.standard import TWIST
from ..simulator import Robot
from ..simulator import wander as wander_about
from ._threaded import ThreadedMiddleware
from .middleware import Advert, FeedError, Listener

TOPICS = (
    Advert("/scan", "sensor_msgs/msg/LaserScan", wanted=False),
    Advert("/odom", "nav_msgs/msg/Odometry", wanted=False),
    Advert("/cmd_vel", TWIST, offered=False, wanted=True),
)

LET_GO = 3.0
"""Seconds without a speed on ``/cmd_vel`` after which the robot wanders again."""

_LATEST = 1.0


def topics_of(robot: Robot) -> tuple[Advert, ...]:
    """The topics of a robot: /bumper where it has bumpers."""
    kind = robot.model.touch_type
    return (*TOPICS, Advert("/bumper", kind, wanted=False)) if kind else TOPICS


def check_driven(topic: str) -> None:
    """FeedError for a topic to which the robot does not listen."""
    if topic != "/cmd_vel":
        raise FeedError(f"the simulated robot listens to /cmd_vel, not to {topic}")


class Simulated(ThreadedMiddleware):
    """A simulated robot as a `Middleware`: it runs in real time, in a thread of its own.

    While speeds come on ``/cmd_vel``, it obeys them. Else it wanders about and backs off from obstacles, or stands
    still.

    Args:
        robot: the robot; nothing else may use it meanwhile.
        hz: rate of its speeds and bumpers, per second. Scans come at the rate of its scanner, or at this one if that is
            lower.
        wander: whether it wanders while nobody drives it.
    """

    def __init__(self, robot: Robot, hz: float, wander: bool = True) -> None:
        super().__init__()
        self._robot = robot
        self._step = 1 / hz
        self._wanders = wander
        self._driven: tuple[float, float, float] | None = None if wander else (0.0, 0.0, 0.0)
        self._driven_at = 0.0

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return "the simulated robot"

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        listener.on_connected()
        listener.on_topics(topics_of(self._robot))
        self._start_thread("robowidgets-simulator", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:  # noqa: ARG002
        """See `Middleware`. It takes every message with a speed."""
        check_driven(topic)
        speed = to_speed(message)
        if self._closed.is_set():
            raise FeedError("the simulated robot is closed")
        self._driven_at = time.monotonic()
        self._driven = (speed.linear[0], speed.angular[2], speed.linear[1])

    def _run_session(self, listener: Listener) -> str:
        ways = wander_about(self._robot)
        scan = None
        due = time.monotonic()
        while not self._closed.wait(max(0.0, due - time.monotonic())):
            # Catches up with time that a busy cell took from this thread, up to `_LATEST` seconds.
            due = max(due + self._step, time.monotonic() - _LATEST)
            ways = self._steer(ways)
            self._robot.step(self._step)
            samples: dict[str, Any] = {"/odom": self._robot.speed(), "/cmd_vel": self._robot.command()}
            if "/bumper" in self._wanted:
                samples["/bumper"] = self._robot.model.to_message(self._robot.touch())
            if "/scan" in self._wanted and self._robot.scan() is not scan:
                scan = samples["/scan"] = self._robot.scan()
            for topic in self._wanted & samples.keys():
                listener.on_message(topic, samples[topic])
        return ""

    def _wake(self) -> None:
        """Nothing to do: each step looks at the wanted topics."""

    def _steer(self, ways: Iterator[None]) -> Iterator[None]:
        driven = self._driven
        if driven is None:
            next(ways)
            return ways
        if not self._wanders or time.monotonic() - self._driven_at < LET_GO:
            self._robot.drive(*driven)
            return ways
        self._driven = None
        return wander_about(self._robot)
