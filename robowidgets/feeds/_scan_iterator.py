"""An iterator over the scans of a topic."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from .._core.newest_sample import NewestSample
from ..messages import to_scan
from ..samples import Scan
from ..samples.age import note_arrival

if TYPE_CHECKING:
    from ._connection import Connection

log = logging.getLogger("robowidgets")

FIRST_TIMEOUT = 10.0
"""Seconds for the first scan: the robot may have to be connected and its topic discovered."""


def scans_of(connection: Connection, topic: str, timeout: float) -> Iterator[Scan]:
    """See `Feed.scans`."""
    newest: NewestSample[Any] = NewestSample()
    taken = 0
    target = connection.attach(topic, lambda message: newest.put(message, {}, counts=True))
    limit, told = max(timeout, FIRST_TIMEOUT), False

    def has_next() -> bool:  # not one that came early in a loop body which took long: nothing has come since
        return newest.sequence > taken and newest.age <= timeout

    try:
        while True:
            there, until = False, time.monotonic() + limit
            # In short steps, to notice when the feed is closed.
            while not there and not connection.is_closed and (left := until - time.monotonic()) > 0:
                with newest.lock:
                    there = newest.wait_for(has_next, min(left, 0.1))
                    message, arrived, sequence = newest.sample, newest.arrived, newest.sequence
                if not (there or taken or told) and (why := connection.why_missing(topic)):
                    told = True
                    log.warning("%s; waiting for %s for %g s, in case it comes", why, topic, limit)
            if not there:
                why = connection.status_of(topic)
                raise TimeoutError(f"no scan of {topic} for {limit:g} s" + (f": {why}" if why else ""))
            limit, taken = timeout, sequence
            scan = to_scan(message)
            note_arrival(scan, arrived)
            yield scan
    finally:
        connection.detach(topic, target)
