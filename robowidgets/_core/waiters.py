"""Threads that wait for what other threads do, and that an interrupt may end at any step."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeVar

from .clock import Clock, Signal, scheduler

T = TypeVar("T")

LOOK = 0.25
"""Seconds after which a thread that waits looks for an interrupt. One that comes just before it sleeps wakes nobody."""


class Waiters:
    """Threads that wait until there is something.

    A `threading.Condition` releases the lock of its caller, and takes it again. An interrupt between the two leaves the
    caller without the lock that it goes on to release. So threads wait here without it.

    Args:
        lock: guards the list of those that wait.
        clock: None: that of our scheduler.
    """

    def __init__(self, lock: threading.RLock, clock: Clock | None = None) -> None:
        self._lock, self._clock = lock, clock or scheduler.clock
        self._signals: set[Signal] = set()

    def __len__(self) -> int:
        return len(self._signals)

    def wake(self) -> None:
        """Have all of them look again. Called with the lock."""
        for signal in self._signals:
            signal.set()

    def wait_for(self, find: Callable[[], T | None], seconds: float) -> T | None:
        """Return what a function returns, as soon as that is not None; or None when the time is over.

        Neither this nor the function is called with the lock: the function may take others.
        """
        signal, until = self._clock.signal(), self._clock.now() + seconds
        try:
            with self._lock:  # before the first look: a wake after that look is not missed
                self._signals.add(signal)
            while (found := find()) is None and self._clock.now() < until:
                signal.wait_until(min(until, self._clock.now() + LOOK))
            return found
        finally:
            with self._lock:
                self._signals.discard(signal)
