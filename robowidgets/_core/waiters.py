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
    """Threads that wait until there is something, which a lock guards.

    A `threading.Condition` releases the lock of its caller, and takes it again. An interrupt between the two leaves the
    caller without the lock that it goes on to release. So threads wait here without it.

    Args:
        lock: the lock.
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
        """What a function returns, called with the lock, as soon as that is not None; None when the time is over.

        Called without the lock.
        """
        signal, until = self._clock.signal(), self._clock.now() + seconds
        try:
            while True:
                with self._lock:
                    if (found := find()) is not None or self._clock.now() >= until:
                        return found
                    self._signals.add(signal)
                signal.wait_until(min(until, self._clock.now() + LOOK))
        finally:
            with self._lock:
                self._signals.discard(signal)
