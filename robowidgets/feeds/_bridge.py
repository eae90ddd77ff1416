"""The base of the middlewares whose protocol runs over a websocket."""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from ._topics import queue_length
from ._websocket import LARGEST, Frame, WebSocketClient
from .middleware import Listener

Read = Callable[[Any], Any]
"""Decodes a frame into a message, or raises UnreadableError."""


class UnreadableError(Exception):
    """A message or a channel that cannot be read; the text says why, for a person."""


class Bridge:
    """The part of a `Middleware` that is the same for every protocol. A protocol is a subclass.

    All methods but those of `Middleware` run in the client's thread. All frames that wait in the network are received
    first; then only the newest of each topic is decoded, but every event. The subclass calls `Listener.on_connected` as
    soon as it can publish.

    Raises:
        TypeError, ValueError: the address is invalid.
    """

    def __init__(self, address: str, subprotocols: list[str] | None = None) -> None:
        self._client = WebSocketClient(address, self, subprotocols)
        self._listener: Listener
        self._wanted: set[str] = set()
        self._received: set[str] = set()
        self._pending: dict[str, deque[tuple[Read, Any]]] = {}
        self._begin()

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return self._client.address

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        self._listener = listener
        self._client.open()

    def close(self) -> None:
        """See `Middleware`."""
        self._client.close()

    def subscribe(self, topic: str) -> None:
        """See `Middleware`."""

        def start() -> None:
            self._wanted.add(topic)
            self._start(topic)

        self._client.call(start)

    def unsubscribe(self, topic: str) -> None:
        """See `Middleware`."""

        def stop() -> None:
            self._wanted.discard(topic)
            self._received.discard(topic)
            self._stop(topic)

        self._client.call(stop)

    def on_open(self) -> None:
        """See `Handler`."""
        self._received, self._pending = set(), {}
        self._begin()
        for topic in self._wanted:
            self._start(topic)

    def deliver(self) -> None:
        """See `Handler`."""
        pending, self._pending = self._pending, {}
        for topic, read, frame in [(topic, *one) for topic, waiting in pending.items() for one in waiting]:
            if topic not in self._wanted or self._client.closed:
                continue
            try:
                message = read(frame)
            except UnreadableError as error:
                self._listener.on_trouble(topic, str(error))
            else:
                self._received.add(topic)
                self._listener.on_trouble(topic, self._flaw(topic, message))
                self._listener.on_message(topic, message)

    def on_lost(self, reason: str, again_in: float, too_big: bool) -> None:
        """See `Handler`."""
        if too_big:
            # The topic of the message is unknown: it is one of those without a message so far.
            suspects = self._wanted - self._received
            self._wanted -= suspects
            among = f", or another of {', '.join(sorted(suspects))}," if len(suspects) > 1 else ""
            for topic in suspects:
                reason_of = (
                    f"{topic}{among} sent a message larger than {LARGEST // 1_000_000} MB: it is not listened to"
                )
                self._listener.on_trouble(topic, reason_of)
        self._listener.on_lost(reason, again_in)

    async def finish(self) -> None:
        """See `Handler`."""

    def on_frame(self, frame: Frame) -> None:
        """See `Handler`."""
        raise NotImplementedError

    def _begin(self) -> None:
        """Reset the state of the protocol, for a new connection."""
        raise NotImplementedError

    def _start(self, topic: str) -> None:
        """Request the messages of a topic."""
        raise NotImplementedError

    def _stop(self, topic: str) -> None:
        """End the request for the messages of a topic."""
        raise NotImplementedError

    def _keep(self, topic: str, kind: str, read: Read, frame: Any) -> None:
        """Queue a frame for decoding."""
        self._pending.setdefault(topic, deque(maxlen=queue_length(kind))).append((read, frame))

    def _flaw(self, topic: str, message: Any) -> str:  # noqa: ARG002
        """The reason why a decoded message is refused; empty if it is not."""
        return ""

    def _write(self, operation: Mapping[str, Any]) -> None:
        self._client.write(json.dumps(operation))

    def _report_on_all(self, reason: str) -> None:
        for topic in self._wanted:
            self._listener.on_trouble(topic, reason)


def full_type(name: str) -> str:
    """A type in the spelling of ROS 2: ``sensor_msgs/msg/LaserScan`` for ``sensor_msgs/LaserScan``."""
    package, slash, rest = name.partition("/")
    return f"{package}/msg/{rest}" if slash and "/" not in rest else name


def short_type(name: str) -> str:
    """A type in the spelling of ROS 1: ``sensor_msgs/LaserScan``."""
    return name.replace("/msg/", "/")


def other_nodes(nodes: Iterable[str], bridge: str) -> tuple[str, ...]:
    """The names of nodes, without the node of the bridge, which subscribes and publishes for us."""
    return tuple(sorted({node for node in nodes if not node.rpartition("/")[2].startswith(bridge)}))


def strings(value: Any) -> list[str]:
    """The strings in a list that the server sent; empty for anything but a list."""
    return [item for item in value if isinstance(item, str)] if isinstance(value, list) else []
