"""An iterator over the scans of a topic."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from ..messages import to_scan
from ..samples import Scan

if TYPE_CHECKING:
    from ._connection import Connection

FIRST_TIMEOUT = 10.0
"""Seconds for the first scan: the robot may have to be connected and its topic discovered."""


def scans_of(connection: Connection, topic: str, timeout: float) -> Iterator[Scan]:
    """See `Feed.scans`."""
    arrived = threading.Condition()
    newest: list[Any] = []

    def take(message: Any) -> None:
        with arrived:
            newest[:] = [message]
            arrived.notify()

    target = connection.attach(topic, take)
    limit = max(timeout, FIRST_TIMEOUT)
    try:
        while True:
            until = time.monotonic() + limit
            with arrived:
                # In short steps, to notice when the feed is closed.
                while not newest and not connection.is_closed and (left := until - time.monotonic()) > 0:
                    arrived.wait(min(left, 0.1))
                message = newest.pop() if newest else None
            if message is None:
                why = connection.status_of(topic)
                raise TimeoutError(f"no scan of {topic} for {limit:g} s" + (f": {why}" if why else ""))
            limit = timeout
            yield to_scan(message)
    finally:
        connection.detach(topic, target)
