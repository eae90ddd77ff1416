"""Calls of the observers of titles that threads of this package change."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable

from ..runtime.clock import Scheduler
from ..runtime.coalesced_call import CoalescedCall

log = logging.getLogger("robowidgets")


class TitleObservers:
    """Calls the observers of titles that were changed by `NamedWidget.name_quietly`, in order.

    Observers are code of the user: no lock may be held while they run, and they do not run in threads that carry speeds
    or pictures.
    """

    def __init__(self, scheduler: Scheduler | None = None) -> None:
        self._waiting: deque[Callable[[], None]] = deque()
        self._call_all = CoalescedCall(self._call_waiting, thread="robowidgets-changes", scheduler=scheduler)

    def add(self, call: Callable[[], None] | None) -> None:
        """Note the function that `name_quietly` returned. Any lock may be held."""
        if call is not None:
            self._waiting.append(call)

    def call(self) -> None:
        """Call the observers: in the main thread if it calls this, so that a cell sees the result, else in another."""
        if self._waiting:
            self._call_all()

    def call_later(self) -> None:
        """Call the observers in another thread: for callers that may hold a lock."""
        if self._waiting:
            self._call_all.later()

    def _call_waiting(self) -> None:
        while self._waiting:
            _call(self._waiting.popleft())


def _call(observers: Callable[[], None]) -> None:
    try:
        observers()
    except Exception:  # the other titles have observers, too
        log.exception("robowidgets: an observer of a title raised an error")
