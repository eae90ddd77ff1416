"""How often something comes."""

from __future__ import annotations

from collections import deque

SPACING = 0.1
"""Seconds between two marks: what comes faster is counted, not kept."""

WINDOW = 3.0
"""Seconds of the past that count."""

SHORTEST = 0.25
"""Seconds that must have passed before a rate means anything: a loop over a recording is no rate."""


class RateMeter:
    """Counts arrivals and tells their rate over the last seconds. Times are of one monotonic clock."""

    def __init__(self) -> None:
        self._marks: deque[tuple[float, int]] = deque()
        self._count = 0
        self._last = 0.0

    def arrive(self, now: float) -> None:
        """Count an arrival."""
        self._count += 1
        self._last = now
        if not self._marks or now - self._marks[-1][0] >= SPACING:
            self._marks.append((now, self._count))
            while len(self._marks) > 2 and now - self._marks[0][0] > WINDOW:
                self._marks.popleft()

    @property
    def rate(self) -> float:
        """Arrivals per second, up to the last one; NaN while nothing can be said."""
        if not self._marks:
            return float("nan")
        first, count = self._marks[0]
        passed = self._last - first
        return (self._count - count) / passed if passed >= SHORTEST else float("nan")
