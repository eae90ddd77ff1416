"""ROS 2, by rclpy."""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Mapping
from typing import Any

from ._ros2_messages import fill, message_class
from ._ros2_node import NodeTools
from ._ros2_spin import Held, own_node
from ._takes_part import TakesPart, checked_domain
from .feed import Feed
from .middleware import Advert, FeedError, Listener

log = logging.getLogger("robowidgets")

POLL = 1.0
"""Seconds between two looks at the topics."""

_MATCHING = 0.2
_PAUSE = 0.01  # after an error of a callback that may come at any rate


class Ros2(TakesPart):
    """A `Middleware` on a node of rclpy: the program's own, or one of ours with its own context.

    A thread of ours looks at the topics and publishes. It also spins the node whenever nobody else does; where the
    program spins its own node, messages come from there.

    Raises:
        TypeError, ValueError: no node, no domain, or both at once.
        FeedError: the node was destroyed.
    """

    def __init__(self, node: Any = None, *, domain_id: int | None = None) -> None:
        if node is not None and not hasattr(node, "create_subscription"):
            raise TypeError(f"node: expected a node of rclpy, got {node!r}")
        if domain_id is not None:
            checked_domain("domain_id", domain_id)
        if node is not None and domain_id is not None:
            raise TypeError("domain_id: a node has its domain already; give a node or a domain_id, not both")
        super().__init__()
        self._node, self._domain_id = node, domain_id
        self._name = _name(node)
        self._out: dict[tuple[str, str], Any] = {}
        self._executor: Any = None
        self._troubles: dict[str, str] = {}

    @property
    def where(self) -> str:
        """See `Middleware`."""
        if self._name:
            return f"ROS 2, node {self._name}"
        domain = self._domain_id if self._domain_id is not None else os.environ.get("ROS_DOMAIN_ID") or 0
        return f"ROS 2, domain {domain}"

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        try:
            import rclpy  # noqa: F401
            import rosidl_runtime_py.utilities  # noqa: F401
        except ImportError as error:
            raise FeedError(
                f"rclpy cannot be imported here ({error}): start Jupyter where `source /opt/ros/<distro>/setup.bash` "
                "was run, with the Python of that ROS; feeds.dds() needs no ROS"
            ) from None
        self._listener = listener
        self._start("robowidgets-ros2", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        from rclpy.exceptions import NameValidationException
        from rclpy.validate_topic_name import validate_topic_name

        try:
            validate_topic_name(topic)
        except NameValidationException as error:
            raise FeedError(f"cannot publish on {topic!r}: {' '.join(str(error).split())}") from None
        try:
            filled = message_class(message_type)()
        except LookupError as error:
            raise FeedError(f"{message_type} cannot be published: {error}") from None
        fill(filled, message)
        with self._lock:
            if self._executor is not None:
                self._out[topic, message_type] = filled
            self._wake()

    def _wake(self) -> None:
        if self._executor is not None:
            self._executor.wake()

    def _take_part(self, listener: Listener) -> str:
        from rclpy.executors import ExternalShutdownException

        try:
            with own_node(self._domain_id) if self._node is None else Held(self._node) as held:
                self._attend(held, listener)
        except ExternalShutdownException:
            return f"{self.where} cannot be used: rclpy was shut down"
        except Exception as error:  # rclpy raises a class of its own for each thing that was shut down or destroyed
            log.debug("%s was lost", self.where, exc_info=True)
            return f"{self.where} cannot be used: {' '.join(str(error).split()) or type(error).__name__}"
        return ""

    def _attend(self, held: Held, listener: Listener) -> None:
        tools = NodeTools(held.node, self._hand_on, self._trouble)
        told = tools.look()
        with self._lock:
            self._executor = held.executor
        try:
            listener.on_connected()
            self._again.worked()
            listener.on_topics(told)
            self._loop(held, tools, told)
            self._send(tools)
            tools.flush()
        finally:
            with self._lock:
                self._executor = None
                self._out.clear()
            tools.close()

    def _loop(self, held: Held, tools: NodeTools, told: list[Advert]) -> None:
        due = 0.0
        followed: set[str] = set()
        while not self._again.closed:
            self._send(tools)
            with self._lock:
                wanted = set(self._wanted)
                for topic in followed - wanted:
                    self._troubles.pop(topic, None)
            if wanted != followed or time.monotonic() >= due:
                followed, due = wanted, time.monotonic() + POLL
                adverts = tools.look()
                if adverts != told:
                    told = adverts
                    self._listener.on_topics(adverts)
                tools.follow(wanted)
            error = held.spin_once(max(0.0, due - time.monotonic()))
            if error is not None and not tools.blame(error):
                if self._node is None:
                    raise error
                log.error("a callback of the node %s raised", self._name, exc_info=error)
                self._again.wait(_PAUSE)

    def _send(self, tools: NodeTools) -> None:
        with self._lock:
            out, self._out = self._out, {}
        for (topic, message_type), message in out.items():
            tools.publisher(topic, message_type, _MATCHING).publish(message)

    def _hand_on(self, topic: str, message: Any) -> None:
        with self._lock:
            if self._again.closed or topic not in self._wanted:
                return
        self._trouble(topic, "")
        self._listener.on_message(topic, message)

    def _trouble(self, topic: str, words: str) -> None:
        with self._lock:
            if self._troubles.get(topic, "") == words:
                return
            self._troubles[topic] = words
        self._listener.on_trouble(topic, words)


def _name(node: Any) -> str:
    """The name of a node, as long as it can tell it; empty where there is none."""
    if node is None:
        return ""
    try:
        return str(node.get_name())
    except Exception as error:  # a class of rclpy's, which need not be installed
        raise FeedError(f"node: it cannot be used, was it destroyed? {error}") from None


def ros2(node: Any = None, *, domain_id: int | None = None) -> Feed:
    """A feed from ROS 2, by rclpy.

    Args:
        node: the program's own node, which may be spun by the program, or not; by default one of ours.
        domain_id: the domain of our own node; by default what ``ROS_DOMAIN_ID`` says.

    Raises:
        TypeError, ValueError: no node, no domain, or both at once.
        FeedError: rclpy cannot be imported, or the node was destroyed.
    """
    return Feed(Ros2(node, domain_id=domain_id))
