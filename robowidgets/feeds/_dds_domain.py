"""The configuration of DDS domains: a process can have only one for each domain."""

from __future__ import annotations

import threading
from html import escape
from ipaddress import ip_address
from typing import Any
from weakref import WeakValueDictionary

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain

_LOOPBACK = (
    '<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    '<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>'
)

_lock = threading.Lock()
_used: WeakValueDictionary[tuple[int, str], Any] = WeakValueDictionary()


def configured(domain: int, interface: str | None) -> Any:
    """A domain that uses an interface, for as long as the result is kept; None for the default interface.

    Raises:
        DDSException: there is no such interface, or the process uses the domain with another configuration.
    """
    if interface is None:
        return None
    with _lock:
        found = _used.get((domain, interface))
        if found is None:
            found = _used[domain, interface] = _domain(domain, interface)
        return found


def _domain(domain: int, interface: str) -> Any:
    xml = f"<CycloneDDS><Domain>{_settings(interface)}</Domain></CycloneDDS>"
    try:
        return Domain(domain, xml)
    except DDSException as error:
        if error.code == DDSException.DDS_RETCODE_PRECONDITION_NOT_MET:
            raise DDSException(error.code, "this process uses the domain already, on another interface") from None
        raise


def _settings(interface: str) -> str:
    if interface == "lo":
        return _LOOPBACK
    try:
        kind = f'address="{escape(str(ip_address(interface)))}"'
    except ValueError:
        kind = f'name="{escape(interface)}"'
    return f"<General><Interfaces><NetworkInterface {kind}/></Interfaces></General>"
