"""The configuration of DDS domains: a process can have only one for each domain."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from ipaddress import ip_address
from typing import Any
from xml.sax.saxutils import quoteattr

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain

_LOOPBACK = (
    '<General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    '<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>'
)

_lock = threading.Lock()
_used: dict[tuple[int, str], tuple[Any, int]] = {}


@contextmanager
def configured(domain: int, interface: str | None) -> Iterator[None]:
    """Configure a domain to use an interface, for as long as the context lasts; equal configurations are shared.

    Raises:
        DDSException: there is no such interface, or the process uses the domain with another configuration.
    """
    if interface is None:
        yield
        return
    key = domain, interface
    with _lock:
        configured_domain, count = _used.get(key, (None, 0))
        _used[key] = (configured_domain or _domain(domain, interface), count + 1)
    try:
        yield
    finally:
        with _lock:
            configured_domain, count = _used.pop(key)
            if count > 1:
                _used[key] = (configured_domain, count - 1)
            del configured_domain


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
        kind = f"address={quoteattr(str(ip_address(interface)))}"
    except ValueError:
        kind = f"name={quoteattr(interface)}"
    return f"<General><Interfaces><NetworkInterface {kind}/></Interfaces></General>"
