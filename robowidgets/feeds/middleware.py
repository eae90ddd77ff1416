"""The interface between `Feed` and the modules of the middlewares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

from ..runtime.renamed import renamed

EVENTS = 100
"""The longest queue of messages, for kinds that need every message."""

MOST_UNREAD = 1000
"""The longest queue of messages of a topic if every message is passed on."""

SEND_TIMEOUT = 0.5
"""Seconds within which the network must accept a published message."""

CLOSE_TIMEOUT = 2.0
"""Seconds that `Middleware.close` may take."""


class FeedError(Exception):
    """An error on opening or using a feed. The text is one line: the failure, the reason, and what to do next."""


class NotConnectedYetError(FeedError):
    """A message that was not sent because the robot has not connected yet. The next attempt may succeed."""


class Advert(NamedTuple):
    """A topic that a middleware lists.

    ``type`` is written as ``sensor_msgs/msg/LaserScan``, also for ROS 1, or empty if it is unknown. ``offered`` is True
    if another node publishes it, ``wanted`` if another node subscribes to it, or None if unknown. ``publishers`` are
    the names of the other nodes that publish it, if the middleware reports them. None means that no other node drives
    by it, as for a recording or the simulated robot itself. ``subscribers`` are the names of the other nodes that
    subscribe to it, if they are reported, or None if they are unknown.
    """

    name: str
    type: str
    offered: bool = True
    wanted: bool | None = None
    publishers: tuple[str, ...] | None = ()
    subscribers: tuple[str, ...] | None = None


class Listener(Protocol):
    """The feed, as its middleware calls it. Any thread may call each method, which returns at once and never raises.

    No method runs code of the user, because the calling thread may send speeds. A method may call the middleware, so
    the caller must not hold a lock that the middleware's methods take. A repeated report costs little and changes
    nothing.
    """

    def on_connected(self) -> None:
        """Report that the robot can be reached, for the first time or again."""

    def on_lost(self, reason: str, again_in: float) -> None:
        """Report that the robot cannot be reached, or no longer, and the seconds until the next attempt."""

    def on_nobody(self, reason: str) -> None:
        """Report a hint to show if no robot is discovered shortly after opening, or empty once a robot is."""

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """Report all topics that are known now. Called when the list changes."""

    def on_message(
        self, topic: str, message: Any, *, newest: bool = True, each: bool = True, replaced: int = 0
    ) -> None:
        """Pass on a message of a subscribed topic, in any form that the ``update`` of a widget accepts.

        If a middleware skips replaced messages for some targets, it passes ``newest=False`` with a message that a newer
        one has replaced already, and ``each=False`` with a message that it also passes on in its order among all.
        ``replaced`` is the number of earlier messages that this one replaced, so that rates count them, too.
        """

    def on_missed(self, topic: str, count: int) -> None:
        """Report the number of lost messages of a topic whose every message was requested, if it is known."""

    def on_trouble(self, topic: str, reason: str) -> None:
        """Report as a sentence why a subscribed topic's messages do not come or cannot be read; empty ends it."""

    def on_unheard(self, topic: str, reason: str) -> None:
        """Report as a sentence why a subscriber does not receive our messages on a topic; empty ends it.

        The reason may be an incompatible quality of service, or a bridge that does not answer.
        """


class Outlet(NamedTuple):
    """The middleware that a guard publishes by: its name in `_guard.process.MIDDLEWARES`, and its arguments in JSON."""

    middleware: str
    arguments: dict[str, Any]


@runtime_checkable
class HasOutlet(Protocol):
    """A middleware whose robot a guard can drive over another connection."""

    @property
    def outlet(self) -> Outlet:
        """The middleware for the guard."""


class Middleware(Protocol):
    """A connection to a robot. `publish` and `close` may take a moment; every other call returns at once."""

    @property
    def where(self) -> str:
        """The name of the connection for the user: ``ws://127.0.0.1:8765``, ``ROS 2, domain 0``."""

    def open(self, listener: Listener) -> None:
        """Connect, and reconnect with growing pauses. Raise FeedError if the connection can never work."""

    def follow(self, topics: frozenset[str], each: frozenset[str] = frozenset()) -> None:
        """Pass on the messages of these topics, which may appear later, and of no others, also after reconnecting.

        For topics in ``each``, every message is passed on in order, within the queue of `MOST_UNREAD`. For the others,
        the newest message is enough.
        """

    def ask_for_nodes(self, wanted: bool) -> None:
        """Report the nodes of all topics in `Listener.on_topics`, or stop it, also after reconnecting.

        A middleware that knows the nodes anyway does nothing here. If it must query the robot, it does so slowly.
        """

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """Send a Twist or TwistStamped, given as its fields, and return when the network has accepted it.

        One thread at a time calls it, never a thread of the middleware. A message is never kept for a later connection,
        because it may be a speed.

        Raises:
            NotConnectedYetError: no subscriber has connected yet.
            FeedError: the middleware is not connected, the network does not accept the message within `SEND_TIMEOUT`,
                or messages cannot be published at all. The message is not sent.
            TimeoutError, ConnectionError: the message may have reached the robot, or may still reach it.
        """

    def close(self) -> None:
        """Deliver the published messages, disconnect, and end every thread, within `CLOSE_TIMEOUT`.

        Calling it again does nothing. Any thread may call it, including threads of the middleware.
        """


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        return renamed(__name__, name, {"NotYetError": NotConnectedYetError})
