"""Flow control of large frames: the next one goes once the page has drawn the last one, so that they do not queue."""

from __future__ import annotations

import threading
from collections.abc import Callable

LATE = 1.0
"""Seconds for which a frame waits for a page that has not drawn the one before, if another page has. If no page has,
the pages are asked, and again each time after twice as long."""

LONGEST = 30.0
"""The longest pause between two questions, in seconds."""

BUDGET_BYTES = 4_000_000
"""Bytes a second that are sent without answers. Any page can draw that much."""

BUDGET_INTERVAL = 0.1
"""The shortest time between two frames without answers, in seconds."""

_MOST_PAGES = 16


class Credit:
    """The frames of one widget that pages have drawn, which decide when the next one may go.

    A page is known once it has answered. A frame goes when all known pages have drawn the one before. A page that is
    slow, hidden or gone delays the others by a second, and is forgotten until it answers again. Before any page has
    answered, one frame goes. While answers cannot be received, frames go within a budget.

    Args:
        clock: the seconds of a monotonic clock.
        is_busy: returns True while a cell is running. Answers then arrive only if another thread receives them.
    """

    def __init__(self, clock: Callable[[], float], is_busy: Callable[[], bool]) -> None:
        self._clock, self._is_busy = clock, is_busy
        self._lock = threading.RLock()
        self._drawn: dict[str, float] = {}
        """The number of the last frame that each page drew."""
        self._sent = self._size = self._sent_at = 0.0
        """The number, the bytes and the time of the frame that was sent last."""
        self._is_free = True
        """True while no frame is on its way."""
        self._pause = self._asks_at = 0.0
        self._is_beside: bool | None = None
        """True if answers are received while a cell runs, or None before the first answer."""

    def may_send(self) -> bool:
        """Return True if a frame may go now."""
        with self._lock:
            age = self._clock() - self._sent_at
            if not self._is_free and age >= LATE:
                in_time = {page: number for page, number in self._drawn.items() if number >= self._sent}
                if in_time:
                    self._drawn, self._is_free = in_time, True
            return self._is_free or (self.is_paced and age >= self._interval)

    @property
    def is_paced(self) -> bool:
        """True while answers cannot be received, so that frames go within a budget."""
        return not self._is_beside and self._is_busy()

    @property
    def says_paced(self) -> bool:
        """True while `is_paced` holds because this notebook never delivers answers during a cell."""
        return self._is_beside is False and self._is_busy()

    @property
    def is_unheard(self) -> bool:
        """True until a page has answered."""
        return self._is_beside is None

    @property
    def look_at(self) -> float:
        """The time at which to check again if a frame may go."""
        with self._lock:
            return self._sent_at + self._interval if self.is_paced else self._asks_at

    def asks(self) -> float | None:
        """Return the number of the frame after which to ask the pages now, or None not to ask them."""
        with self._lock:
            now = self._clock()
            if self._is_free or self.is_paced or now < self._asks_at:
                return None
            self._pause = min(2 * self._pause, LONGEST)
            self._asks_at = now + self._pause
            return self._sent

    def sent(self, number: float, size: int) -> None:
        """Note that a frame went out. A frame that improves the one before has the same number."""
        with self._lock:
            self._drawn = {page: min(drawn, number - 1) for page, drawn in self._drawn.items()}
            self._sent, self._size, self._sent_at, self._is_free = number, size, self._clock(), False
            self._pause, self._asks_at = LATE, self._sent_at + LATE

    def on_drawn(self, page: str, number: float, lacks: float | None = None) -> bool:
        """Note the frame that a page drew last; return True if the next one may go.

        If the page was asked after a frame that never reached it, ``lacks`` is the number of this lost frame.
        """
        with self._lock:
            self._is_beside = threading.current_thread() is not threading.main_thread()
            if page in self._drawn or len(self._drawn) < _MOST_PAGES:
                self._drawn[page] = number
            if lacks == self._sent or min(self._drawn.values()) >= self._sent:
                self._is_free = True
            return self._is_free

    @property
    def _interval(self) -> float:
        return max(BUDGET_INTERVAL, self._size / BUDGET_BYTES)
