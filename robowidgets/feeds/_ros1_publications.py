"""What a feed publishes by rospy: asked for by any thread, set up by the feed's own."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from ._ros1_master import Master, State
from .middleware import FeedError

LATE = 0.5
"""Seconds for which a message that sets something in motion may be sent to those who have just begun to listen."""


class Publications:
    """The topics that we publish, by name.

    rospy takes a moment to find those who listen to a new one, and forgets what is published until then. So the newest
    message goes to those who come soon after it; one in which every number is 0, as it stops a robot, also much later,
    if nobody has heard it yet.

    Args:
        stir: lets the feed's thread call `look_after` soon.
    """

    def __init__(self, rospy: Any, master: Master, stir: Callable[[], object]) -> None:
        self._rospy, self._master, self._stir = rospy, master, stir
        self._lock = threading.Lock()
        self._by_topic: dict[str, _Publication] = {}
        self._sent_at = 0.0
        self._closed = False

    def __contains__(self, topic: str) -> bool:
        return topic in self._by_topic

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """Publish a message; see `Ros1.publish`."""
        kind = message_type.replace("/msg/", "/")
        with self._lock:
            if self._closed:
                return
            publication = self._by_topic.get(topic)
            if publication is None or (publication.kind != kind and publication.publisher is None):
                publication = _Publication(kind)
            elif publication.kind != kind:
                raise FeedError(f"cannot publish {kind} on {topic}: {publication.kind} is published there already")
            publication.take(message)
            self._by_topic[topic] = publication
            self._send(publication)
        if publication.publisher is None:
            self._stir()

    def look_after(self, state: State) -> None:
        """Set up what somebody listens to, and tell a restarted master again what it forgot. In the feed's thread.

        Not before: the first publisher would settle the type of the topic, and which one the robot wants is not known.
        """
        me = self._rospy.get_name()
        for topic, publication in list(self._by_topic.items()):
            if publication.publisher is not None:
                if me not in state.publishers.get(topic, ()):
                    self._master.register_publisher(me, topic, publication.kind, self._rospy.get_node_uri())
            elif state.subscribers.get(topic) and state.types.get(topic, publication.kind) == publication.kind:
                self._set_up(topic, publication)

    def close(self) -> None:
        """End them all, once the last message is out. In the feed's thread."""
        with self._lock:
            self._closed = True
        # rospy writes in a thread of its own, and forgets what is not out yet: it may be a zero.
        time.sleep(max(0.0, 0.1 - (time.monotonic() - self._sent_at)))
        for publication in self._by_topic.values():
            if publication.publisher is not None:
                publication.publisher.unregister()
        self._by_topic.clear()

    def _set_up(self, topic: str, publication: _Publication) -> None:
        publisher = self._rospy.Publisher(
            topic,
            publication.message_class,
            subscriber_listener=_Listener(partial(self._someone_came, topic)),
            queue_size=1,
        )
        with self._lock:
            current = self._by_topic.get(topic) is publication
            if current:
                publication.publisher = publisher
        if current:
            self._someone_came(topic)  # before rospy knew the listener
        else:  # meanwhile another type was asked for
            publisher.unregister()

    def _someone_came(self, topic: str) -> None:
        with self._lock:
            publication = self._by_topic.get(topic)
            if publication is not None and not self._closed and publication.may_be_sent_again():
                self._send(publication)

    def _send(self, publication: _Publication) -> None:
        if publication.publisher is not None and publication.publisher.get_num_connections():
            publication.publisher.publish(publication.newest)
            publication.heard = True
            self._sent_at = time.monotonic()


class _Publication:
    def __init__(self, kind: str) -> None:
        import roslib.message

        self.kind = kind
        self.message_class = roslib.message.get_message_class(kind)
        if self.message_class is None:
            package = kind.split("/")[0]
            raise FeedError(
                f"cannot publish {kind}: the Python package {package} is not installed; on Debian or Ubuntu it is "
                f"python3-{package.replace('_', '-')}"
            )
        self.publisher: Any = None
        self.newest: Any = None
        self.heard = self._moves = False
        self._at = 0.0

    def take(self, message: Mapping[str, Any]) -> None:
        self.newest = _filled(self.message_class(), message)
        self.heard, self._moves, self._at = False, _moves(message), time.monotonic()

    def may_be_sent_again(self) -> bool:
        return time.monotonic() - self._at <= LATE or not (self._moves or self.heard)


class _Listener:
    """Told by rospy who comes and goes; a `rospy.SubscribeListener`."""

    def __init__(self, on_come: Callable[[], None]) -> None:
        self._on_come = on_come

    def peer_subscribe(self, _topic: str, _publish: Any, _publish_to_peer: Any) -> None:
        self._on_come()

    def peer_unsubscribe(self, _topic: str, _left: int) -> None:
        pass


def _moves(value: Any) -> bool:
    """Whether anything in it is not 0, but for text."""
    if isinstance(value, Mapping):
        return any(map(_moves, value.values()))
    return not isinstance(value, str) and value != 0


def _filled(message: Any, values: Mapping[str, Any]) -> Any:
    """The message with these values in its fields; a stamp may come as ROS 2 writes it."""
    names = {"sec": "secs", "nanosec": "nsecs"}
    for key, value in values.items():
        name = key if hasattr(message, key) else names.get(key, key)
        if isinstance(value, Mapping):
            _filled(getattr(message, name), value)
        else:
            setattr(message, name, value)
    return message
