"""When the next large frame may go: once the page has drawn the last one, so that none queues on its way."""

from __future__ import annotations

import threading
from collections.abc import Callable

LATE = 1.0
"""Seconds after which a page that has not drawn a frame is not waited for if another one has. If none has, pages are
asked, and again after twice as long each time."""

LONGEST = 30.0
"""Seconds of the longest pause between two questions."""

BUDGET_BYTES = 4_000_000
"""Bytes a second that are sent without answers. Any page draws as much."""

BUDGET_INTERVAL = 0.1
"""Seconds between two frames without answers, at least."""

_MOST_PAGES = 16


class Credit:
    """What pages have drawn of the frames of one widget, and so whether the next one may go.

    A page is known by its first answer. A frame goes when all known pages have drawn the one before. A page that is
    slow, hidden or gone delays the others by a second, and is forgotten until it answers again. Before any page has
    answered, one frame goes. While no answer can be heard, frames go within a budget.

    Args:
        clock: the seconds of a monotonic clock.
        is_busy: whether a cell is running, which keeps answers from being heard where no thread beside it does.
    """

    def __init__(self, clock: Callable[[], float], is_busy: Callable[[], bool]) -> None:
        self._clock, self._is_busy = clock, is_busy
        self._lock = threading.RLock()
        self._drawn: dict[str, float] = {}
        """By page the number of the frame that it drew last."""
        self._sent = self._size = self._sent_at = 0.0
        """Of the frame that was sent last: its number, its bytes and the time."""
        self._is_free = True
        """Whether no frame is on its way."""
        self._pause = self._asks_at = 0.0
        self._is_beside: bool | None = None
        """Whether answers are heard while a cell runs; None until one came."""

    def may_send(self) -> bool:
        """Whether a frame may go now."""
        with self._lock:
            age = self._clock() - self._sent_at
            if not self._is_free and age >= LATE:
                in_time = {page: number for page, number in self._drawn.items() if number >= self._sent}
                if in_time:
                    self._drawn, self._is_free = in_time, True
            return self._is_free or (self.is_paced and age >= self._interval)

    @property
    def is_paced(self) -> bool:
        """Whether no answer can be heard now, so that frames go within a budget."""
        return not self._is_beside and self._is_busy()

    @property
    def says_paced(self) -> bool:
        """Whether that is so because the notebook has no way for answers beside a cell, and not just for the moment."""
        return self._is_beside is False and self._is_busy()

    @property
    def is_unheard(self) -> bool:
        """Whether no page has ever answered."""
        return self._is_beside is None

    @property
    def look_at(self) -> float:
        """When to look again whether a frame may go."""
        with self._lock:
            return self._sent_at + self._interval if self.is_paced else self._asks_at

    def asks(self) -> float | None:
        """The number of the frame after which pages are to be asked now; None: they are not."""
        with self._lock:
            now = self._clock()
            if self._is_free or self.is_paced or now < self._asks_at:
                return None
            self._pause = min(2 * self._pause, LONGEST)
            self._asks_at = now + self._pause
            return self._sent

    def sent(self, number: float, size: int) -> None:
        """Note that a frame went out. Its number may be that of the one before, which it improves."""
        with self._lock:
            self._drawn = {page: min(drawn, number - 1) for page, drawn in self._drawn.items()}
            self._sent, self._size, self._sent_at, self._is_free = number, size, self._clock(), False
            self._pause, self._asks_at = LATE, self._sent_at + LATE

    def on_drawn(self, page: str, number: float, lacks: float | None = None) -> bool:
        """Note which frame a page drew last; returns whether the next one may go.

        ``lacks`` is the number of the frame after which it was asked, if that has not come: it was lost on its way.
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
