"""ROS 1, through rospy."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NamedTuple
from urllib.parse import urlsplit

from ..messages.channel import Channel
from ..notebook import in_browser
from ._guard.mark import MARK
from ._ros1_master import Master, MasterError, SystemState, master_of
from ._ros1_presence import Presence
from ._ros1_publications import SHUT_DOWN, Publications
from ._threaded import ThreadedMiddleware
from .middleware import Advert, FeedError, Listener, Outlet

if TYPE_CHECKING:
    from ..messages.decoding import Decode
    from .feed import Feed

log = logging.getLogger("robowidgets")

POLL = 1.0
"""Seconds between two requests to the master."""

CONNECT_TIMEOUT_S = 3.0
"""Seconds without a connection to a publisher after which its address is checked."""

DATA_COME = "master lost; data still come"

_SPEEDS = ("geometry_msgs/Twist", "geometry_msgs/TwistStamped")

_STARTING = threading.Lock()


class _Subscription(NamedTuple):
    subscriber: Any
    kind: str
    since: float


class Ros1(ThreadedMiddleware):
    """A `Middleware` on the only node that a process may have, with the master in ROS_MASTER_URI at the start.

    The node is the program's node if it called `rospy.init_node`, or else ours. It stays until the process ends. Every
    second a thread requests the state of the master, subscribes and publishes, and registers again with a restarted
    master. Messages come in threads of rospy: as rospy objects if the Python package of their type is installed, or
    else decoded by the definition that their publisher sends.

    Args:
        name: see `ros1`.
        master: for a guard, the URI of the master. It is set as ROS_MASTER_URI of its process.
    """

    def __init__(self, name: str = "robowidgets", master: str = "") -> None:
        super().__init__()
        self._name = name
        self._rospy: Any = None
        if master:
            os.environ["ROS_MASTER_URI"] = master  # rospy reads it only from here
        self._master = Master(master or _uri_of_environment())
        self._presence = Presence(self._master, self._look_soon)
        self._listener: Listener | None = None
        self._woken = False
        self._connected = False
        self._subscriptions: dict[str, _Subscription] = {}
        self._failed: set[str] = set()
        self._decoders: dict[str, Decode] = {}
        self._log = _RospyLog(self)

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return f"ROS 1, {self._master.uri}" if self._master.uri else "ROS 1"

    @property
    def outlet(self) -> Outlet:
        """See `HasOutlet`."""
        return Outlet("ros1", {"name": MARK, "master": self._master.uri})

    def open(self, listener: Listener) -> None:
        """See `Middleware`. Raise FeedError without rospy, or if ROS_MASTER_URI is not the URI of the node's master."""
        if why := in_browser.no_robot("feeds.ros1"):
            raise FeedError(why)
        try:
            import rosgraph.names
            import roslib.message  # noqa: F401
            import rospy
        except ImportError as error:
            raise FeedError(
                f"rospy cannot be imported here ({error}): on Debian or Ubuntu install python3-rospy, and make the "
                "venv with --system-site-packages; feeds.rosbridge() needs no ROS"
            ) from None
        if rospy.is_shutdown():
            raise FeedError(SHUT_DOWN)
        if not rosgraph.names.is_legal_base_name(self._name):
            raise FeedError(f"name: expected the name of a node, letters, digits and _, got {self._name!r}")
        uri = self._master.uri
        try:
            good = urlsplit(uri).scheme == "http" and urlsplit(uri).hostname and urlsplit(uri).port
        except ValueError:
            good = False
        if not good:
            raise FeedError(f"ROS_MASTER_URI: expected something like http://robot:11311, got {uri!r}")
        self._rospy, self._listener = rospy, listener
        with suppress(MasterError):  # the node is busy, and is asked again
            self._check_master()
        self._publications = Publications(rospy, self._master, listener.on_unheard, self._look_soon)
        logging.getLogger("rospy.internal").addHandler(self._log)
        self._start_thread(f"robowidgets {self.where}", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`. Raise FeedError also if the Python package of the type is not installed."""
        if self._listener is None or self._closed.is_set():
            raise FeedError(f"{self.where} is not connected")
        self._publications.publish(topic, message_type, message)

    def close(self) -> None:
        """See `Middleware`. The node and its publishers stay."""
        logging.getLogger("rospy.internal").removeHandler(self._log)
        super().close()  # with a limit on the wait for the thread, because rospy's calls to a master have no timeout

    def failed(self, topic: str, reason: str) -> None:
        """Report that rospy gave up a connection of a topic. Until the next attempt, only the first reason counts."""
        if topic in self._wanted and topic not in self._failed:
            self._failed.add(topic)
            self._report(topic, reason)

    def _report(self, topic: str, reason: str) -> None:
        if self._listener is not None and not self._closed.is_set() and topic in self._wanted:
            self._listener.on_trouble(topic, reason)

    def _wake_session(self) -> None:
        self._woken = True
        self._changed.notify_all()

    def _look_soon(self) -> None:
        with self._lock:
            self._wake_session()

    def _run_sessions(self, listener: Listener) -> None:
        super()._run_sessions(listener)
        for subscription in self._subscriptions.values():
            subscription.subscriber.unregister()
        self._subscriptions.clear()

    def _run_session(self, listener: Listener) -> str:
        """Poll the master until neither it nor a connection is left. Return the reason why the master is lost."""
        self._connected = False
        while not self._closed.is_set():
            reason = self._poll(listener)
            if not reason:
                until = self._clock.now() + POLL
                with self._lock:
                    while not self._woken and self._changed.wait_until(until):
                        pass
                    self._woken = False
            elif self._connected:
                self._pause(self._backoff.next_pause())
            else:
                return reason
        return ""

    def _poll(self, listener: Listener) -> str:
        """Follow the state of the master. Return the reason if that failed."""
        try:
            state = self._master.state()
            self._start_node()
            self._note_master("")
            if not self._connected:
                self._connected = True
                listener.on_connected()
            self._backoff.reset()
            self._step(state, listener)
        except MasterError as error:
            hint = "is roscore running, and ROS_MASTER_URI right?"
            reason = f"no ROS master at {self._master.uri} ({error}); {hint}"
            self._connected = self._note_master(reason) and self._connected
            return reason
        except Exception as error:  # an error of rospy, or any error because of a malformed answer of the master
            log.debug("%s was lost", self.where, exc_info=True)
            self._connected = False
            return f"the rospy node of this process cannot be used: {str(error) or type(error).__name__}"
        return ""

    def _note_master(self, reason: str) -> bool:
        """Report a lost master, or its return, on each topic. Return True if connections are left without it."""
        before, self._publications.master_lost = self._publications.master_lost, reason
        live = {topic for topic, subscription in self._subscriptions.items() if _is_live(subscription)}
        if before or reason:
            lost = f"master lost, trying again: {reason}" if reason else ""
            for topic in self._wanted:
                self._report(topic, DATA_COME if lost and topic in live else lost)
        return bool(live) or self._publications.connected

    def _start_node(self) -> None:
        if self._rospy.is_shutdown():
            raise self._rospy.ROSException(SHUT_DOWN)
        with _STARTING:
            if not self._connected:
                self._check_master()
            if not self._rospy.core.is_initialized():
                self._rospy.init_node(self._name, argv=[], anonymous=True, disable_signals=True)

    def _check_master(self) -> None:
        """Raise FeedError if the node of this process has another master, or would have."""
        node = self._rospy.get_node_uri()
        uri = master_of(node) if node else _uri_of_environment()
        if uri.rstrip("/") != self._master.uri.rstrip("/"):
            raise FeedError(
                f"rospy has the master {uri} in this process, and can have no other one: restart the kernel, and set "
                f"ROS_MASTER_URI to {self._master.uri} before anything else"
            )

    def _step(self, state: SystemState, listener: Listener) -> None:
        self._publications.state = state
        me = self._rospy.get_name()
        driven = [topic for topic, kind in state.types.items() if kind in _SPEEDS]
        self._presence.look({node for topic in driven for node in state.publishers.get(topic, ()) if node != me})
        listener.on_topics(self._adverts_of(state))
        for topic, subscription in list(self._subscriptions.items()):
            if topic not in self._wanted or state.types.get(topic, subscription.kind) != subscription.kind:
                del self._subscriptions[topic]
                subscription.subscriber.unregister()
        for topic in self._wanted:
            if topic in self._subscriptions:
                self._look_after(topic, state)
            elif topic in state.types:
                self._subscribe(topic, state.types[topic])
        self._publications.look_after()

    def _subscribe(self, topic: str, kind: str) -> None:
        import roslib.message

        # All subscribers of a process share one class and one queue for a topic. So the class is the one that the rest
        # of the program would use, and no option is set that would make the program miss messages.
        message_class = roslib.message.get_message_class(kind) or self._rospy.AnyMsg
        subscriber = self._rospy.Subscriber(
            topic, message_class, self._receive, callback_args=topic, buff_size=1 << 20, tcp_nodelay=True
        )
        self._subscriptions[topic] = _Subscription(subscriber, kind, time.monotonic())

    def _look_after(self, topic: str, state: SystemState) -> None:
        """Restore subscriptions that a restarted master or rospy dropped. Report missing connections to publishers."""
        subscription, me = self._subscriptions[topic], self._rospy.get_name()
        impl = subscription.subscriber.impl
        for connection in impl.connections:
            if connection.done:  # rospy keeps some refused connections, and then never connects to their node again
                impl.remove_connection(connection)
        nodes = [node for node in state.publishers.get(topic, ()) if node != me]
        forgotten = me not in state.subscribers.get(topic, ()) or topic in self._failed
        if impl.connections:
            self._subscriptions[topic] = subscription._replace(since=time.monotonic())
        elif nodes and time.monotonic() - subscription.since > CONNECT_TIMEOUT_S:
            reason = self._master.unreachable(nodes)
            if reason:
                self._report(topic, f"{topic} is published, but {reason}")
            forgotten = forgotten or not reason
        if forgotten:
            self._failed.discard(topic)
            self._master.register_subscriber(me, topic, subscription.kind, self._rospy.get_node_uri())

    def _adverts_of(self, state: SystemState) -> list[Advert]:
        me = self._rospy.get_name()
        adverts = []
        for topic in sorted({*state.publishers, *state.subscribers}):
            kind = state.types.get(topic, "")
            publishers, subscribers = (
                [node for node in there.get(topic, ()) if not node.startswith(f"/{MARK}")]
                for there in (state.publishers, state.subscribers)
            )
            publishers = [node for node in publishers if node not in self._presence.ended]
            if not publishers and not subscribers:
                continue
            offered = any(node != me or topic not in self._publications for node in publishers)
            wanted = any(node != me or topic not in self._subscriptions for node in subscribers)
            others = (tuple(sorted({*nodes} - {me})) for nodes in (publishers, subscribers))
            adverts.append(Advert(topic, kind.replace("/", "/msg/"), offered, wanted, *others))
        return adverts

    def _receive(self, message: Any, topic: str) -> None:
        if self._closed.is_set() or topic not in self._wanted or self._listener is None:
            return
        if isinstance(message, self._rospy.AnyMsg):
            from ..messages.decoding import DecodeError  # Imported lazily: a guard subscribes to nothing.

            try:
                message = self._decode(topic, message)
            except DecodeError as error:
                self._report(topic, f"{topic}: a message of it cannot be read: {error}")
                return
        self._report(topic, DATA_COME if self._publications.master_lost else "")
        self._listener.on_message(topic, message)

    def _decode(self, topic: str, message: Any) -> Any:
        from ..messages.decoding import decoder_of

        header = message._connection_header
        key = header["type"] + header["md5sum"]
        if key not in self._decoders:
            kind = header["type"].replace("/", "/msg/")
            channel = Channel(0, topic, kind, "ros1", header.get("message_definition", ""), 0)
            self._decoders[key] = decoder_of(channel)
        return self._decoders[key](message._buff)


def _uri_of_environment() -> str:
    """Return the URI of the master as rospy reads it, or empty without rospy."""
    try:
        import rosgraph
    except ImportError:
        return ""
    return str(rosgraph.get_master_uri())


def _is_live(subscription: _Subscription) -> bool:
    """Return True if a publisher is connected. While rospy only tries to connect, it knows no definition."""
    return any(c.md5sum and not c.done for c in subscription.subscriber.impl.connections)


class _RospyLog(logging.Handler):
    """A handler that reports errors that rospy only logs. The threads of its connections are named after the topics."""

    def __init__(self, feed: Ros1) -> None:
        super().__init__(logging.WARNING)
        self._feed = feed

    def emit(self, record: logging.LogRecord) -> None:
        from ..messages.decoding import one_line

        lines = record.getMessage().strip().splitlines() or [""]
        name, _, text = lines[-1].rpartition("Error: ")
        what = "a message of it cannot be read" if name.endswith("Deserialization") else "no connection to a publisher"
        if record.threadName:
            self._feed.failed(record.threadName, f"{record.threadName}: {what}: {one_line(Exception(text))}")


def ros1(name: str = "robowidgets") -> Feed:
    """Open a feed of ROS 1 through rospy. ROS_MASTER_URI names the master.

    Args:
        name: the name of the node, to which a number is added. If the program has called `rospy.init_node`, its node is
            used instead.

    Raises:
        FeedError: rospy cannot be imported, was shut down, or has another master in this process; the name or
            ROS_MASTER_URI is invalid.

    Examples:
        >>> from robowidgets import feeds
        >>> feed = feeds.ros1()  # doctest: +SKIP
    """
    from .feed import Feed  # a guard imports only the middleware

    return Feed(Ros1(name))
