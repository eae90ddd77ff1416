"""Zero for every robot that moves when the process ends, and for the robots that a cell drives when the cell fails."""

from __future__ import annotations

import atexit
import logging
import os
import time
from collections.abc import Callable
from typing import Any, Protocol

from ..runtime.platform_fixes import call_before_end

log = logging.getLogger("robowidgets")

SEND_TIMEOUT = 1.0
"""Seconds for which a caller waits until its speed is sent."""


class StoppedWatchdog(Protocol):
    """The part of a `CommandWatchdog` that stops the robot."""

    from_cell: bool

    @property
    def owes_zero(self) -> bool:
        """True while a zero must still be sent."""

    @property
    def busy_for(self) -> float:
        """Seconds for which the sending function has not returned."""

    def stop(self) -> Any:
        """Send zero now. Return the request."""

    def is_done_in_time(self, request: Any, timeout: float) -> bool:
        """Wait for at most some seconds until a request is done. Return True if it is."""


running: set[StoppedWatchdog] = set()
"""The watchdogs that owe a zero, or did a moment ago. Copy it before use: threads add and remove watchdogs."""

before_stop: list[Callable[[], object]] = []
"""Functions that are called at the end of the process before the last zeros are sent."""


def stop_at_end() -> None:
    """Stop all robots before the process ends, and before the exit handlers that are registered already.

    The exit handler of rospy, for example, would end its node before zero is sent.
    """
    atexit.unregister(_end)
    atexit.register(_end)
    call_before_end(_end)


def stop_all(timeout: float = SEND_TIMEOUT) -> None:
    """Send zero from every watchdog that owes one, and wait for all of them together."""
    zeros = [(watchdog, watchdog.stop()) for watchdog in list(running) if watchdog.owes_zero]
    until = time.monotonic() + timeout
    for watchdog, zero in zeros:
        if not watchdog.is_done_in_time(zero, until - time.monotonic()):
            log.error(
                "zero may not have reached a robot: the function that sends speeds has not returned (%.1f s)",
                watchdog.busy_for,
            )


def stop_driven_by_cell() -> None:
    """Send zero from every watchdog whose robot a cell drives."""
    for watchdog in list(running):
        if watchdog.from_cell and watchdog.owes_zero:
            watchdog.stop()


def _end() -> None:
    for call in before_stop:
        call()
    stop_all()


atexit.register(_end)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=running.clear)
