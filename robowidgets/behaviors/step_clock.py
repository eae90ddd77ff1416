"""The time of a program: the seconds during which it could make steps."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable

STALL = 0.5
"""Seconds between two checks after which the process counts as suspended, for example while the computer slept."""

KEPT = 1000
"""The number of interruptions to remember, to convert times of the past."""


class StepClock:
    """A clock that counts the seconds during which a program can make steps.

    While it runs, it adds the time between two checks unless that is longer than `STALL`; so `look` must be called
    several times a second. Any thread may call each method.

    Args:
        now: the monotonic clock.
    """

    def __init__(self, now: Callable[[], float] = time.monotonic) -> None:
        self._now = now
        self._lock = threading.Lock()
        self._seconds, self._looked_at = 0.0, now()
        self._is_running = False
        self._runs: deque[tuple[float, float]] = deque(maxlen=KEPT)
        """For each uninterrupted stretch: the seconds at its beginning, and the monotonic time of second 0."""

    def look(self) -> float:
        """Return the seconds until now."""
        with self._lock:
            return self._look()

    def start(self) -> float:
        """Count from now on if it does not yet. Return the seconds until now."""
        with self._lock:
            seconds, self._is_running = self._look(), True
            origin = self._looked_at - seconds
            if not self._runs or abs(origin - self._runs[-1][1]) > 0.001:
                self._runs.append((seconds, origin))
            return seconds

    def stop(self, more: float = 0.0) -> None:
        """Stop counting until the next start, after adding some seconds."""
        with self._lock:
            self._look()
            self._seconds, self._is_running = self._seconds + more, False

    def at(self, seconds: float) -> float:
        """Return the monotonic time when it had counted so many seconds."""
        with self._lock:
            known = (origin for since, origin in reversed(self._runs) if since <= seconds)
            return seconds + next(known, self._looked_at)

    def _look(self) -> float:
        now = self._now()
        gap, self._looked_at = now - self._looked_at, now
        if self._is_running and gap <= STALL:
            self._seconds += gap
        return self._seconds
