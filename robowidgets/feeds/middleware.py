"""The interface between `Feed` and the modules of the middlewares."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, runtime_checkable

from .._core.renamed import renamed

EVENTS = 100
"""Longest queue of messages, for kinds of which every message counts."""

MOST_UNREAD = 1000
"""Longest queue of the messages of a topic of which each is passed on."""

SEND_TIMEOUT = 0.5
"""Seconds within which the network must take a message that is published."""

CLOSE_TIMEOUT = 2.0
"""Seconds that `Middleware.close` may take."""


class FeedError(Exception):
    """A feed cannot be opened or used. The text is one line for a person: the failure, the reason, the next step."""


class NotConnectedYetError(FeedError):
    """A message that was not sent because the robot has not connected yet. The next attempt may succeed."""


class Advert(NamedTuple):
    """A topic that a middleware lists.

    ``type`` is written as ``sensor_msgs/msg/LaserScan``, also for ROS 1; empty when it is unknown. ``offered`` is True
    if another node publishes it, ``wanted`` if another node subscribes to it (None: unknown). ``publishers`` are the
    names of the other nodes that publish it, as far as the middleware reports them; None where nobody else drives by
    it: of a recording, and of the simulated robot itself. ``subscribers`` are the names of the other nodes that
    subscribe to it, as far as they are reported; None where it is not known who they are.
    """

    name: str
    type: str
    offered: bool = True
    wanted: bool | None = None
    publishers: tuple[str, ...] | None = ()
    subscribers: tuple[str, ...] | None = None


class Listener(Protocol):
    """The feed, as its middleware calls it. Any thread may call each method, which returns at once and never raises.

    No method runs code of the user, because the calling thread may carry speeds. A method may call the middleware from
    within, so the caller must hold no lock that the middleware's methods take. Reporting the same again costs little
    and changes nothing.
    """

    def on_connected(self) -> None:
        """The robot can be reached, for the first time or again."""

    def on_lost(self, reason: str, again_in: float) -> None:
        """The robot cannot be reached, or no longer; the next attempt follows in so many seconds."""

    def on_nobody(self, reason: str) -> None:
        """The reason why nobody may be there, a moment after opening, as what to compare; empty: somebody is there."""

    def on_topics(self, topics: Sequence[Advert]) -> None:
        """All topics that are known now. Called when the list changes."""

    def on_message(
        self, topic: str, message: Any, *, newest: bool = True, each: bool = True, replaced: int = 0
    ) -> None:
        """A message of a subscribed topic: anything that the ``update`` of a widget takes.

        A middleware that leaves out what a newer message replaces calls it with ``newest=False`` for a message that was
        replaced already, and with ``each=False`` for one that it passes on in its place among all, too.
        With ``replaced`` it gives the number of messages that came before this one and were left out for it, so that
        rates count them, too.
        """

    def on_missed(self, topic: str, count: int) -> None:
        """So many messages of a topic of which each was asked for are not passed on, as far as it is known."""

    def on_trouble(self, topic: str, reason: str) -> None:
        """The reason why no message of a subscribed topic comes or can be read, as a sentence; empty: none any more."""

    def on_unheard(self, topic: str, reason: str) -> None:
        """The reason why a subscriber does not receive our messages on a topic, as a sentence; empty: none any more.

        The reason may be an incompatible quality of service, or a bridge that does not answer.
        """


class Outlet(NamedTuple):
    """What a guard publishes by: the name of a middleware in `_guard.process.MIDDLEWARES`, and arguments in JSON."""

    middleware: str
    arguments: dict[str, Any]


@runtime_checkable
class HasOutlet(Protocol):
    """A middleware whose robot a guard can drive by a connection of its own."""

    @property
    def outlet(self) -> Outlet:
        """What the guard publishes by."""


class Middleware(Protocol):
    """A connection to a robot. `publish` and `close` may take a moment; every other call returns at once."""

    @property
    def where(self) -> str:
        """The name of the connection, for a person: ``ws://127.0.0.1:8765``, ``ROS 2, domain 0``."""

    def open(self, listener: Listener) -> None:
        """Connect, and reconnect with growing pauses. FeedError when that can never work."""

    def follow(self, topics: frozenset[str], each: frozenset[str] = frozenset()) -> None:
        """Pass on the messages of these topics, which may appear later, and of no others; also after reconnecting.

        Of the topics in ``each``, every message is passed on, in order, as far as `MOST_UNREAD` reaches; of others the
        newest is enough.
        """

    def ask_for_nodes(self, wanted: bool) -> None:
        """Have `Listener.on_topics` name the nodes of all topics, or no longer; also after reconnecting.

        A middleware that is told who they are does nothing here. One that has to ask the robot does so slowly.
        """

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """Send a Twist or TwistStamped, given as its fields, and return when the network has taken it.

        One thread at a time calls it, never a thread of the middleware. A message is never kept for a later connection:
        it may be a speed.

        Raises:
            NotConnectedYetError: no subscriber has connected yet.
            FeedError: there is no connection, the network does not take the message within `SEND_TIMEOUT`, or messages
                cannot be published at all. The message is not sent.
            TimeoutError, ConnectionError: it may have reached the robot, or may still.
        """

    def close(self) -> None:
        """Deliver the published messages, disconnect, and end every thread, within `CLOSE_TIMEOUT`.

        Doing it again does nothing. Any thread may call it, also one of the middleware.
        """


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        return renamed(__name__, name, {"NotYetError": NotConnectedYetError})
