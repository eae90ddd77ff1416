"""Pauses between attempts to connect, which grow until one succeeds."""

from __future__ import annotations

import random
import threading

FIRST = 0.5
"""Seconds of the first pause."""

LONGEST = 8.0
"""Seconds of the longest pause."""

JITTER = 0.1
"""Share by which a pause may be shorter, so that a hundred clients of one robot do not reconnect all at once."""


class Backoff:
    """The pauses between attempts: half a second, then twice as long each time, up to eight.

    A middleware passes the next pause to `Listener.on_lost`, and then waits::

        while not backoff.closed:
            try:
                ...  # connect; backoff.reset() once it did; read until the connection ends
            except OSError as error:
                listener.on_lost(str(error), pause := backoff.next_pause())
                backoff.wait(pause)

    Any thread may call `close`.
    """

    def __init__(self) -> None:
        self._closed = threading.Event()
        self._pause = FIRST

    @property
    def closed(self) -> bool:
        """Whether `close` was called, which ends the attempts."""
        return self._closed.is_set()

    def next_pause(self) -> float:
        """Seconds to wait before the next attempt."""
        pause, self._pause = self._pause, min(2 * self._pause, LONGEST)
        return pause * random.uniform(1 - JITTER, 1)

    def reset(self) -> None:
        """Reset: after the next loss, the first pause is the short one again."""
        self._pause = FIRST

    def wait(self, seconds: float) -> bool:
        """Wait, or return at once when it is closed; returns whether to try again."""
        return not self._closed.wait(seconds)

    def close(self) -> None:
        """End every wait, now and later; doing it again does nothing."""
        self._closed.set()
