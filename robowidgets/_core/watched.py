"""The base of objects whose changes other code wants to know."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress


class Watched:
    """An object that calls functions on each of its changes. Any thread may call each method."""

    def __init__(self) -> None:
        self._watchers: list[Callable[[], None]] = []

    def watch(self, on_change: Callable[[], None]) -> None:
        """Call a function on each change, in the thread that makes the change. It must return at once."""
        self._watchers.append(on_change)

    def forget(self, on_change: Callable[[], None]) -> None:
        """Remove a function that was added by `watch`."""
        with suppress(ValueError):  # another thread was faster
            self._watchers.remove(on_change)

    def _call_watchers(self) -> None:
        """Call them; without a lock held, because a watcher may take any."""
        for on_change in list(self._watchers):
            on_change()
