"""What the middlewares that are spoken to over a websocket have in common."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from ..kinds import counts_every_message
from ._websocket import LARGEST, Frame, Line
from .middleware import EVENTS, Advert, FeedError, Listener

Read = Callable[[Any], Any]
"""Makes a message of a frame, or raises UnreadableError."""


class UnreadableError(Exception):
    """A message or a channel that cannot be read; the text says why, for a person."""


class Bridge:
    """The part of a `Middleware` that knows topics and troubles but no protocol.

    All but the calls of `Middleware` runs in the thread of the line. Of each topic the newest frame is read, once those
    that wait in the network are in; of events all. The protocol tells `Listener.on_connected`, as soon as it can
    publish.

    Raises:
        TypeError, ValueError: the address is not one.
    """

    def __init__(self, address: str, subprotocols: list[str] | None = None) -> None:
        self._line = Line(address, self, subprotocols)
        self._listener: Listener
        self._wanted: set[str] = set()
        self._heard: set[str] = set()
        self._pending: dict[str, deque[tuple[Read, Any]]] = {}
        self._troubles: dict[str, str] = {}
        self._told: Sequence[Advert] | None = None
        self._begin()

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return self._line.address

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        self._listener = listener
        self._line.open()

    def close(self) -> None:
        """See `Middleware`."""
        self._line.close()

    def subscribe(self, topic: str) -> None:
        """See `Middleware`."""

        def want() -> None:
            self._wanted.add(topic)
            self._start(topic)

        self._line.call(want)

    def unsubscribe(self, topic: str) -> None:
        """See `Middleware`."""

        def forget() -> None:
            self._wanted.discard(topic)
            self._heard.discard(topic)
            self._troubles.pop(topic, None)
            self._stop(topic)

        self._line.call(forget)

    def on_open(self) -> None:
        """See `Talk`."""
        self._heard, self._pending, self._told = set(), {}, None
        self._begin()
        for topic in self._wanted:
            self._start(topic)

    def deliver(self) -> None:
        """See `Talk`."""
        pending, self._pending = self._pending, {}
        for topic, read, frame in [(topic, *one) for topic, waiting in pending.items() for one in waiting]:
            if topic not in self._wanted or self._line.closed:
                continue
            try:
                message = read(frame)
            except UnreadableError as error:
                self._trouble(topic, str(error))
            else:
                self._heard.add(topic)
                self._trouble(topic, self._about(topic, message))
                self._listener.on_message(topic, message)

    def on_lost(self, why: str, again_in: float, too_big: bool) -> None:
        """See `Talk`."""
        if too_big:
            # Which topic it was, nobody can tell: one of those of which no message was read yet.
            suspects = self._wanted - self._heard
            self._wanted -= suspects
            among = f", or another of {', '.join(sorted(suspects))}," if len(suspects) > 1 else ""
            for topic in suspects:
                words = f"{topic}{among} sent a message larger than {LARGEST // 1_000_000} MB: it is not listened to"
                self._trouble(topic, words)
        self._listener.on_lost(why, again_in)

    async def finish(self) -> None:
        """See `Talk`."""

    def on_frame(self, frame: Frame) -> None:
        """See `Talk`."""
        raise NotImplementedError

    def _begin(self) -> None:
        """Start anew, for another connection."""
        raise NotImplementedError

    def _start(self, topic: str) -> None:
        """Ask for the messages of a topic."""
        raise NotImplementedError

    def _stop(self, topic: str) -> None:
        """Ask for no more messages of a topic."""
        raise NotImplementedError

    def _keep(self, topic: str, kind: str, read: Read, frame: Any) -> None:
        """Have a frame of a type of messages read, in place of the one before unless that was an event."""
        waiting = self._pending.setdefault(topic, deque(maxlen=EVENTS))
        if not counts_every_message(kind):
            waiting.clear()
        waiting.append((read, frame))

    def _about(self, topic: str, message: Any) -> str:  # noqa: ARG002
        """What is to be said of a message that was read."""
        return ""

    def _tell(self, adverts: Sequence[Advert]) -> None:
        if adverts != self._told:
            self._told = adverts
            self._listener.on_topics(adverts)

    def _write(self, said: Mapping[str, Any]) -> None:
        self._line.write(json.dumps(said))

    def _trouble(self, topic: str, words: str) -> None:
        if self._troubles.get(topic, "") != words:
            self._troubles[topic] = words
            self._listener.on_trouble(topic, words)

    def _trouble_all(self, words: str) -> None:
        for topic in self._wanted:
            self._trouble(topic, words)


def full_type(name: str) -> str:
    """A type as ROS 2 writes it: ``sensor_msgs/msg/LaserScan`` for ``sensor_msgs/LaserScan``."""
    package, slash, rest = name.partition("/")
    return f"{package}/msg/{rest}" if slash and "/" not in rest else name


def short_type(name: str) -> str:
    """A type as ROS 1 writes it: ``sensor_msgs/LaserScan``."""
    return name.replace("/msg/", "/")


def to_json(message_type: str, message: Mapping[str, Any], said: Mapping[str, Any]) -> str:
    """What is said about a message, or the message itself, as JSON; FeedError when it holds what JSON cannot say."""
    try:
        return json.dumps(said, allow_nan=False)
    except (TypeError, ValueError) as error:
        raise FeedError(f"{dict(message)!r} cannot be sent as a {message_type} in JSON: {error}") from None


def is_zero(message: Any) -> bool:
    """Whether all fields of a message are 0, apart from its header: a speed of zero stops the robot."""
    if isinstance(message, Mapping):
        return all(is_zero(field) for name, field in message.items() if name != "header")
    return not message


def other_nodes(nodes: Iterable[str], bridge: str) -> tuple[str, ...]:
    """The names of nodes without those of the bridge itself, which listens and publishes for us."""
    return tuple(sorted({node for node in nodes if not node.rpartition("/")[2].startswith(bridge)}))


def strings(value: Any) -> list[str]:
    """The texts in a list that a machine sent."""
    return [item for item in value if isinstance(item, str)] if isinstance(value, list) else []
