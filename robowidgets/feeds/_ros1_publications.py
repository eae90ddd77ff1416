"""Publishing through rospy. The thread of a feed sets up publishers, and the publishing thread sends."""

from __future__ import annotations

import select
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import Any

from ._ros1_master import Master, SystemState
from ._twist import fill, is_zero
from .middleware import SEND_TIMEOUT, FeedError, NotConnectedYetError

SHUT_DOWN = "rospy was shut down in this process and cannot start again: restart the kernel"

UNREACHED = 2.0
"""Seconds after which a subscriber without a connection is asked to connect again. Each further pause is doubled."""

LONGEST = 30.0
"""The longest pause between two such requests, in seconds. Publisher and subscriber log each failed request."""

_publishers: dict[str, Any] = {}
"""The publishers of the only node of the process, by topic. They stay when a feed is closed.

A rospy subscriber that connects while its publisher is being unregistered may never connect to that node again: it
keeps the dead connection in its list, and makes no second connection to a node.
"""

_moving: set[str] = set()
"""The topics whose last message was not zero."""

_sending = threading.RLock()
"""Held while a message is sent. It is an RLock, because a signal handler may shut down rospy in the sending thread."""


class Publications:
    """The topics that one feed publishes.

    Args:
        on_unheard: called with the reason why a subscriber does not receive a topic. See `Listener`.
        wake: makes the thread of the feed call `look_after` soon.

    Attributes:
        state: the state that the master reported last.
        master_lost: the reason why the master does not answer, or empty while it answers.
    """

    def __init__(
        self, rospy: Any, master: Master, on_unheard: Callable[[str, str], None], wake: Callable[[], None]
    ) -> None:
        self._rospy, self._master, self._on_unheard, self._wake_feed = rospy, master, on_unheard, wake
        self._asked: dict[str, tuple[str, float]] = {}
        """By topic, the type that was published last, and the time of its first message."""
        self._due: dict[str, tuple[float, float]] = {}
        """By topic, the time of the next request to subscribers without a connection, and the pause before it."""
        self._unheard: dict[str, str] = {}
        self.state = SystemState({}, {}, {})
        self.master_lost = ""

    def __contains__(self, topic: str) -> bool:
        return topic in _publishers

    @property
    def connected(self) -> bool:
        """True while another node is connected to a topic that was published."""
        return any(map(self._connections, list(self._asked)))

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`. The first message of a topic waits until a subscriber has connected."""
        deadline = time.monotonic() + SEND_TIMEOUT
        kind = message_type.replace("/msg/", "/")
        filled, moves = fill(_class_of(kind)(), message), not is_zero(message)
        if self._asked.get(topic, ("",))[0] != kind:
            self._asked[topic] = kind, time.monotonic()
            self._wake_feed()
        while not self._connections(topic):
            if why := self._why_unconnected(topic):
                raise FeedError(f"cannot publish {kind} on {topic}: {why}")
            if time.monotonic() > self._asked[topic][1] + SEND_TIMEOUT:
                node = self._listening(topic)[0]
                raise NotConnectedYetError(
                    f"cannot publish {kind} on {topic}: {node} listens to it, but has not connected"
                )
            time.sleep(0.002)
        with _sending:
            if self._rospy.core.is_shutdown_requested():
                raise FeedError(SHUT_DOWN)
            connections = self._connections(topic)
            there = _publishers[topic].impl.type if connections else kind
            if there != kind:
                raise FeedError(f"cannot publish {kind} on {topic}: it is already published as {there}")
            if moves:
                _moving.add(topic)
            try:
                _send(topic, filled, connections, deadline, to_all=not moves)
            except self._rospy.ROSException as error:
                raise FeedError(f"cannot publish {kind} on {topic}: {error}") from None
            if not moves:
                _moving.discard(topic)

    def look_after(self) -> None:
        """Set up publishers for topics with subscribers, and ask subscribers to connect, in the thread of the feed.

        A topic gets a publisher only once it has a subscriber, because the first publisher settles the type of a topic,
        and before that the type that the robot expects is unknown.
        """
        for topic, (kind, _) in list(self._asked.items()):
            publisher = _publishers.get(topic)
            if publisher is not None and publisher.impl.type != kind:
                with _sending:
                    unused = not self._connections(topic)
                    if unused:
                        del _publishers[topic]
                if unused:
                    publisher.unregister()
            if topic in self:
                self._ask_to_connect(topic, kind)
            elif self._listening(topic) and self.state.types.get(topic, kind) == kind:
                if not _publishers:
                    self._rospy.on_shutdown(_send_zeros)
                _publishers[topic] = self._rospy.Publisher(topic, _class_of(kind), queue_size=1)

    def _connections(self, topic: str) -> list[Any]:
        """Return the connections to other nodes. It removes dead ones, which rospy does only every half second."""
        publisher = _publishers.get(topic)
        if publisher is None:
            return []
        publisher.impl.check()
        return [c for c in _transports(publisher.impl) if c.endpoint_id != self._rospy.get_name()]

    def _listening(self, topic: str) -> list[str]:
        return [node for node in self.state.subscribers.get(topic, ()) if node != self._rospy.get_name()]

    def _why_unconnected(self, topic: str) -> str:
        """Return the reason why no subscriber is connected, or empty while a subscriber may be connecting."""
        kind, _ = self._asked[topic]
        there = self.state.types.get(topic, kind)
        if self._rospy.core.is_shutdown_requested():
            return SHUT_DOWN
        if self.master_lost:
            return f"no subscriber is connected, and there is {self.master_lost}"
        if not self._listening(topic):
            return "it has no subscriber"
        if there != kind and topic not in self:
            return f"its type is {there}"
        return ""

    def _ask_to_connect(self, topic: str, kind: str) -> None:
        """Register the publisher again if a subscriber is not connected: the master then notifies all subscribers."""
        me, now, reason = self._rospy.get_name(), time.monotonic(), ""
        connections = self._connections(topic)
        reached = {connection.endpoint_id for connection in connections if _takes(connection)}
        missing = [node for node in self._listening(topic) if node not in reached]
        due, pause = self._due.setdefault(topic, (now + UNREACHED, UNREACHED))
        if not missing:
            del self._due[topic]
        elif now < due:
            reason = self._unheard.get(topic, "")
        else:
            self._due[topic] = now + 2 * pause, min(2 * pause, LONGEST)
            reason = self._why_unheard(topic, missing, {connection.endpoint_id for connection in connections})
        if me not in self.state.publishers.get(topic, ()) or (missing and now >= due):  # a restarted master forgot it
            self._master.register_publisher(me, topic, kind, self._rospy.get_node_uri())
        self._unheard[topic] = reason
        self._on_unheard(topic, reason)

    def _why_unheard(self, topic: str, missing: list[str], connected: set[str]) -> str:
        for node in missing:
            if node in connected:
                return f"{node} does not read {topic}"
            why = self._master.unreachable([node])
            if not why:
                return f"{node} listens to {topic}, but does not connect; it is asked again"
            if not connected:  # a node that has ended does not matter while a robot is connected
                return f"{topic} has a subscriber, but {why}"
        return ""


def _send(topic: str, message: Any, connections: Sequence[Any], deadline: float, *, to_all: bool) -> None:
    """Write to each socket in this thread, because a busy cell may block the thread of rospy for long.

    A node that does not read delays no other node. A speed counts as sent if one node has it, a zero only if all have.
    """
    impl, late, taken = _publishers[topic].impl, list(connections), 0
    while True:
        for connection in filter(_takes, list(late)):
            late.remove(connection)
            before = connection.stat_num_msg
            with impl.publock:
                impl.publish(message, connection_override=connection)
            taken += connection.stat_num_msg - before
        if not late and not taken:
            raise FeedError(f"{topic} was not published: its subscriber has just disconnected")
        if not late or (taken and not to_all):
            return
        if time.monotonic() > deadline:
            raise FeedError(f"{late[0].endpoint_id} took no message of {topic} for {SEND_TIMEOUT:g} s")
        time.sleep(0.002)


def _takes(connection: Any) -> bool:
    """Return True if a socket accepts a message of the size of a speed without blocking, or has ended."""
    poll = select.poll()
    poll.register(connection.fileno(), select.POLLOUT)
    return connection.done or bool(poll.poll(0))


def _transports(impl: Any) -> list[Any]:
    """Return the connections of a publisher, without the queues of rospy, which another thread empties."""
    return [getattr(connection, "_connection", connection) for connection in impl.connections]


def _send_zeros() -> None:
    """Send zero on the topics whose robots move. rospy calls it before it shuts down, for example after Ctrl-C."""
    with _sending:
        for topic in list(_moving):
            publisher, deadline = _publishers[topic], time.monotonic() + SEND_TIMEOUT
            with suppress(Exception):  # the other robots must be stopped, too
                _send(topic, publisher.data_class(), _transports(publisher.impl), deadline, to_all=True)


def _class_of(kind: str) -> Any:
    import roslib.message

    message_class = roslib.message.get_message_class(kind)
    if message_class is None:
        package = kind.split("/")[0]
        raise FeedError(
            f"cannot publish {kind}: the Python package {package} is not installed; on Debian or Ubuntu it is "
            f"python3-{package.replace('_', '-')}"
        )
    return message_class
