"""The configuration of DDS domains. A process can have only one for each domain."""

from __future__ import annotations

import os
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

_CONFIRMING = "<Internal><HeartbeatInterval>10 ms</HeartbeatInterval></Internal>"
"""Makes a writer request a confirmation with each of 50 messages a second. The default is 10 requests a second, so zero
would be confirmed 0.2 s later."""

_BUFFER = '<Internal><SocketReceiveBufferSize max="16MiB"/></Internal>'
"""Requests a larger buffer from the system, for bursts and for the time in which other code holds the GIL. A few images
fill the default buffer. The system gives as much as its limit allows (on Linux ``net.core.rmem_max``)."""

_lock = threading.Lock()
_used: WeakValueDictionary[tuple[int, str], Any] = WeakValueDictionary()


def configured(domain: int, interface: str | None, *, alone: bool = False) -> Any:
    """Return a domain that uses an interface while the result is kept, or None if another program configured it.

    Args:
        domain: its number.
        interface: the network interface, or None for the default one.
        alone: True if nothing else in this process may use the domain.

    Raises:
        DDSException: the interface does not exist, or the process uses the domain with another configuration.
    """
    with _lock:
        found = _used.get((domain, interface or ""))
        if found is None:
            try:
                found = _used[domain, interface or ""] = _domain(domain, interface or "", alone=alone)
            except DDSException as error:
                if interface is None and not alone and error.code == DDSException.DDS_RETCODE_PRECONDITION_NOT_MET:
                    return None
                raise
        return found


def _domain(domain: int, interface: str, *, alone: bool) -> Any:
    there = "" if interface else os.environ.get("CYCLONEDDS_URI", "")
    ours = _settings(interface) + (_CONFIRMING if interface or alone else "")
    # The last setting counts: the environment overrides the size of the buffer, and our other settings override it.
    parts = [_configuration(_BUFFER), there, _configuration(ours) if ours else ""]
    try:
        return Domain(domain, ",".join(filter(None, parts)))
    except DDSException as error:
        if error.code == DDSException.DDS_RETCODE_PRECONDITION_NOT_MET:
            raise DDSException(error.code, "this process uses the domain already, on another interface") from None
        raise


def _configuration(settings: str) -> str:
    return f"<CycloneDDS><Domain>{settings}</Domain></CycloneDDS>"


def _settings(interface: str) -> str:
    if not interface:
        return ""
    if interface == "lo":
        return _LOOPBACK
    try:
        kind = f'address="{escape(str(ip_address(interface)))}"'
    except ValueError:
        kind = f'name="{escape(interface)}"'
    return f"<General><Interfaces><NetworkInterface {kind}/></Interfaces></General>"
