"""Subscribing a middleware to the topics that are wanted."""

from __future__ import annotations

from collections.abc import Callable, Collection

from .._core.coalesced_call import CoalescedCall
from .middleware import Middleware


class Subscriber:
    """Keeps a middleware subscribed to the topics that are wanted, and to no others.

    The middleware is called without a lock: its methods may take a lock of their own, and one of its threads may hold
    that lock while it waits for ours.

    Args:
        middleware: the middleware.
        wanted: returns the topics that are wanted now; None once the middleware must not be called any more.

    Attributes:
        update: subscribes to the topics that are wanted now; any thread may call it.
    """

    def __init__(self, middleware: Middleware, wanted: Callable[[], Collection[str] | None]) -> None:
        self._middleware = middleware
        self._wanted = wanted
        self._subscribed: set[str] = set()
        self.update = CoalescedCall(self._update)

    def _update(self) -> None:
        wanted = self._wanted()
        if wanted is None:
            return
        for topic in set(wanted) - self._subscribed:
            self._subscribed.add(topic)
            self._middleware.subscribe(topic)
        for topic in self._subscribed - set(wanted):
            self._subscribed.discard(topic)
            self._middleware.unsubscribe(topic)
