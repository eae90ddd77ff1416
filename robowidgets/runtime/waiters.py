"""Threads that wait for other threads, and that an interrupt may end at any step."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TypeVar

from .clock import Clock, Signal, scheduler

T = TypeVar("T")

LOOK = 0.25
"""Seconds after which a waiting thread checks for an interrupt. An interrupt just before it sleeps does not wake it."""


class Waiters:
    """Threads that wait until a function finds something.

    A `threading.Condition` releases the lock of its caller, and takes it again. After an interrupt in between, the
    caller does not have the lock that it then releases. So threads wait here without a lock.

    Args:
        lock: guards the set of waiting threads.
        clock: the clock of the package's scheduler by default.
    """

    def __init__(self, lock: threading.RLock, clock: Clock | None = None) -> None:
        self._lock, self._clock = lock, clock or scheduler.clock
        self._signals: set[Signal] = set()

    def __len__(self) -> int:
        return len(self._signals)

    def wake(self) -> None:
        """Make all waiting threads check again. Called with the lock."""
        for signal in self._signals:
            signal.set()

    def wait_for(self, find: Callable[[], T | None], seconds: float) -> T | None:
        """Return the result of a function as soon as it is not None, or None when the time is over.

        Neither this method nor the function is called with the lock: the function may take other locks.
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
