"""Closing what is open when the process ends: a robot may be driving."""

from __future__ import annotations

import atexit
import logging
import os
import time
from typing import Protocol

from .._core.command_watchdog import stop_all

log = logging.getLogger("robowidgets")

END_TIMEOUT = 4.0
"""Seconds after which the end of the process closes no further feed."""


class Closable(Protocol):
    """What can be closed; a feed."""

    def close(self) -> None:
        """Close it."""

    def on_fork(self) -> None:
        """Learn that this is a process that was forked off: the threads stayed behind."""


still_open: set[Closable] = set()
"""What is closed at the end. A process that was forked off has none of it."""


def close_first() -> None:
    """At the end, close before all ends that was registered until now: that of rospy, say, by which zero is sent."""
    atexit.unregister(_close_all)
    atexit.register(_close_all)


def _close_all() -> None:
    stop_all()  # first: another feed may take its time to close
    until = time.monotonic() + END_TIMEOUT
    for one in list(still_open):
        if time.monotonic() > until:
            log.error("the process ends without waiting for a feed to close: %r", one)
            return
        _close(one)


def _forget_all() -> None:
    for one in still_open:
        one.on_fork()
    still_open.clear()


def _close(one: Closable) -> None:
    try:
        one.close()
    except Exception:  # the others must be stopped, too
        log.exception("a feed could not be closed")


close_first()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_all)
