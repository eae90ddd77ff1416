"""Driving: limits, and the message that the robot listens to."""

from __future__ import annotations

import time
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, fields
from typing import Any

from .._core.command_watchdog import HOLD, RECENT
from .._core.limits import is_past
from ..samples.numbers import OF_DEGREES, finite, is_angle
from .middleware import Advert, FeedError, Middleware

TWIST = "geometry_msgs/msg/Twist"
TWIST_STAMPED = "geometry_msgs/msg/TwistStamped"


@dataclass(frozen=True)
class Driving:
    """How a feed drives the robot.

    Args:
        topic: where speeds are published.
        max_linear: m/s, forward and backward; more is cut.
        max_angular: rad/s, both ways; more is cut.
        hold: seconds after which a speed that was not renewed is followed by zero.
        needs_page: whether speeds are refused while no page shows the feed or a pad of it, so that a robot does not
            drive on when the browser was closed. A page that is busy or hidden for minutes counts as closed, and so
            does one that a busy kernel does not hear.

    Raises:
        TypeError: something is not a number, the topic no text, or needs_page neither True nor False.
        ValueError: a limit that is not finite and above 0, or an empty topic.
    """

    topic: str = "/cmd_vel"
    max_linear: float = 0.5
    max_angular: float = 1.0
    hold: float = HOLD
    needs_page: bool = False

    def __post_init__(self) -> None:
        if not isinstance(self.topic, str):
            raise TypeError(f"topic: expected the name of a topic as text, got {self.topic!r}")
        if not self.topic.strip():
            raise ValueError(f"topic: expected the name of a topic, such as /cmd_vel, got {self.topic!r}")
        if not isinstance(self.needs_page, bool):
            raise TypeError(f"needs_page: expected True or False, got {self.needs_page!r}")
        for field in fields(self)[1:4]:
            value = finite(field.name, getattr(self, field.name), "SI units")
            if value <= 0:
                raise ValueError(f"{field.name}: expected a limit above 0, got {value!r}")

    def within(self, linear: float, angular: float) -> tuple[float, float]:
        """A speed in m/s and rad/s, cut to the limits. ValueError for NaN and infinity."""
        return (
            _cut(finite("linear", linear, "m/s"), self.max_linear),
            _cut(finite("angular", angular, "rad/s"), self.max_angular),
        )

    def cut(self, linear: float, angular: float) -> str:
        """Words for what `within` cuts of a speed; empty when it is nothing."""
        given = ((linear, self.max_linear, "m/s"), (angular, self.max_angular, "rad/s"))
        words = [
            f"{value:g} {unit} is cut to {_cut(value, limit):g}"
            for value, limit, unit in given
            if is_past(value, (-limit, limit))
        ]
        if words and abs(angular) > self.max_angular and not is_angle(angular):
            words.append(f"in degrees? {OF_DEGREES}")
        return "; ".join(words)


class TwistPublisher:
    """Publishes speeds as Twist or TwistStamped, whichever is listened to; Twist where nobody is known to listen.

    Args:
        middleware: what publishes.
    """

    def __init__(self, middleware: Middleware) -> None:
        self._middleware = middleware
        self._moved: dict[str, list[str]] = {}
        """By topic, the types in which a speed was published."""
        self._moved_at: dict[str, float] = {}
        self._owed: set[str] = set()
        """The topics that were not sent zero since."""

    def on_connected(self) -> None:
        """Owe zero once more after the connection was lost: what was published lately may not have arrived."""
        since = time.monotonic() - RECENT
        self._owed |= {topic for topic, at in list(self._moved_at.items()) if at > since}

    def send(self, topic: str, linear: float, angular: float, adverts: Sequence[Advert]) -> None:
        """Publish a speed in m/s and rad/s.

        Zero goes out in every type in which a speed was published, and on every topic that is owed one.

        Raises:
            FeedError: the topic is of another type, and no speed was sent on it; or the middleware cannot publish.
        """
        if linear or angular:
            kind = _type_to_send(topic, adverts)
            self._middleware.publish(topic, kind, twist(kind, linear, angular))
            self._owed.add(topic)
            self._moved_at[topic] = time.monotonic()
            if kind not in self._moved.setdefault(topic, []):
                self._moved[topic].append(kind)
            return
        with ExitStack() as each:  # each is sent, whatever another raises
            for name in {topic, *self._owed}:
                each.callback(self._send_zero, name, adverts)

    def _send_zero(self, topic: str, adverts: Sequence[Advert]) -> None:
        kinds = list(self._moved.get(topic, ()))
        try:
            kinds.append(_type_to_send(topic, adverts))
        except FeedError:
            if topic not in self._moved:
                raise
        with ExitStack() as each:
            for kind in dict.fromkeys(kinds):
                each.callback(self._middleware.publish, topic, kind, twist(kind, 0.0, 0.0))
        self._owed.discard(topic)


def _type_to_send(topic: str, adverts: Sequence[Advert]) -> str:
    types = [a.type for a in sorted(adverts, key=lambda a: {True: 0, None: 1, False: 2}[a.wanted]) if a.name == topic]
    known = [kind for kind in types if kind in (TWIST, TWIST_STAMPED)]
    others = [kind for kind in types if kind]
    if others and not known:
        raise FeedError(f"{topic} is {others[0]}, expected {TWIST} or {TWIST_STAMPED}")
    return known[0] if known else TWIST


def twist(message_type: str, linear: float, angular: float) -> dict[str, Any]:
    """The fields of a Twist or TwistStamped, in m/s and rad/s.

    The stamp is 0, by which controllers that judge the age of a speed take the time of its arrival: by the clock of
    this machine, where it is ahead of the robot's, a speed would hold for too long when nothing comes any more.
    """
    fields_of_twist = {
        "linear": {"x": linear, "y": 0.0, "z": 0.0},
        "angular": {"x": 0.0, "y": 0.0, "z": angular},
    }
    if message_type == TWIST:
        return fields_of_twist
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}
    return {"header": header, "twist": fields_of_twist}


def _cut(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))
