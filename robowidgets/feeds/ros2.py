"""ROS 2, through rclpy."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ..notebook import in_browser
from ..runtime.clock import Clock
from ._guard.mark import MARK
from ._ros2_common import ALONE, checked_domain, domain_of_environment, is_alone, no_robot
from ._ros2_session import Ros2Session, one_line
from ._threaded import ThreadedMiddleware
from .middleware import SEND_TIMEOUT, Advert, FeedError, Listener, Outlet

if TYPE_CHECKING:
    from .feed import Feed

log = logging.getLogger("robowidgets")

LOOK = 1.0
"""Seconds between two queries of the topics."""

EARLY_LOOK = 0.2
"""Seconds between two queries in a new session, while the robot's topics are discovered one after another."""

_RMW = "Do both sides have the same RMW_IMPLEMENTATION?"
_RANGE = "Does one have ROS_LOCALHOST_ONLY or ROS_AUTOMATIC_DISCOVERY_RANGE set?"


class Ros2(ThreadedMiddleware):
    """A `Middleware` on a separate node and context, which no program spins or shuts down.

    A thread queries the topics and passes on messages; `publish` publishes in the thread that calls it.

    Args:
        node, domain_id: see `ros2`.
        name: the name of its node, or empty for a generated name.
        clock: the clock of its waits, except for waits in rclpy.

    Raises:
        TypeError, ValueError: the node or the domain (possibly from the environment) is invalid, or both are given.
        FeedError: the context of the node was shut down.
    """

    def __init__(
        self, node: Any = None, *, domain_id: int | None = None, name: str = "", clock: Clock | None = None
    ) -> None:
        if node is not None and not hasattr(node, "create_subscription"):
            raise TypeError(f"node: expected a node of rclpy, got {node!r}")
        if domain_id is not None:
            checked_domain("domain_id", domain_id)
        if node is not None and domain_id is not None:
            raise TypeError("domain_id: a node has its domain already; give a node or a domain_id, not both")
        super().__init__(clock)
        # Read only once, here, so that a session or guard that starts later reaches the same robot.
        if domain_id is None:
            domain_id = domain_of_environment() if node is None else _domain_of(node)
        self._domain_id = domain_id
        self._name = name
        self._session: Ros2Session | None = None
        self._down = ""
        """The reason why no session runs until the next attempt, or empty."""
        self._matched: set[tuple[str, str]] = set()
        self._is_alone = True
        """True until a robot is discovered."""

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return f"ROS 2, domain {self._domain_id}"

    @property
    def outlet(self) -> Outlet:
        """See `HasOutlet`."""
        return Outlet("ros2", {"domain_id": self._domain_id, "name": MARK})

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        if why := in_browser.no_robot("feeds.ros2"):
            raise FeedError(why)
        try:
            import rclpy  # noqa: F401
            import rosidl_runtime_py.utilities  # noqa: F401
        except ImportError as error:
            raise FeedError(
                f"rclpy cannot be imported here ({error}): start Jupyter where `source /opt/ros/<distro>/setup.bash` "
                "was run, with the Python of that ROS; feeds.dds() needs no ROS"
            ) from None
        self._start_thread("robowidgets-ros2", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        until = self._clock.now() + SEND_TIMEOUT
        while True:
            session = self._await_session(until)
            try:
                return session.publish(topic, message_type, message, until)
            except (FeedError, TimeoutError):
                raise
            except Exception as error:  # the class depends on the reason
                if session.ok():
                    raise FeedError(f"cannot publish on {topic!r}: {one_line(error)}") from None

    def _await_session(self, until: float) -> Ros2Session:
        """Return the session, or the next one if rclpy's signal handler has shut it down."""
        with self._lock:
            while True:
                if self._closed.is_set() or self._down:
                    raise FeedError(self._down or f"{self.where} is closed")
                if self._session is not None:
                    if self._session.ok():
                        return self._session
                    self._session.wake()
                if not self._changed.wait_until(until):
                    raise FeedError(f"{self.where} is not connected yet")

    def _wake_session(self) -> None:
        self._changed.notify_all()
        if self._session is not None:
            self._session.wake()

    def _run_session(self, listener: Listener) -> str:
        try:
            self._set_session(None)
            shut_down = False
            while not self._closed.is_set():
                self._use_session(listener, shut_down)
                shut_down = True
        except Exception as error:  # the class depends on the reason
            log.debug("%s was lost", self.where, exc_info=True)
            self._set_session(None, down=f"{self.where} cannot be used: {one_line(error)}")
        return self._down

    def _use_session(self, listener: Listener, one_was_shut_down: bool) -> None:
        """Run one session until it is closed or an interrupt shuts it down. The next one then begins at once."""
        session = Ros2Session(self._domain_id, listener, self._is_wanted, self._matched, self._clock, self._name)
        try:
            self._spin(session, listener, one_was_shut_down)
        except Exception:
            if session.ok() or self._session is None:
                raise
        finally:
            self._set_session(None)
            session.close()

    def _spin(self, session: Ros2Session, listener: Listener, one_was_shut_down: bool) -> None:
        adverts = session.look()
        self._set_session(session)  # before any report: a zero may wait for it
        if one_was_shut_down:
            listener.on_lost(f"{self.where} cannot be used: rclpy was shut down", 0.0)
        listener.on_connected()
        self._backoff.reset()
        self._report(session, adverts, listener)
        due = 0.0
        followed: tuple[frozenset[str], frozenset[str]] = frozenset(), frozenset()
        while not self._closed.is_set() and session.ok():
            wanted = self._wanted, self._each
            if wanted != followed or self._clock.now() >= due:
                followed, due = wanted, self._clock.now() + (EARLY_LOOK if session.is_young else LOOK)
                self._report(session, session.look(), listener)
                session.follow(*wanted)
            session.spin_once(max(0.0, due - self._clock.now()))

    def _report(self, session: Ros2Session, adverts: Sequence[Advert], listener: Listener) -> None:
        """Report the topics. Report an empty list only after there was time to discover some."""
        if not is_alone(adverts):
            if self._is_alone:
                listener.on_nobody("")
            self._is_alone = False
        elif self._is_alone:
            if session.age < ALONE:
                return
            listener.on_nobody(no_robot(self._domain_id, _RMW, _RANGE))
        listener.on_topics(adverts)

    def _set_session(self, session: Ros2Session | None, down: str = "") -> None:
        with self._lock:
            self._session, self._down = session, down
            self._changed.notify_all()

    def _is_wanted(self, topic: str) -> bool:
        return topic in self._wanted and not self._closed.is_set()


def _domain_of(node: Any) -> int:
    try:
        return int(node.context.get_domain_id())
    except Exception:  # a class of rclpy, which need not be installed
        raise FeedError(
            "node: its domain is not known any more, as rclpy was shut down; give a new node, or a domain_id"
        ) from None


def ros2(node: Any = None, *, domain_id: int | None = None) -> Feed:
    """Open a feed of ROS 2 through rclpy, on a separate node.

    Args:
        node: a node of the program. Only its domain is used, so it need not be spun.
        domain_id: the domain. The default is the current value of ``ROS_DOMAIN_ID``.

    Raises:
        TypeError, ValueError: the node or the domain (possibly from ``ROS_DOMAIN_ID``) is invalid, or both are given.
        FeedError: rclpy cannot be imported, or was shut down for this node.
    """
    from .feed import Feed  # a guard imports only the middleware

    return Feed(Ros2(node, domain_id=domain_id))
