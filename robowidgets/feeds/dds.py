"""Robots with ROS 2, over DDS, without an installation of ROS."""

from __future__ import annotations

import socket
from contextlib import suppress
from ipaddress import IPv4Address, IPv6Address, ip_address
from typing import TYPE_CHECKING

from ..messages.twist import TWIST_STAMPED
from ..notebook import in_browser
from ..runtime.clock import Clock
from ._cdr_middleware import CdrMiddleware
from ._guard.mark import MARK
from ._ros2_common import checked_domain, no_robot
from .middleware import FeedError, Listener, Outlet

if TYPE_CHECKING:
    from .feed import Feed


class Dds(CdrMiddleware):
    """A `Middleware` that is a participant in a DDS domain.

    Args:
        domain, interface: see `dds`.
        mark: for a guard, the mark of its publishers.
        clock: the clock of its waits, except for waits in Cyclone DDS.

    Raises:
        TypeError, ValueError: the domain does not exist, or the interface is not a name.
    """

    def __init__(
        self, domain: int = 0, *, interface: str | None = None, mark: str = "", clock: Clock | None = None
    ) -> None:
        if interface is not None and not isinstance(interface, str):
            raise TypeError(f"interface: expected the name of a network interface, such as 'eth0', got {interface!r}")
        super().__init__(clock)
        self._domain, self._interface = checked_domain("domain", domain), interface
        self._mark = mark

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return f"DDS domain {self._domain}" + (f" on {self._interface}" if self._interface else "")

    @property
    def outlet(self) -> Outlet:
        """See `HasOutlet`."""
        return Outlet("dds", {"domain": self._domain, "interface": self._interface, "mark": MARK})

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        if why := in_browser.no_robot("feeds.dds"):
            raise FeedError(why)
        try:
            import cyclonedds.domain  # noqa: F401
        except ImportError as error:
            raise FeedError(f"feeds.dds needs cyclonedds: pip install 'robowidgets[dds]' ({error})") from None
        self._start_thread("robowidgets-dds", listener)

    def _run_session(self, listener: Listener) -> str:
        from cyclonedds.core import DDSException

        try:
            self._in_domain(listener)
        except DDSException as error:
            missing = _why_not(self._interface) if self._interface else ""
            return missing or f"{self.where} cannot be used: {error.msg or error}"
        return ""

    def _in_domain(self, listener: Listener) -> None:
        from ._dds_session import DdsSession
        from ._dds_types import struct

        struct(TWIST_STAMPED)  # takes a while the first time, and no speed or zero should wait for it
        session = DdsSession(self._domain, listener, self._interface, self._no_robot(), self._clock, self._mark)
        self._serve(session, listener)

    def _no_robot(self) -> str:
        if self._interface == "lo":
            return no_robot(self._domain, "'lo' reaches only this machine.")
        others = [name for name in _interfaces() if name not in ("lo", self._interface)]
        if not others:
            return no_robot(self._domain)
        likely = min(others, key=lambda name: not name.startswith(("e", "w")))  # a cable or radio, not a container
        asked = f"Is it in another network? Then use dds({self._domain}, interface={likely!r})."
        return no_robot(self._domain, f"{asked} The interfaces are {', '.join(others)}.")


def _interfaces() -> list[str]:
    """Return the names of the network interfaces of this machine."""
    return [name for _, name in socket.if_nameindex()]


def _why_not(interface: str) -> str:
    """Return a text for a name or an address that no interface of this machine has, or empty if one has it."""
    try:
        has_it = _is_ours(ip_address(interface))
    except ValueError:
        has_it = interface in _interfaces()
    there = ", ".join(_interfaces())
    return "" if has_it else f"this machine has no network interface {interface!r}; there are {there}"


def _is_ours(address: IPv4Address | IPv6Address) -> bool:
    family = socket.AF_INET if address.version == 4 else socket.AF_INET6
    with socket.socket(family, socket.SOCK_DGRAM) as probe, suppress(OSError):
        probe.bind((str(address), 0))
        return True
    return False


def dds(domain: int = 0, *, interface: str | None = None) -> Feed:
    """Open a feed of ROS 2 over DDS. ROS need not be installed.

    Args:
        domain: the robot's ``ROS_DOMAIN_ID``, 0 to 232.
        interface: the network interface to use, by name (``"eth0"``) or address. The default is the interface in
            ``CYCLONEDDS_URI``, or the first that works. With ``"lo"`` nothing is sent beyond this machine. Cyclone DDS
            listens on all interfaces in any case, because it has no setting against that.

    Raises:
        TypeError, ValueError: the domain does not exist, or the interface is not a name.
        FeedError: cyclonedds is not installed.

    Source: https://design.ros2.org/articles/topic_and_service_names.html
    """
    from .feed import Feed  # a guard imports only the middleware

    return Feed(Dds(domain, interface=interface))
