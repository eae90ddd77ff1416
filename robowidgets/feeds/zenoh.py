"""Robots with ROS 2 over Zenoh (rmw_zenoh), without an installation of ROS."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..messages.twist import encode_twist
from ..notebook import in_browser
from ..runtime.clock import Clock
from ._guard.mark import MARK
from ._ros2_common import checked_domain
from ._threaded import ThreadedMiddleware
from ._twist import is_zero
from .middleware import FeedError, Listener, Outlet

if TYPE_CHECKING:
    from ._zenoh_session import ZenohSession
    from .feed import Feed

PORT = 7447
"""The port of the router of a robot, unless its configuration says otherwise."""

_TURN = 0.01
"""Seconds for which every message of one topic is passed on before other topics get their turn."""

_HOST = re.compile(r"([\w.-]+|\[[\da-fA-F:]+\])(:\d+)?")
_LOCATOR = re.compile(r"(tcp|tls|udp|quic|ws)/([\w.-]+|\[[\da-fA-F:]+\]):\d+")


class Zenoh(ThreadedMiddleware):
    """A `Middleware` that is a client of the Zenoh router of a robot.

    A thread passes messages on; `publish` writes in the thread that calls it.

    Args:
        locator, domain: see `zenoh`.
        mark: for a guard, the name of its node.
        clock: the clock of its waits, except for waits in Zenoh.

    Raises:
        TypeError, ValueError: the locator is not an address, or the domain does not exist.
    """

    def __init__(self, locator: str, domain: int = 0, *, mark: str = "", clock: Clock | None = None) -> None:
        super().__init__(clock)
        self._locator, self._domain = checked_locator(locator), checked_domain("domain", domain)
        self._mark = mark
        self._session: ZenohSession | None = None

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return f"Zenoh at {self._locator}" + (f", domain {self._domain}" if self._domain else "")

    @property
    def outlet(self) -> Outlet:
        """See `HasOutlet`."""
        return Outlet("zenoh", {"locator": self._locator, "domain": self._domain, "mark": MARK})

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        if why := in_browser.no_robot("feeds.zenoh"):
            raise FeedError(why)
        try:
            import zenoh  # noqa: F401
        except ImportError as error:
            raise FeedError(f"feeds.zenoh needs eclipse-zenoh: pip install 'robowidgets[zenoh]' ({error})") from None
        self._start_thread("robowidgets-zenoh", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        raw = encode_twist("cdr", message_type, message)
        with self._lock:
            session = self._session
        if session is None:
            raise FeedError(f"{self.where} is not connected")
        session.publish(topic, message_type, raw, is_zero=is_zero(message))

    def _wake_session(self) -> None:
        if self._session is not None:
            self._session.wake()

    def _run_session(self, listener: Listener) -> str:
        from zenoh import ZError

        from ._zenoh_session import ZenohSession

        try:
            session = ZenohSession(self._locator, self._domain, listener, self._no_robot(), self._clock, self._mark)
        except ZError:
            return (
                f"no Zenoh router answers at {self._locator}. Is the robot on, and in this network? Does its router "
                "run (ros2 run rmw_zenoh_cpp rmw_zenohd)? Does a firewall block the port?"
            )
        reason = ""
        try:
            with self._lock:
                self._session = session
            listener.on_connected()
            self._backoff.reset()
            while not self._closed.is_set() and not reason:
                reason = self._step(session)
        finally:
            with self._lock:
                self._session = None
            session.close()
        return reason

    def _step(self, session: ZenohSession) -> str:
        """Pass on what has come, and wait for more. Return the reason why the router is lost, or empty."""
        if reason := session.look():
            return reason
        session.follow(self._wanted, self._each)
        passed = False
        for wish in session.wishes:
            until = self._clock.now() + _TURN
            while wish.topic in self._wanted and not self._closed.is_set() and session.pass_on(wish):
                passed = True
                if not wish.each or self._clock.now() >= until:
                    break
        if not passed and not self._closed.is_set():
            session.wait()
        return ""

    def _no_robot(self) -> str:
        return (
            f"the Zenoh router at {self._locator} answers, but no node of ROS 2 is in domain {self._domain}. "
            f"Is {self._domain} the robot's ROS_DOMAIN_ID? Do its nodes run with RMW_IMPLEMENTATION=rmw_zenoh_cpp?"
        )


def checked_locator(locator: object) -> str:
    """Return the address of a router as Zenoh writes it. Raise TypeError or ValueError if it is none."""
    expected = "locator: expected the address of the robot's Zenoh router, such as 'tcp/robot:7447' or 'robot'"
    if not isinstance(locator, str):
        raise TypeError(f"{expected}, got {locator!r}")
    if found := _HOST.fullmatch(locator):
        return f"tcp/{found[1]}{found[2] or f':{PORT}'}"
    if not _LOCATOR.fullmatch(locator):
        raise ValueError(f"{expected}, got {locator!r}")
    return locator


def zenoh(locator: str = "tcp/127.0.0.1:7447", domain: int = 0) -> Feed:
    """Open a feed of ROS 2 over Zenoh, for robots that use ``rmw_zenoh``. ROS need not be installed.

    It is a client of the robot's router, which every robot with ``rmw_zenoh`` runs, and opens no port.

    Args:
        locator: the address of the router, such as ``"tcp/robot:7447"``, or only the name of the robot.
        domain: the robot's ``ROS_DOMAIN_ID``, 0 to 232.

    Raises:
        TypeError, ValueError: the locator is not an address, or the domain does not exist.
        FeedError: eclipse-zenoh is not installed.

    Source: https://github.com/ros2/rmw_zenoh/blob/rolling/docs/design.md
    """
    from .feed import Feed  # a guard imports only the middleware

    return Feed(Zenoh(locator, domain))
