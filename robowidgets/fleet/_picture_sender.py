"""A thread that makes the pictures of a contact sheet, and sends them to the page."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Mapping, Sequence

from ..messages.decoding import one_line
from ..notebook.progress import without_bars
from ..recordings import RecordingData
from ..recordings.search.base import Condition
from ..repair import RecordingError
from ..runtime.clock import Scheduler, Ticket, scheduler
from ._hit import Hit
from ._pictures import pictures, unreadable

log = logging.getLogger("robowidgets")

AT_ONCE = 16
"""Pictures that are made before the requests are checked again."""

SENT_UNASKED = 20_000
"""The number of pictures that are sent before the page requests them, so that they are available while a cell runs."""

MEMORY = 200_000_000
"""The maximum size of the decoded samples of the recording that is read."""

_AT_EASE = 4
"""Idle time of the thread per working time, while the page does not show the pictures that it makes."""

_HELD = 60
"""Pictures of the first screen, which are in the state of the widget."""


class PictureSender:
    """A maker and sender of pictures: first the ones that a page shows, then all others after its first request.

    Args:
        send: sends some packed pictures.
        hold: called once with the packed pictures of the first screen.
        wanted: the condition.
        scheduler: the scheduler that repeats its turns.
    """

    def __init__(
        self,
        send: Callable[[bytes], None],
        hold: Callable[[bytes], None],
        wanted: Condition | None,
        scheduler: Scheduler = scheduler,
    ) -> None:
        self._send, self._hold, self._wanted = send, hold, wanted
        self._scheduler = scheduler
        self._lock = threading.RLock()
        self._hits: Sequence[Hit] = ()
        self._looked_at: list[int] = []
        self._sent: set[int] = set()
        self._next = 0
        """The first picture that may not be sent yet."""
        self._is_asked = False
        self._first: dict[int, bytes] | None = {}
        """Pictures of the first screen, until all are made."""
        self._recording: RecordingData | None = None
        self._file = ""
        self._ticket: Ticket | None = None
        self._is_closed = False

    def set_hits(self, hits: Sequence[Hit]) -> None:
        """Set the hits. Earlier hits keep their numbers."""
        with self._lock:
            self._hits = hits
            self._wake()

    def look(self, numbers: Sequence[int]) -> None:
        """Make these pictures next; earlier requests that are not done yet can wait."""
        with self._lock:
            self._looked_at = [*numbers]
            self._sent.difference_update(numbers)  # the page requests only pictures that it lacks
            self._is_asked = True
            self._wake()

    def start_anew(self) -> None:
        """Send all pictures again, to a page that has none."""
        with self._lock:
            self._sent.clear()
            self._next = 0

    def close(self) -> None:
        """End the thread."""
        with self._lock:
            self._is_closed = True
            if self._ticket is not None:
                self._ticket.wake()

    def _wake(self) -> None:
        """Wake or start the thread. Called with the lock held."""
        if self._ticket is not None:
            self._ticket.wake()
        elif self._is_asked and not self._is_closed:
            self._ticket = self._scheduler.start(self._turn, "robowidgets-pictures", runs_user_code=True)

    def _turn(self) -> float | None:
        """Make and send some pictures; return the time of the next turn."""
        with self._lock:
            is_closed, ticket, batch = self._is_closed, self._ticket, self._batch()
            is_urgent = bool(self._looked_at)
        if is_closed or not batch:
            self._close_file()
            if is_closed and ticket is not None:
                ticket.detach()
            return None
        began = time.thread_time()
        made = self._make(batch)
        with self._lock:
            if self._is_closed:
                return self._scheduler.clock.now()
            self._sent.update(batch)
            self._looked_at = [number for number in self._looked_at if number not in self._sent]
            first = self._first_screen(made, is_urgent)
        self._send(b"".join(made.values()))
        if first:
            self._hold(first)
        rest = 0.0 if is_urgent else _AT_EASE * (time.thread_time() - began)
        return self._scheduler.clock.now() + rest

    def _batch(self) -> dict[int, Hit]:
        """Return the next hits to draw, all of one file."""
        hits = self._hits
        looked_at = [number for number in self._looked_at if number < len(hits)]
        if looked_at:
            file = hits[looked_at[0]].file
            chosen = [number for number in looked_at if hits[number].file == file]
        else:
            while self._next < min(len(hits), SENT_UNASKED) and self._next in self._sent:
                self._next += 1
            if self._next >= min(len(hits), SENT_UNASKED):
                return {}
            file = hits[self._next].file
            ahead = range(self._next, min(len(hits), self._next + AT_ONCE))
            chosen = [number for number in ahead if hits[number].file == file and number not in self._sent]
        return {number: hits[number] for number in chosen[:AT_ONCE]}

    def _first_screen(self, made: Mapping[int, bytes], is_urgent: bool) -> bytes:
        """Return the pictures of the first screen once all of them are made, otherwise nothing."""
        if self._first is None or not is_urgent:
            return b""
        self._first |= made
        if self._looked_at and len(self._first) < _HELD:
            return b""
        held = b"".join([*self._first.values()][:_HELD])
        self._first = None
        return held

    def _make(self, batch: Mapping[int, Hit]) -> dict[int, bytes]:
        """Return the packed pictures of hits in one file, or a reason for each that cannot be made."""
        file = next(iter(batch.values())).file
        # Without progress bars: bars of a background thread would appear below any cell.
        with without_bars():
            try:
                if self._recording is None or self._file != file:
                    self._close_file()
                    self._recording, self._file = RecordingData(file), file
                    self._recording.memory = MEMORY
                return dict(zip(batch, pictures(self._recording, batch, self._wanted), strict=True))
            except (RecordingError, OSError) as error:
                reason = str(error)
            except Exception as error:
                log.exception("robowidgets: no pictures of %s", file)
                reason = f"{type(error).__name__}: {one_line(error)}"
        return {number: unreadable(reason).pack(number) for number in batch}

    def _close_file(self) -> None:
        if self._recording is not None:
            self._recording.close()
        self._recording, self._file = None, ""
