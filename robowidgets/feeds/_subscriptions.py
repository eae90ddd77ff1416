"""Asking a middleware for topics, without ever holding a lock."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection

from .middleware import Middleware


class Subscriptions:
    """Subscribes to what is wanted, and no more to what is not.

    The middleware may want a lock of its own, and a thread of it may be waiting for one of ours: it is asked without
    any. It is asked by one thread at a time, so that what it hears last is what is wanted last.

    Args:
        middleware: what is asked.
        wanted: gives the topics that are wanted now; None when the middleware may be asked nothing any more.
    """

    def __init__(self, middleware: Middleware, wanted: Callable[[], Collection[str] | None]) -> None:
        self._middleware = middleware
        self._wanted = wanted
        self._have: set[str] = set()
        self._looking = threading.Lock()
        self._busy = self._stale = False

    def settle(self) -> None:
        """Ask for what is wanted now. A thread that is at it already looks again, and this one need not wait."""
        with self._looking:
            self._stale = True
            if self._busy:
                return
            self._busy = True
        try:
            while self._again():
                self._ask(self._wanted())
        except BaseException:
            self._busy = False
            raise

    def _ask(self, wanted: Collection[str] | None) -> None:
        if wanted is None:
            return
        for topic in set(wanted) - self._have:
            self._have.add(topic)
            self._middleware.subscribe(topic)
        for topic in self._have - set(wanted):
            self._have.discard(topic)
            self._middleware.unsubscribe(topic)

    def _again(self) -> bool:
        with self._looking:
            self._busy, self._stale = self._stale, False
            return self._busy
