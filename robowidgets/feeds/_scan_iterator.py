"""An iterator over the scans of a topic."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..messages import to_scan
from ..samples import Scan
from ..samples.age import note_arrival
from ..widget.newest_sample import NewestSample

if TYPE_CHECKING:
    from ._connection import Connection

log = logging.getLogger("robowidgets")

FIRST_TIMEOUT = 10.0
"""Seconds to wait for the first scan, because the connection and the topic may not be ready."""


def scans_of(connection: Connection, topic: str, timeout: float) -> Iterator[Scan]:
    """See `Feed.scans`."""
    newest: NewestSample[Any] = NewestSample()
    taken = 0
    target = connection.attach(topic, lambda message: newest.put(message, {}, counts=True))
    limit, told = max(timeout, FIRST_TIMEOUT), False

    def find_next() -> tuple[Any, float, int] | None:
        # Skip a scan that came early during a slow loop body, because no scan has come since.
        with newest.lock:
            is_there = newest.sequence > taken and newest.age <= timeout
            return (newest.sample, newest.arrived, newest.sequence) if is_there else None

    try:
        while True:
            found, until = None, time.monotonic() + limit
            # Wait in short steps, to notice when the feed is closed.
            while found is None and not connection.is_closed and (left := until - time.monotonic()) > 0:
                found = newest.waiters.wait_for(find_next, min(left, 0.1))
                if found is None and not (taken or told) and (why := connection.why_missing(topic)):
                    told = True
                    log.warning("%s; waiting for %s for %g s, in case it comes", why, topic, limit)
            if found is None:
                why = connection.status_of(topic)
                raise TimeoutError(f"no scan of {topic} for {limit:g} s" + (f": {why}" if why else ""))
            message, arrived, taken = found
            limit = timeout
            scan = to_scan(message)
            note_arrival(scan, arrived)
            yield connection.mounted(scan)
    finally:
        connection.detach(topic, target)
