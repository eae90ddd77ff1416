"""What a feed needs of a middleware: the seam between the adapters and `Feed`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

from .._kinds import widget_by_type

EVENTS = 100
"""Messages of a touch sensor that may wait to be handed on."""


class FeedError(Exception):
    """A feed that cannot be opened or used. The text is one line for a person: what, why, and what to do."""


def is_event(type_name: str) -> bool:
    """Whether each message of a type counts, as an event that no later one repeats; of others the newest is enough."""
    return widget_by_type(type_name) == "touch"


class Advert(NamedTuple):
    """A topic that a middleware knows of.

    ``type`` is written as ``sensor_msgs/msg/LaserScan``, for ROS 1 too; empty when it cannot be told. ``offered`` says
    whether somebody publishes it, ``wanted`` whether somebody else subscribes to it (None: it cannot be told).
    """

    name: str
    type: str
    offered: bool = True
    wanted: bool | None = None


class Listener(Protocol):
    """What a middleware tells; a feed. It may be called from any thread, returns at once and never raises.

    It may call the middleware back from within, so it is called without a lock that the middleware's methods take.
    """

    def on_connected(self) -> None:
        """The robot can be reached, for the first time or again."""

    def on_lost(self, why: str, again_in: float) -> None:
        """It cannot be reached, or not any more, and is tried again in so many seconds."""

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """All topics there are now; called when the list changes."""

    def on_message(self, topic: str, message: Any) -> None:
        """A message of a subscribed topic: anything that the ``update`` of a widget takes."""

    def on_trouble(self, topic: str, words: str) -> None:
        """Why no message of a subscribed topic comes or can be read, in a sentence; empty when that is over."""


class Middleware(Protocol):
    """A connection to a robot. Each call returns at once; what takes time happens in a thread of its own."""

    @property
    def where(self) -> str:
        """What is connected to, for a person: ``ws://127.0.0.1:8765``, ``ROS 2, domain 0``."""

    def open(self, listener: Listener) -> None:
        """Connect, and come back by itself with growing pauses. FeedError when that can never work."""

    def subscribe(self, topic: str) -> None:
        """Hand on the messages of a topic, also of one that is not there yet, also after a connection was lost."""

    def unsubscribe(self, topic: str) -> None:
        """Hand on no more messages of a topic."""

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """Publish a message, given as its fields; FeedError when the middleware cannot.

        What is published before there is a connection is dropped, never kept: it may be a speed.
        """

    def close(self) -> None:
        """Disconnect, end and join every thread; doing it again does nothing. A callback may do it, too."""
