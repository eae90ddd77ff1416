"""The base of objects that other code observes for changes."""

from __future__ import annotations

import logging
from collections.abc import Callable
from contextlib import suppress

log = logging.getLogger("robowidgets")


class Observed:
    """An object that calls functions on each of its changes. Any thread may call each method."""

    def __init__(self) -> None:
        self._observers: list[Callable[[], None]] = []

    def observe(self, on_change: Callable[[], None]) -> None:
        """Call a function on each change, in the thread that makes the change. It must return at once."""
        self._observers.append(on_change)

    def unobserve(self, on_change: Callable[[], None]) -> None:
        """Remove a function that was added by `observe`."""
        with suppress(ValueError):  # another thread was faster
            self._observers.remove(on_change)

    def _call_observers(self) -> None:
        """Call the observers, and log their errors. Called without a lock, because an observer may take any lock."""
        for on_change in list(self._observers):
            _call(on_change)


def _call(on_change: Callable[[], None]) -> None:
    try:
        on_change()
    except Exception:  # it must not end a thread that sends speeds
        log.exception("a change could not be shown")
