"""The rate of arrivals."""

from __future__ import annotations

from collections import deque

SPACING = 0.1
"""Seconds between two marks: faster arrivals are counted, but get no mark."""

WINDOW = 3.0
"""Seconds over which the rate is measured."""

SHORTEST = 0.25
"""The fewest seconds of arrivals for a rate. A loop over a recording has no rate."""


USUAL_S, LEAST_S, SAG_S = 60, 10, 3
"""The seconds over which the usual rate is found, the fewest seconds for it, and the seconds after which a low rate
counts as sagged."""


class RateMeter:
    """Measures the rate of a counter over the last seconds. All times are of one monotonic clock."""

    def __init__(self) -> None:
        self._marks: deque[tuple[float, int]] = deque()
        self._rates: deque[float] = deque(maxlen=USUAL_S)
        """The rate in each of the last seconds with arrivals."""
        self._noted = float("-inf")

    def rate(self, count: int, last: float) -> float:
        """Return the arrivals per second up to the last one, or NaN while the rate is unknown.

        Call this regularly: the counter is read only during a call.

        Args:
            count: the number of arrivals so far.
            last: the time of the last arrival, in seconds.
        """
        if not count:
            return float("nan")
        if not self._marks or last - self._marks[-1][0] >= SPACING:
            self._marks.append((last, count))
            # After a pause the old mark stays until the new ones are enough for a rate.
            while last - self._marks[0][0] > WINDOW and len(self._marks) > 2 and last - self._marks[1][0] >= SHORTEST:
                self._marks.popleft()
        first, before = self._marks[0]
        passed = last - first
        rate = (count - before) / passed if passed >= SHORTEST else float("nan")
        if passed >= SHORTEST and last - self._noted >= 1:
            self._noted = last
            self._rates.append(rate)
        return rate

    @property
    def usual(self) -> float:
        """The upper quartile of the rate in the last minute; NaN before there are ten seconds of it."""
        rates = sorted(self._rates)
        return rates[3 * len(rates) // 4] if len(rates) >= LEAST_S else float("nan")

    @property
    def has_sagged(self) -> bool:
        """True while the rate has been below half of the usual one for three seconds."""
        return bool(self._rates) and 2 * max(list(self._rates)[-SAG_S:]) < self.usual
