"""Publishing speeds as Twist or TwistStamped."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from typing import Any, Protocol

from ..driving.command_watchdog import RECENT, ZERO, Velocity
from ..messages.twist import TWIST, TWIST_STAMPED
from ..runtime.clock import Clock
from .middleware import Advert, FeedError


class Publishes(Protocol):
    """The part of a middleware that publishes."""

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""


class TwistPublisher:
    """A publisher of speeds as Twist or TwistStamped, as each subscriber expects, or as Twist without a known one.

    Args:
        middleware: the middleware that publishes.

    Attributes:
        refused: the reason why the last message was published in only one of two types, or empty if in both.
    """

    def __init__(self, middleware: Publishes, clock: Clock) -> None:
        self._middleware, self._clock = middleware, clock
        self.refused = ""
        self._moved: dict[str, list[str]] = {}
        """By topic, the types in which a speed other than zero was published."""
        self._moved_at: dict[str, float] = {}
        self._owed: set[str] = set()
        """The topics to which no zero was sent after such a speed: their zero is overdue."""

    def on_connected(self) -> None:
        """Make zero overdue again, because a zero from shortly before the loss of connection may not have arrived."""
        since = self._clock.now() - RECENT
        self._owed |= {topic for topic, at in list(self._moved_at.items()) if at > since}

    def moved(self, topic: str) -> list[str]:
        """Return the types in which a speed other than zero was published on a topic."""
        return list(self._moved.get(topic, ()))

    def note_moved(self, topic: str, kinds: Iterable[str]) -> None:
        """Note the types of speeds that another publisher has sent on a topic, which may need a zero from here."""
        there = self._moved.setdefault(topic, [])
        there += [kind for kind in kinds if kind not in there]

    def send(self, topic: str, velocity: Velocity, adverts: Sequence[Advert]) -> None:
        """Publish a speed.

        Zero is also published in every type in which a speed was published, and on every topic whose zero is overdue.

        Raises:
            FeedError: the topic has another type, and no speed was sent on it; or the middleware cannot publish.
        """
        if velocity != ZERO:
            self._publish(topic, _types_to_send(topic, adverts), velocity)
            return
        with ExitStack() as each:  # every zero is sent, even if another one fails
            for name in dict.fromkeys((topic, *self._owed)):  # runs backwards: the first topic may be new, and wait
                each.callback(self._send_zero, name, adverts)

    def _send_zero(self, topic: str, adverts: Sequence[Advert]) -> None:
        kinds = list(self._moved.get(topic, ()))
        try:
            kinds += _types_to_send(topic, adverts)
        except FeedError:
            if not kinds:
                raise
        self._publish(topic, kinds, ZERO)
        self._owed.discard(topic)

    def _publish(self, topic: str, kinds: Iterable[str], velocity: Velocity) -> None:
        """Publish in each type. Raise if nothing was sent, if a message may have been, or if a robot gets no zero."""
        moves, moved = velocity != ZERO, self._moved.setdefault(topic, [])
        sent: list[str] = []
        failures: dict[str, Exception] = {}
        for kind in dict.fromkeys(kinds):
            try:
                self._middleware.publish(topic, kind, twist(kind, velocity))
                sent.append(kind)
            except Exception as failure:  # the message must be sent in the other type, too
                failures[kind] = failure
            if moves and not isinstance(failures.get(kind), FeedError):  # it may have reached the robot
                self._owed.add(topic)
                self._moved_at[topic] = self._clock.now()
                if kind not in moved:
                    moved.append(kind)
        # A FeedError means that nothing was sent, so any other error is raised first.
        for kind, error in sorted(failures.items(), key=lambda failed: isinstance(failed[1], FeedError)):
            if not sent or not isinstance(error, FeedError) or (kind in moved and not moves):
                raise error
        self.refused = "; ".join(map(str, failures.values()))


def _types_to_send(topic: str, adverts: Iterable[Advert]) -> list[str]:
    here = [advert for advert in adverts if advert.name == topic and advert.type]
    known = [advert for advert in here if advert.type in (TWIST, TWIST_STAMPED)]
    if here and not known:
        raise FeedError(f"{topic} is {here[0].type}, expected {TWIST} or {TWIST_STAMPED}")
    guessed = [advert.type for advert in sorted(known, key=lambda advert: advert.wanted is False)] or [TWIST]
    return [advert.type for advert in known if advert.wanted] or guessed[:1]


def twist(message_type: str, velocity: Velocity) -> dict[str, Any]:
    """Return the fields of a Twist or TwistStamped.

    The stamp is 0, so that controllers with a command timeout use the time of arrival. If this machine's clock is ahead
    of the robot's, a stamp from it would keep the last speed valid for too long.
    """
    fields_of_twist = {
        "linear": {"x": velocity.linear, "y": velocity.lateral, "z": 0.0},
        "angular": {"x": 0.0, "y": 0.0, "z": velocity.angular},
    }
    if message_type == TWIST:
        return fields_of_twist
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}
    return {"header": header, "twist": fields_of_twist}


def is_zero(message: Any) -> bool:
    """Return True if all fields of a message are 0, except its header. Such a speed stops the robot."""
    if isinstance(message, Mapping):
        return all(is_zero(field) for name, field in message.items() if name != "header")
    return not message


def fill(message: Any, fields: Mapping[str, Any]) -> Any:
    """Return a message of rclpy or rospy with its fields set. ROS 1 has different names for the parts of a stamp."""
    ros1_names = {"sec": "secs", "nanosec": "nsecs"}
    for key, value in fields.items():
        name = key if hasattr(message, key) else ros1_names[key]
        setattr(message, name, fill(getattr(message, name), value) if isinstance(value, Mapping) else value)
    return message
