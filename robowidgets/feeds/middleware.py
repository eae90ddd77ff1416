"""What a feed needs of a middleware: the seam between the adapters and `Feed`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple, Protocol

EVENTS = 100
"""Messages that may wait to be handed on, of a kind of which every message counts."""

SEND_TIMEOUT = 0.5
"""Seconds within which the network must take a message that is published."""

CLOSE_TIMEOUT = 2.0
"""Seconds that `Middleware.close` may take."""


class FeedError(Exception):
    """A feed that cannot be opened or used. The text is one line for a person: what, why, and what to do."""


class Advert(NamedTuple):
    """A topic that a middleware knows of.

    ``type`` is written as ``sensor_msgs/msg/LaserScan``, for ROS 1 too; empty when it cannot be told. ``offered`` says
    whether somebody else publishes it, ``wanted`` whether somebody else subscribes to it (None: it cannot be told).
    ``publishers`` are the names of the other nodes that publish it, as far as the middleware tells names.
    """

    name: str
    type: str
    offered: bool = True
    wanted: bool | None = None
    publishers: tuple[str, ...] = ()


class Listener(Protocol):
    """What a middleware tells; a feed. It may be called from any thread, returns at once and never raises.

    No method runs code of the user: the thread that calls may carry speeds. A method may call the middleware back from
    within, so it is called without a lock that the middleware's methods take.
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

    def on_unheard(self, topic: str, words: str) -> None:
        """Why a subscriber does not receive what is published here on a topic, in a sentence; empty when that is over.

        An incompatible quality of service, say.
        """


class Middleware(Protocol):
    """A connection to a robot. `publish` and `close` may take a moment; every other call returns at once."""

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
        """Hand a message, given as its fields, to the network, and return when the network has it.

        It is called by one thread at a time, which is none of the middleware's. Nothing is kept for a later connection:
        it may be a speed.

        Raises:
            FeedError: there is no connection, the network does not take the message within `SEND_TIMEOUT`, or messages
                cannot be published at all.
        """

    def close(self) -> None:
        """Deliver what was published, disconnect, and end every thread, within `CLOSE_TIMEOUT`.

        Doing it again does nothing. Any thread may do it, one of the middleware's, too.
        """
