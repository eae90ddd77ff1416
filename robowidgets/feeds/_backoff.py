"""Pauses between attempts to connect, which grow until one succeeds."""

from __future__ import annotations

import random

FIRST = 0.5
"""Seconds of the first pause."""

LONGEST = 8.0
"""Seconds of the longest pause."""

JITTER = 0.1
"""Share by which a pause may be shorter, so that a hundred clients of one robot do not reconnect all at once."""


class Backoff:
    """The pauses between attempts: half a second, then twice as long each time, up to eight."""

    def __init__(self) -> None:
        self._pause = FIRST

    def next_pause(self) -> float:
        """Seconds to wait before the next attempt."""
        pause, self._pause = self._pause, min(2 * self._pause, LONGEST)
        return pause * random.uniform(1 - JITTER, 1)

    def reset(self) -> None:
        """Reset: after the next loss, the first pause is the short one again."""
        self._pause = FIRST
