"""Robots with ROS 2 over Zenoh (rmw_zenoh), without an installation of ROS."""

from __future__ import annotations

import re
import socket
from typing import TYPE_CHECKING

from ..notebook import in_browser
from ..runtime.clock import Clock
from ._cdr_middleware import CdrMiddleware
from ._guard.mark import MARK
from ._ros2_common import checked_domain
from .middleware import FeedError, Listener, Outlet

if TYPE_CHECKING:
    from .feed import Feed

PORT = 7447
"""The port of the router of a robot, unless its configuration says otherwise."""

_HOST = re.compile(r"([\w.-]+|\[[\da-fA-F:]+\])(:\d+)?")
_LOCATOR = re.compile(r"(tcp|tls|udp|quic|ws)/([\w.-]+|\[[\da-fA-F:]+\]):\d+")


class Zenoh(CdrMiddleware):
    """A `Middleware` that is a client of the Zenoh router of a robot.

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

    def _run_session(self, listener: Listener) -> str:
        from zenoh import ZError

        from ._zenoh_session import RouterLostError, ZenohSession

        try:
            session = ZenohSession(self._locator, self._domain, listener, self._no_robot(), self._clock, self._mark)
        except ZError:
            return self._no_router()
        try:
            self._serve(session, listener)
        except RouterLostError as lost:
            return str(lost)
        return ""

    def _no_router(self) -> str:
        """Return the reason why no router was reached. Zenoh itself reports only that its time is over."""
        host = self._locator.partition("/")[2].rpartition(":")[0].strip("[]")
        try:
            socket.getaddrinfo(host, None)
        except OSError:
            return f"the name {host} cannot be resolved; try the robot's IP address"
        return (
            f"no Zenoh router answers at {self._locator}. Is the robot on, and in this network? Does its router "
            "run (ros2 run rmw_zenoh_cpp rmw_zenohd)? Does a firewall block the port?"
        )

    def _no_robot(self) -> str:
        return (
            f"the Zenoh router at {self._locator} answers, but no node of ROS 2 is in domain {self._domain}. "
            f"Is {self._domain} the robot's ROS_DOMAIN_ID? Do its nodes run with RMW_IMPLEMENTATION=rmw_zenoh_cpp?"
        )


def checked_locator(locator: object) -> str:
    """Return the address of a router as Zenoh writes it. Raise TypeError or ValueError if it is not an address."""
    expected = "locator: expected the address of the robot's Zenoh router, such as 'tcp/robot:7447' or 'robot'"
    if not isinstance(locator, str):
        raise TypeError(f"{expected}, got {locator!r}")
    found = _HOST.fullmatch(locator)
    whole = f"tcp/{found[1]}{found[2] or f':{PORT}'}" if found else locator
    if not _LOCATOR.fullmatch(whole):
        raise ValueError(f"{expected}, got {locator!r}")
    if not 0 < int(whole.rpartition(":")[2]) <= 65535:
        raise ValueError(f"{expected}, with a port of 1 to 65535, got {locator!r}")
    return whole


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
