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
    """Tells the rate of what is counted elsewhere, over the last seconds. Times are of one monotonic clock."""

    def __init__(self) -> None:
        self._marks: deque[tuple[float, int]] = deque()

    def rate(self, count: int, last: float) -> float:
        """Arrivals per second, up to the last one; NaN while nothing can be said.

        To be asked again and again: between two of its marks it knows of nothing.

        Args:
            count: how many have arrived, never fewer than before.
            last: when the last one did.
        """
        if not count:
            return float("nan")
        if not self._marks or last - self._marks[-1][0] >= SPACING:
            self._marks.append((last, count))
            # After a pause the old mark stays until the rate can be told of the new ones.
            while last - self._marks[0][0] > WINDOW and len(self._marks) > 2 and last - self._marks[1][0] >= SHORTEST:
                self._marks.popleft()
        first, before = self._marks[0]
        passed = last - first
        return (count - before) / passed if passed >= SHORTEST else float("nan")
