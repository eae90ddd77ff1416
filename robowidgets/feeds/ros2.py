"""ROS 2, by rclpy."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections.abc import Mapping
from typing import Any

from ._ros2_messages import fill, message_class
from ._ros2_session import Session, one_line
from ._takes_part import TakesPart, checked_domain
from .feed import Feed
from .middleware import SEND_TIMEOUT, FeedError, Listener

log = logging.getLogger("robowidgets")

LOOK = 1.0
"""Seconds between two looks at the topics."""

EARLY_LOOK = 0.2
"""The same while a session is young, as the robot's topics become known one after another then."""


class Ros2(TakesPart):
    """A `Middleware` on a node of its own, in a context of its own: no program spins it or shuts it down.

    A thread looks at the topics and hands on messages; what is published is published by the thread that asks for it.

    Raises:
        TypeError, ValueError: no node, no domain, or both at once.
        FeedError: the context of the node was shut down.
    """

    def __init__(self, node: Any = None, *, domain_id: int | None = None) -> None:
        if node is not None and not hasattr(node, "create_subscription"):
            raise TypeError(f"node: expected a node of rclpy, got {node!r}")
        if domain_id is not None:
            checked_domain("domain_id", domain_id)
        if node is not None and domain_id is not None:
            raise TypeError("domain_id: a node has its domain already; give a node or a domain_id, not both")
        super().__init__()
        self._domain_id = domain_id if node is None else _domain_of(node)
        self._changed = threading.Condition(self._lock)
        self._session: Session | None = None
        self._down = ""
        """Why no session is about to come, until the next attempt."""
        self._matched: set[tuple[str, str]] = set()

    @property
    def where(self) -> str:
        """See `Middleware`."""
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
        self._start("robowidgets-ros2", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        until = time.monotonic() + SEND_TIMEOUT
        filled = _filled(topic, message_type, message)
        while True:
            session = self._await_session(until)
            try:
                return session.publish(topic, message_type, filled, until)
            except FeedError:
                raise
            except Exception as error:  # rclpy has a class of its own for each reason
                if session.ok():
                    raise FeedError(f"cannot publish on {topic!r}: {one_line(error)}") from None

    def _await_session(self, until: float) -> Session:
        """The session, or the one that comes in its place when rclpy's signal handler has shut it down."""
        with self._changed:
            while True:
                if self._backoff.closed or self._down:
                    raise FeedError(self._down or f"{self.where} is closed")
                if self._session is not None:
                    if self._session.ok():
                        return self._session
                    self._session.wake()
                if not self._changed.wait(until - time.monotonic()):
                    raise FeedError(f"{self.where} is not connected yet")

    def _wake(self) -> None:
        self._changed.notify_all()
        if self._session is not None:
            self._session.wake()

    def _take_part(self, listener: Listener) -> str:
        try:
            self._set_session(None)
            shut_down = False
            while not self._backoff.closed:
                self._have_session(listener, shut_down)
                shut_down = True
        except Exception as error:  # rclpy has a class of its own for each reason
            log.debug("%s was lost", self.where, exc_info=True)
            self._set_session(None, down=f"{self.where} cannot be used: {one_line(error)}")
        return self._down

    def _have_session(self, listener: Listener, one_was_shut_down: bool) -> None:
        """Use a session until it is closed, or until an interrupt shut it down: the next one begins at once then."""
        session = Session(self._domain_id, listener, self._is_wanted, self._matched)
        try:
            self._attend(session, listener, one_was_shut_down)
        except Exception:
            if session.ok() or self._session is None:
                raise
        finally:
            self._set_session(None)
            session.close()

    def _attend(self, session: Session, listener: Listener, one_was_shut_down: bool) -> None:
        told = session.look()
        self._set_session(session)  # before anything is told: a zero may wait for it
        if one_was_shut_down:
            listener.on_lost(f"{self.where} cannot be used: rclpy was shut down", 0.0)
        listener.on_connected()
        self._backoff.worked()
        listener.on_topics(told)
        due = 0.0
        followed: set[str] = set()
        while not self._backoff.closed and session.ok():
            with self._lock:
                wanted = set(self._wanted)
            if wanted != followed or time.monotonic() >= due:
                followed, due = wanted, time.monotonic() + (EARLY_LOOK if session.is_young else LOOK)
                adverts = session.look()
                if adverts != told:
                    told = adverts
                    listener.on_topics(adverts)
                session.follow(wanted)
            session.spin_once(max(0.0, due - time.monotonic()))

    def _set_session(self, session: Session | None, down: str = "") -> None:
        with self._changed:
            self._session, self._down = session, down
            self._changed.notify_all()

    def _is_wanted(self, topic: str) -> bool:
        with self._lock:
            return topic in self._wanted and not self._backoff.closed


def _domain_of(node: Any) -> int:
    try:
        return int(node.context.get_domain_id())
    except Exception:  # a class of rclpy's, which need not be installed
        raise FeedError(
            "node: its domain is not known any more, as rclpy was shut down; give a new node, or a domain_id"
        ) from None


def _filled(topic: str, message_type: str, message: Mapping[str, Any]) -> Any:
    """A message of rclpy; FeedError where it cannot be published."""
    from rclpy.exceptions import NameValidationException
    from rclpy.validate_topic_name import validate_topic_name

    try:
        validate_topic_name(topic)
    except NameValidationException as error:
        raise FeedError(f"cannot publish on {topic!r}: {one_line(error)}") from None
    try:
        filled = message_class(message_type)()
    except LookupError as error:
        raise FeedError(f"{message_type} cannot be published: {error}") from None
    fill(filled, message)
    return filled


def ros2(node: Any = None, *, domain_id: int | None = None) -> Feed:
    """A feed from ROS 2, by rclpy, on a node of its own.

    Args:
        node: a node of the program's, whose domain is used. The node itself is not: the program spins it or not.
        domain_id: the domain; by default what ``ROS_DOMAIN_ID`` says.

    Raises:
        TypeError, ValueError: no node, no domain, or both at once.
        FeedError: rclpy cannot be imported, or was shut down for this node.
    """
    return Feed(Ros2(node, domain_id=domain_id))
