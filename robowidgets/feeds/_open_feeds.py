"""Closing open feeds when the process ends, because a robot may be moving."""

from __future__ import annotations

import logging
import os
import time
from collections.abc import Callable
from typing import Protocol

from ..driving.stop_all import before_stop, stop_all

log = logging.getLogger("robowidgets")

END_TIMEOUT = 4.0
"""Seconds after which no further feed is closed."""


class Closes(Protocol):
    """An object that can be closed."""

    def close(self) -> object:
        """Close it."""


class EndsDriving(Closes, Protocol):
    """The driver of a feed."""

    def end(self) -> object:
        """Send zero if one is owed, and refuse every speed from now on, without waiting."""


class OpenFeed(Closes, Protocol):
    """The part of a feed's connection that closes it."""

    unsent: str
    """The reason why zero could not be sent on closing, or empty if it was sent."""

    @property
    def where(self) -> str:
        """The address or name that it is connected to."""

    @property
    def programs(self) -> Closes:
        """Its programs."""

    @property
    def driver(self) -> EndsDriving:
        """Its driver."""

    def on_fork(self) -> None:
        """Close in a forked process."""


open_feeds: set[OpenFeed] = set()
"""The feeds that are closed at the end of the process. A forked process has none."""


def _close_all() -> None:
    there, until = list(open_feeds), time.monotonic() + END_TIMEOUT
    for one in there:  # nothing may drive after the zeros
        _try(one.programs.close)
        _try(one.driver.end)
    stop_all()  # before closing, which may take seconds for each feed
    for one in there:
        if time.monotonic() > until:
            log.error("the process ends without waiting for a feed to close: %s", one.where)
            return
        _try(one.close)
        if one.unsent:
            log.error("%s: zero may not have reached the robot before the process ended: %s", one.where, one.unsent)


def _forget_all() -> None:
    for one in open_feeds:
        one.on_fork()
    open_feeds.clear()


def _try(close: Callable[[], object]) -> None:
    try:
        close()
    except Exception:  # the other feeds must be closed, too
        log.exception("a feed could not be closed")


before_stop.append(_close_all)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_all)
