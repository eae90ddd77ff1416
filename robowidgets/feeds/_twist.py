"""Publishing speeds as Twist or TwistStamped."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from typing import Any

from ..driving.command_watchdog import RECENT
from ..messages.standard import TWIST, TWIST_STAMPED
from .middleware import Advert, FeedError, Middleware


class TwistPublisher:
    """Publishes speeds as Twist or TwistStamped, as the subscriber expects; as Twist when no subscriber is known.

    Args:
        middleware: the middleware that publishes.
    """

    def __init__(self, middleware: Middleware) -> None:
        self._middleware = middleware
        self._moved: dict[str, list[str]] = {}
        """For each topic, the types in which a speed other than zero was published."""
        self._moved_at: dict[str, float] = {}
        self._owed: set[str] = set()
        """The topics to which no zero was sent since then: their zero is overdue."""

    def on_connected(self) -> None:
        """Make zero overdue again: one published shortly before the loss of connection may not have arrived."""
        since = time.monotonic() - RECENT
        self._owed |= {topic for topic, at in list(self._moved_at.items()) if at > since}

    def send(self, topic: str, linear: float, angular: float, adverts: Sequence[Advert]) -> None:
        """Publish a speed in m/s and rad/s.

        Zero is published in every type in which a speed was published, and on every topic whose zero is overdue.

        Raises:
            FeedError: the topic has another type, and no speed was sent on it; or the middleware cannot publish.
        """
        if linear or angular:
            kind = _type_to_send(topic, adverts)
            self._middleware.publish(topic, kind, twist(kind, linear, angular))
            self._owed.add(topic)
            self._moved_at[topic] = time.monotonic()
            if kind not in self._moved.setdefault(topic, []):
                self._moved[topic].append(kind)
            return
        with ExitStack() as each:  # every zero is sent, even after one of them raised
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

    The stamp is 0, which makes controllers with a command time-out use the time of arrival. A stamp from this machine's
    clock, if that is ahead of the robot's, would keep the last speed valid for too long.
    """
    fields_of_twist = {
        "linear": {"x": linear, "y": 0.0, "z": 0.0},
        "angular": {"x": 0.0, "y": 0.0, "z": angular},
    }
    if message_type == TWIST:
        return fields_of_twist
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}
    return {"header": header, "twist": fields_of_twist}


def is_zero(message: Any) -> bool:
    """Whether all fields of a message are 0, apart from its header. Such a speed stops the robot."""
    if isinstance(message, Mapping):
        return all(is_zero(field) for name, field in message.items() if name != "header")
    return not message


def fill(message: Any, fields: Mapping[str, Any]) -> Any:
    """A message of rclpy or rospy with these values in its fields; ROS 1 has other names for the parts of a stamp."""
    ros1_names = {"sec": "secs", "nanosec": "nsecs"}
    for key, value in fields.items():
        name = key if hasattr(message, key) else ros1_names[key]
        setattr(message, name, fill(getattr(message, name), value) if isinstance(value, Mapping) else value)
    return message
